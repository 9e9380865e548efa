#include "scenarios/compare_results.hpp"

#include <algorithm>
#include <set>

namespace repose {

using nlohmann::json;

namespace {

std::size_t place(const Comparison& c, std::size_t contender, Refinement refinement, std::size_t seed) {
  return (contender * std::size(refinements) + static_cast<std::size_t>(refinement)) * c.seeds + seed;
}

}  // namespace

CompareResults::CompareResults(const Comparison& comparison, const JobsReport& report)
    : comparison_(comparison), runs_(comparison.contenders.size() * std::size(refinements) * comparison.seeds, nullptr) {
  for (std::size_t j = 0; j < comparison.jobs.size(); ++j) {
    const CompareVariant& v = comparison.variants[comparison.jobs[j].scene];
    const std::optional<JobResult>& result = report.results[j];
    if (result && result->failure.empty()) runs_[place(comparison, v.contender, v.refinement, comparison.jobs[j].seed - comparison.jobs.front().seed)] = &result->observables;
  }
}

const json* CompareResults::run(std::size_t contender, Refinement refinement, std::size_t seed) const {
  return runs_[place(comparison_, contender, refinement, seed)];
}

bool CompareResults::has(std::size_t contender, Refinement refinement) const {
  for (std::size_t s = 0; s < comparison_.seeds; ++s)
    if (run(contender, refinement, s) != nullptr) return true;
  return false;
}

std::size_t CompareResults::failed(std::size_t contender) const {
  std::size_t count = 0;
  for (const CompareVariant& v : comparison_.variants)
    for (std::size_t s = 0; s < comparison_.seeds && v.contender == contender; ++s) count += run(contender, v.refinement, s) == nullptr;
  return count;
}

std::optional<double> CompareResults::value(std::size_t contender, Refinement refinement, std::size_t seed,
                                            const std::string& observable) const {
  const json* r = run(contender, refinement, seed);
  if (r == nullptr || !(*r)["observables"].contains(observable)) return std::nullopt;
  const json& v = (*r)["observables"][observable]["value"];
  return v.is_number() ? std::optional(v.get<double>()) : std::nullopt;
}

std::vector<double> CompareResults::values(std::size_t contender, Refinement refinement, const std::string& observable) const {
  std::vector<double> list;
  for (std::size_t s = 0; s < comparison_.seeds; ++s)
    if (const auto v = value(contender, refinement, s, observable)) list.push_back(*v);
  return list;
}

CompareResults::Pairs CompareResults::paired(std::size_t a, Refinement refinement_a, std::size_t b, Refinement refinement_b,
                                             const std::string& observable) const {
  Pairs pairs;
  for (std::size_t s = 0; s < comparison_.seeds; ++s) {
    const auto x = value(a, refinement_a, s, observable), y = value(b, refinement_b, s, observable);
    if (!x || !y) continue;
    pairs.first.push_back(*x);
    pairs.second.push_back(*y);
  }
  return pairs;
}

json CompareResults::description(const std::string& observable) const {
  json found;
  for (const json* r : runs_) {
    if (r == nullptr || !(*r)["observables"].contains(observable)) continue;
    const json& o = (*r)["observables"][observable];
    const double scale = std::max(o["scale"].get<double>(), found.is_null() ? 0.0 : found["scale"].get<double>());
    found = {{"unit", o["unit"]}, {"kind", o["kind"]}, {"scale", scale}};
  }
  return found;
}

std::vector<std::string> CompareResults::observables() const {
  std::set<std::string> names;
  for (const json* r : runs_)
    if (r != nullptr)
      for (const auto& [name, ignored] : (*r)["observables"].items()) names.insert(name);
  return {names.begin(), names.end()};
}

}  // namespace repose
