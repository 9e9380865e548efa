#include "scenarios/layer_json.hpp"

#include <cmath>

#include <fmt/format.h>

namespace repose {
namespace {

using nlohmann::json;

json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
json vector_json(const Vec2& v) { return {v.x(), v.y()}; }

/// null: not known.
json known(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

json figures_json(const HeightFigures& f) {
  const auto of_some = [&](double value) { return f.n > 0 ? json(value) : json(nullptr); };
  json quantiles = json::object();
  for (std::size_t k = 0; k < told_shares.size(); ++k) quantiles[fmt::format("{:g}", 100 * told_shares[k])] = of_some(f.quantile[k]);
  return {{"n", f.n}, {"mean", of_some(f.mean)}, {"sd", of_some(f.sd)}, {"min", of_some(f.min)}, {"max", of_some(f.max)}, {"quantiles_percent", quantiles}};
}

json surface_json(const BedSurface& s) {
  const Roughness& r = s.roughness;
  json out = figures_json(s.heights);
  out.update({{"Sa", r.Sa}, {"Sq", r.Sq}, {"Sp", r.Sp}, {"Sv", r.Sv}, {"Sz", r.Sz}, {"Ssk", known(r.Ssk)}, {"Sku", known(r.Sku)}});
  out["Sal"] = known(s.Sal);
  out["coverage"] = s.coverage;
  out["standard_errors"] = nullptr;
  if (s.error)
    out["standard_errors"] = {{"mean", s.error->mean},       {"Sa", s.error->Sa},         {"Sq", s.error->Sq},
                              {"Ssk", known(s.error->Ssk)}, {"Sku", known(s.error->Sku)}, {"blocks", s.error->blocks}};
  const auto squares_json = [](const SquareFigures& f) {
    return json{{"square", f.square}, {"centre", figures_json(f.centres)}, {"top", figures_json(f.tops)}};
  };
  out["highest_grains"] = squares_json(s.squares.front());
  out["highest_grains"]["further"] = json::array();
  for (std::size_t k = 1; k < s.squares.size(); ++k) out["highest_grains"]["further"].push_back(squares_json(s.squares[k]));
  return out;
}

json packing_json(const Packing& p) {
  const auto of_some = [&](double value) { return p.pores > 0 ? json(value) : json(nullptr); };
  return {{"slab", p.slab},
          {"solid", p.solid},
          {"below_surface", p.below_surface},
          {"fraction", known(p.fraction)},
          {"se", known(p.se)},
          {"solid_volume", p.solid_volume},
          {"volume", p.volume},
          {"pore_chords", {{"n", p.pores}, {"mean", of_some(p.pore_mean)}, {"median", of_some(p.pore_median)}, {"p95", of_some(p.pore_p95)}}}};
}

json bins_json(const std::vector<SegregationBin>& bins, const std::vector<std::string>& kinds) {
  json out = json::array();
  for (const SegregationBin& b : bins) {
    json shares = json::object();
    for (std::size_t k = 0; k < kinds.size(); ++k) shares[kinds[k]] = {{"share", b.share[k]}, {"se", b.share_se[k]}};
    out.push_back({{"from", b.from}, {"to", b.to}, {"grains", b.grains}, {"size", b.size}, {"size_se", b.grains > 1 ? json(b.size_se) : json(nullptr)}, {"shapes", shares}});
  }
  return out;
}

json segregation_json(const Segregation& s) {
  return {{"by_height", bins_json(s.by_height, s.kinds)}, {"by_x", bins_json(s.by_x, s.kinds)}};
}

/// null where no step tells of it: nothing is known then.
json load_json(const SpreaderLoad& l) {
  const auto of_some = [&](json value) { return l.used > 0 ? std::move(value) : json(nullptr); };
  return {{"force", of_some(vector_json(l.force))},
          {"torque", of_some(vector_json(l.torque))},
          {"torque_about", "centre of mass of the spreader, which travels with it: of a roller the middle of its axis"},
          {"force_se", l.force_se ? vector_json(*l.force_se) : json(nullptr)},
          {"torque_se", l.torque_se ? vector_json(*l.torque_se) : json(nullptr)},
          {"largest_force", of_some(l.largest)},
          {"rise", of_some(l.rise)},
          {"largest_rise", of_some(l.rise_largest)},
          {"steps", l.steps},
          {"converged_steps", l.converged},
          {"used_steps", l.used},
          {"overlap_allowed", l.overlap_allowed},
          {"overlap_max", l.overlap_max},
          {"residual_max", l.residual_max}};
}

}  // namespace

json layer_json(const LayerMeasurement& m, const LayerSetup& setup, const SpreaderPath& path, const Bed& bed) {
  constexpr const char* rotations[] = {"none", "rolling", "counter_rotating"};
  json out;
  out["surface"] = {{"before", surface_json(m.before)},
                    {"after", surface_json(m.after)},
                    {"region", {{"lower", vector_json(setup.lower)}, {"upper", vector_json(setup.upper)}, {"plate", setup.plate}}},
                    {"holes_show_plate", !m.beside_plate.has_value()},
                    {"cell", setup.cell},
                    {"filter", {{"F", "least-squares plane"}, {"S", setup.s_filter}, {"L", setup.l_filter}}},
                    {"unit", "m"}};
  out["packing_fraction"] = {{"before", known(m.before.packing.fraction)}, {"after", known(m.after.packing.fraction)}};
  out["packing"] = {{"before", packing_json(m.before.packing)}, {"after", packing_json(m.after.packing)}, {"solid_per_area", m.solid_per_area}, {"solid_of_gap", known(m.solid_of_gap)}};
  out["thickness"] = figures_json(m.thickness);
  out["thickness"]["se"] = known(m.thickness_se);
  out["segregation"] = {{"before", segregation_json(m.before.segregation)}, {"after", segregation_json(m.after.segregation)}};
  out["roller"] = load_json(m.load);
  out["spreader"] = {{"name", setup.spreader},       {"lowest_above_plate", path.lowest - setup.plate},
                     {"from", path.from},            {"to", setup.to},
                     {"speed", setup.speed},         {"rotation", rotations[static_cast<int>(setup.rotation)]},
                     {"travel_time", path.duration}, {"p99_above_lowest", m.passed}};
  out["at_rest"] = m.at_rest;
  out["speed_rms"] = m.speed_rms;
  out["bed"] = {{"folder", bed.folder.string()}, {"at_rest", bed.at_rest},       {"time", bed.time},
                {"speed_rms", bed.speed_rms},    {"residual_max", bed.residual_max}, {"converged_contacts", bed.converged_contacts}};
  out["bed_wall_s"] = bed.wall_s;
  out["mass"] = {{"all", m.mass}, {"region_before", m.mass_in_region_before}, {"region_after", m.mass_in_region_after},
                 {"grains_moved_in", m.moved_in}, {"grains_below_plate", m.lost}};
  return out;
}

}  // namespace repose
