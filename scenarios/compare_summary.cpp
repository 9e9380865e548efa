#include "scenarios/compare_summary.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "analysis/statistics.hpp"
#include "scenarios/compare_verdict.hpp"
#include "scenarios/compare_where.hpp"

namespace repose {
namespace {

using nlohmann::json;

std::vector<const json*> runs_of(const Comparison& c, const CompareResults& r, std::size_t k) {
  std::vector<const json*> runs;
  for (std::size_t s = 0; s < c.seeds; ++s)
    if (const json* run = r.run(k, Refinement::none, s)) runs.push_back(run);
  return runs;
}

// Mean over runs of a curve; one that ended early keeps its last value.
json mean_curve(const std::vector<const json*>& runs, const char* x, const char* y) {
  json curve = {{"x", json::array()}, {"mean", json::array()}, {"se", json::array()}};
  std::vector<double> at;
  std::vector<std::vector<double>> all;
  for (const json* run : runs) {
    const json& c = (*run)["curves"];
    if (!c.contains(x) || !c.contains(y) || c[y].empty()) continue;
    const auto own = c[x].get<std::vector<double>>();
    if (own.size() > at.size()) at = own;
    all.push_back(c[y].get<std::vector<double>>());
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    std::vector<double> values;
    for (const auto& v : all) values.push_back(v[std::min(i, v.size() - 1)]);
    const Summary s = summarise(values);
    curve["x"].push_back(at[i]);
    curve["mean"].push_back(s.mean);
    curve["se"].push_back(s.n > 1 ? json(s.se) : json(nullptr));
  }
  return curve;
}

json backend_json(const Comparison& c, const CompareResults& r, std::size_t k) {
  const Contender& who = c.contenders[k];
  const auto runs = runs_of(c, r, k);
  const auto list = [&](const char* key) {
    std::vector<double> v;
    for (const json* run : runs) v.push_back((*run)["run"][key].get<double>());
    return v;
  };
  const auto mean = [&](const char* key) { return summarise(list(key)).mean; };
  const auto most = [&](const char* key) {
    const auto v = list(key);
    return v.empty() ? 0.0 : *std::max_element(v.begin(), v.end());
  };
  json j = {{"engine", who.backend->name}, {"runs", runs.size()}, {"failed", r.failed(k)}, {"grains", c.grains},
            {"wall_s", mean("wall_s")}, {"steps", mean("steps")}, {"contacts_mean", mean("contacts_mean")},
            {"solver", {{"iterations_mean", mean("iterations_mean")}, {"residual_max", most("residual_max")},
                        {"converged_fraction", mean("converged_fraction")}, {"cycling_fraction", mean("cycling_fraction")}}},
            {"max_penetration", most("max_penetration")}, {"unsupported", who.unsupported}};
  j["wall_s_by_run"] = list("wall_s");
  j["curves"]["kinetic_energy"] = mean_curve(runs, "time", "kinetic_energy");
  for (const auto& [name, x, y] : {std::tuple{"discharged_mass", "time", "discharged_mass"}, {"heap_profile", "radius", "height"}})
    if (json curve = mean_curve(runs, x, y); !curve["x"].empty()) j["curves"][name] = std::move(curve);
  return j;
}

// The same number in every run of every backend: agreement that says little.
bool constant(const json& observable) {
  for (const json& p : observable["pairs"])
    if (p.value("difference", json()) != 0 || p.value("se", json()) != 0) return false;
  for (const auto& [label, v] : observable["values"].items())
    if (v["sd"] != 0) return false;
  return true;
}

std::string headline(const Comparison& c, const json& observables, const json& partings) {
  std::size_t physics = 0, differ = 0, explained = 0, constants = 0;
  std::string most;
  double largest = -1;
  for (const json& o : observables) {
    if (o["kind"] != "physics") continue;
    ++physics;
    constants += constant(o);
    if (o["verdict"] != "differ") continue;
    ++differ;
    bool by_step = true;
    for (const json& p : o["pairs"])
      if (p["verdict"] == "differ") by_step = by_step && p.contains("explained_by") && !p["explained_by"].empty();
    explained += by_step;
    const double size = o["standard_errors"].is_number() ? o["standard_errors"].get<double>() : 0;
    if (size > largest) {
      largest = size;
      most = o["name"];
    }
  }
  std::string names;
  for (std::size_t k = 0; k < c.contenders.size(); ++k)
    names += (k == 0 ? "" : k + 1 == c.contenders.size() ? " and " : ", ") + c.contenders[k].label;
  const std::string among = c.random ? fmt::format("within the scatter of {} seeds", c.seeds) : "within the solver's tolerance";
  std::string text = differ == 0 ? fmt::format("{} agree about all {} observables {}.", names, physics, among)
                                 : fmt::format("{} agree about {} of {} observables {}; they differ most in {}{}.", names, physics - differ,
                                               physics, among, most, largest > 0 ? fmt::format(" ({:.1f} standard errors)", largest) : "");
  if (constants > 0) text += fmt::format(" {} of the observables {} the same in every run.", constants, constants == 1 ? "is" : "are");
  if (explained > 0) text += fmt::format(" {} of the {} differences are no larger than what a finer step or tolerance changes.", explained, differ);
  for (const json& p : partings)
    if (p["parted"].is_boolean() && p["parted"].get<bool>())
      text += fmt::format(" The runs of {} and {} part {}.", p["a"].get<std::string>(), p["b"].get<std::string>(), p["text"].get<std::string>());
  return text;
}

}  // namespace

json summarise_compare(const Comparison& c, const JobsReport& report) {
  const CompareResults results(c, report);
  json j = {{"seeds", c.seeds}, {"grains", c.grains}, {"alpha", compare_alpha}, {"tolerance", c.tolerance}, {"backends", json::object()}};
  for (std::size_t k = 0; k < c.contenders.size(); ++k) j["backends"][c.contenders[k].label] = backend_json(c, results, k);
  j["observables"] = compare_verdicts(c, results);
  j["partings"] = compare_partings(c, results);
  j["headline"] = headline(c, j["observables"], j["partings"]);
  return j;
}

}  // namespace repose
