#include "analysis/diagnosis/bulk_recording_error.hpp"

#include <algorithm>
#include <cmath>

namespace repose::diagnosis {
namespace {

bool is_geometry(const Observation& o) { return o.kind == ObservableKind::profile || o.kind == ObservableKind::surface; }

/// What has flowed is told from where it begins: its zero does not matter, its clock does.
bool is_flow(const Observation& o) { return o.kind == ObservableKind::series && o.name == "discharged_mass"; }

/// The largest finite size of what an observable tells; 0 if there is none.
double largest(const Observation& o) {
  if (o.kind == ObservableKind::scalar) return std::abs(o.scalar);
  double size = 0;
  for (const double v : o.value)
    if (std::isfinite(v)) size = std::max(size, std::abs(v));
  return size;
}

double duration(const Observation& o) { return o.time.empty() ? 0 : o.time.back() - o.time.front(); }

BulkCandidate of_effect(const char* name, const NaturalScale& scale) {
  BulkCandidate c;
  c.kind = BulkCandidate::Kind::recording;
  c.hypothesis.terms = {{find_effect(name), ""}};
  const TermParameters parameters = parameters_of(c.hypothesis.terms.front(), scale, {});
  // One clock for all runs: of many grains no start is estimated run by run.
  c.parameters = parameters.shared.empty() ? parameters.per_run : parameters.shared;
  return c;
}

BulkCandidate bias_of(const Observation& o) {
  BulkCandidate c;
  c.kind = BulkCandidate::Kind::recording;
  c.hypothesis.terms = {{find_effect("sensor_bias"), o.name}};
  Parameter p;
  p.use = Parameter::Use::bias;
  p.key = "sensor_bias." + o.name;
  p.effect = "sensor_bias";
  p.unit = is_geometry(o) ? std::string(1, 'm') : o.unit;
  p.upper = largest(o);
  p.lower = -p.upper;
  c.parameters = {p};
  return c;
}

}  // namespace

std::vector<BulkCandidate> recording_errors(const Bundle& bundle, const NaturalScale& scale) {
  const std::vector<Observation>& seen = bundle.runs.front().observations;
  const auto any_of = [&](auto holds) { return std::any_of(seen.begin(), seen.end(), holds); };
  std::vector<BulkCandidate> result;
  if (any_of(is_geometry)) result.push_back(of_effect("length_scale", scale));
  const auto flow = std::find_if(seen.begin(), seen.end(), is_flow);
  if (flow != seen.end()) {
    result.push_back(of_effect("time_scale", scale));
    const double longest = duration(*flow);
    BulkCandidate late = of_effect("time_offset", scale);
    for (Parameter& p : late.parameters) {
      p.lower = -0.5 * longest;
      p.upper = 0.5 * longest;
    }
    if (longest > 0) result.push_back(std::move(late));
  }
  for (const Observation& o : seen)
    if (!is_flow(o) && largest(o) > 0) result.push_back(bias_of(o));
  return result;
}

std::vector<Observation> disturbed(const BulkCandidate& candidate, const Eigen::VectorXd& point, std::vector<Observation> observations) {
  using Use = Parameter::Use;
  for (std::size_t i = 0; i < candidate.parameters.size(); ++i) {
    const Parameter& p = candidate.parameters[i];
    if (p.use == Use::scene) continue;
    const double value = value_at(p, point[static_cast<Eigen::Index>(i)]);
    for (Observation& o : observations) {
      if (p.use == Use::length_scale && is_geometry(o))
        for (std::vector<double>* lengths : {&o.at, &o.at_y, &o.value})
          for (double& x : *lengths) x *= value;
      if (p.use == Use::time_scale || p.use == Use::time_offset)
        for (double& t : o.time) t = p.use == Use::time_scale ? value * t : t + value;
      if (p.use != Use::bias || p.key != "sensor_bias." + o.name) continue;
      o.scalar += value;
      for (double& x : o.value) x += value;
    }
  }
  return observations;
}

}  // namespace repose::diagnosis
