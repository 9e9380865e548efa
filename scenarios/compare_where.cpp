#include "scenarios/compare_where.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/parting.hpp"
#include "scenarios/compare_verdict.hpp"

namespace repose {
namespace {

using nlohmann::json;

std::vector<Film> films(const Comparison& c, const CompareResults& r, std::size_t contender, Refinement how) {
  std::vector<Film> list;
  for (std::size_t s = 0; s < c.seeds; ++s)
    if (const json* run = r.run(contender, how, s)) list.push_back((*run)["film"].get<Film>());
  return list;
}

std::string millimetres(double metres) { return fmt::format("{:.3g} mm", 1e3 * metres); }

json grains_part(const Comparison& c, const std::vector<Film>& a, const std::vector<Film>& b, double alpha) {
  json j = {{"parted", nullptr}, {"method", "max-T test over all cells and frames"}};
  if (a.size() < 2 || b.size() < 2) return j.update({{"text", "too few runs to tell"}}), j;
  const std::vector<int> kind = motion_field_kinds(*c.grid);
  const Parting parting = first_parting(a, b, kind, alpha);
  j["ways"] = parting.ways;
  j["least_p"] = parting.least_p;
  j["largest"] = {{"p", parting.largest.p}, {"statistic", parting.largest.statistic}};
  if (parting.least_p > alpha) {
    j["text"] = fmt::format("{} and {} runs are too few to tell: the smallest p that they can give is {:.2g}, {:.2g} is needed; use more --seeds",
                            a.size(), b.size(), parting.least_p, alpha);
    return j;
  }
  j["parted"] = parting.first.has_value();
  if (!parting.first) {
    j["text"] = fmt::format("nowhere beyond seed scatter (p = {:.2g})", parting.largest.p);
    return j;
  }
  const PartingPlace& p = *parting.first;
  const double frame = c.frames.interval * static_cast<double>(c.frames.stride), time = frame * static_cast<double>(p.frame);
  const std::size_t cell = p.cell % c.grid->cells();
  const FieldGrid::Bounds region = c.grid->bounds(cell);
  const std::string quantity = p.cell < c.grid->cells() ? "mass share" : "kinetic energy";
  j.update({{"p", p.p}, {"time", time}, {"time_before", std::max(0.0, time - frame)}, {"quantity", quantity},
            {"region", {{"inner", region.inner}, {"outer", region.outer}, {"lower", region.lower}, {"upper", region.upper}}},
            {"mean_a", p.mean_a}, {"mean_b", p.mean_b}, {"se", p.se}});
  j["text"] = fmt::format("first at t = {:.3g} s in the {} between radius {} and {}, height {} and {}: {:.3g} against {:.3g} (p = {:.2g})", time,
                          quantity, millimetres(region.inner), millimetres(region.outer), millimetres(region.lower),
                          millimetres(region.upper), p.mean_a, p.mean_b, p.p);
  return j;
}

using Track = std::array<std::vector<double>, 3>;

Track track_of(const json& run, const std::string& body) {
  const json& t = run["bodies"][body];
  return {t["x"].get<std::vector<double>>(), t["y"].get<std::vector<double>>(), t["z"].get<std::vector<double>>()};
}

double apart(const Track& a, const Track& b, std::size_t f) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += std::pow(a[k][f] - b[k][f], 2);
  return std::sqrt(sum);
}

json bodies_part(const Comparison& c, const CompareResults& r, std::size_t a, std::size_t b) {
  json j = {{"parted", nullptr}, {"method", "places of bodies against tolerance and halved step"}};
  const json *x = r.run(a, Refinement::none, 0), *y = r.run(b, Refinement::none, 0);
  if (x == nullptr || y == nullptr) return j.update({{"text", "a run failed"}}), j;
  j["parted"] = false;
  double first = 1e300;
  for (const auto& [name, ignored] : (*x)["bodies"].items()) {
    const Track p = track_of(*x, name), q = track_of(*y, name);
    const std::vector<double> time = (*x)["curves"]["time"].get<std::vector<double>>();
    const std::size_t n = std::min({p[0].size(), q[0].size(), time.size()});
    const double scale = r.description(name + ".x")["scale"].get<double>();
    for (std::size_t f = 0; f < n && time[f] < first; ++f) {
      double allowed = c.tolerance * scale;
      for (const auto& [k, own] : {std::pair{a, &p}, {b, &q}})
        if (const json* fine = r.run(k, Refinement::half_step, 0)) {
          const Track t = track_of(*fine, name);
          if (f < t[0].size()) allowed = std::max(allowed, apart(*own, t, f));
        }
      const double distance = apart(p, q, f);
      if (distance <= allowed) continue;
      first = time[f];
      j.update({{"parted", true}, {"body", name}, {"time", time[f]}, {"distance", distance}, {"allowed", allowed}});
      j["text"] = fmt::format("first at t = {:.3g} s, body {}: {:.3g} m apart, where tolerance and step explain {:.3g} m", time[f], name, distance, allowed);
    }
  }
  if (!j["parted"].get<bool>()) j["text"] = "nowhere beyond tolerance and step";
  return j;
}

}  // namespace

json compare_partings(const Comparison& c, const CompareResults& r) {
  json all = json::array();
  const std::size_t n = c.contenders.size();
  const double alpha = compare_alpha / static_cast<double>(n * (n - 1) / 2);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b) {
      json j;
      if (c.grid) {
        j = grains_part(c, films(c, r, a, Refinement::none), films(c, r, b, Refinement::none), alpha);
        if (r.has(a, Refinement::half_step) && r.has(b, Refinement::half_step))
          j["half_step"] = grains_part(c, films(c, r, a, Refinement::half_step), films(c, r, b, Refinement::half_step), alpha);
      } else {
        j = bodies_part(c, r, a, b);
      }
      j["a"] = c.contenders[a].label;
      j["b"] = c.contenders[b].label;
      all.push_back(std::move(j));
    }
  return all;
}

}  // namespace repose
