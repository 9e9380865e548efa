#include "scenarios/layer_json.hpp"

#include <cmath>

#include <fmt/format.h>

namespace repose {
namespace {

using nlohmann::json;

json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
json vector_json(const Vec2& v) { return {v.x(), v.y()}; }

json figures_json(const HeightFigures& f) {
  json quantiles = json::object();
  for (std::size_t k = 0; k < told_shares.size(); ++k) quantiles[fmt::format("{:g}", 100 * told_shares[k])] = f.quantile[k];
  return {{"n", f.n}, {"mean", f.mean}, {"sd", f.sd}, {"min", f.min}, {"max", f.max}, {"quantiles_percent", quantiles}};
}

json surface_json(const BedSurface& s) {
  const Roughness& r = s.roughness;
  json out = figures_json(s.heights);
  out.update({{"Sa", r.Sa}, {"Sq", r.Sq}, {"Sp", r.Sp}, {"Sv", r.Sv}, {"Sz", r.Sz}, {"Ssk", r.Ssk}, {"Sku", r.Sku}});
  out["Sal"] = s.Sal ? json(*s.Sal) : json(nullptr);
  out["coverage"] = s.coverage;
  out["standard_errors"] = nullptr;
  if (s.error)
    out["standard_errors"] = {{"mean", s.error->mean}, {"Sa", s.error->Sa},   {"Sq", s.error->Sq},
                              {"Ssk", s.error->Ssk},   {"Sku", s.error->Sku}, {"blocks", s.error->blocks}};
  out["highest_grains"] = {{"square", s.highest.square}, {"centre", figures_json(s.centres)}, {"top", figures_json(s.tops)}};
  return out;
}

json packing_json(const Packing& p) {
  return {{"slab", p.slab},
          {"solid", p.solid},
          {"below_surface", p.below_surface},
          {"fraction", p.fraction},
          {"se", p.se ? json(*p.se) : json(nullptr)},
          {"solid_volume", p.solid_volume},
          {"volume", p.volume},
          {"pore_chords", {{"n", p.pores}, {"mean", p.pore_mean}, {"median", p.pore_median}, {"p95", p.pore_p95}}}};
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

/// null where no step converged: nothing is known then.
json load_json(const SpreaderLoad& l) {
  const auto known = [&](json value) { return l.converged > 0 ? std::move(value) : json(nullptr); };
  return {{"force", known(vector_json(l.force))},
          {"torque", known(vector_json(l.torque))},
          {"force_se", l.force_se ? vector_json(*l.force_se) : json(nullptr)},
          {"torque_se", l.torque_se ? vector_json(*l.torque_se) : json(nullptr)},
          {"largest_force", known(l.largest)},
          {"rise", known(l.rise)},
          {"largest_rise", known(l.rise_largest)},
          {"steps", l.steps},
          {"converged_steps", l.converged},
          {"residual_max", l.residual_max}};
}

}  // namespace

json layer_json(const LayerMeasurement& m, const LayerSetup& setup, const SpreaderPath& path, const Bed& bed) {
  constexpr const char* rotations[] = {"none", "rolling", "counter_rotating"};
  json out;
  out["surface"] = {{"before", surface_json(m.before)},
                    {"after", surface_json(m.after)},
                    {"region", {{"lower", vector_json(setup.lower)}, {"upper", vector_json(setup.upper)}, {"plate", setup.plate}}},
                    {"cell", setup.cell},
                    {"filter", {{"F", "least-squares plane"}, {"S", setup.s_filter}, {"L", setup.l_filter}}},
                    {"unit", "m"}};
  out["packing_fraction"] = {{"before", m.before.packing.fraction}, {"after", m.after.packing.fraction}};
  out["packing"] = {{"before", packing_json(m.before.packing)}, {"after", packing_json(m.after.packing)}, {"solid_per_area", m.solid_per_area}};
  out["thickness"] = figures_json(m.thickness);
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
