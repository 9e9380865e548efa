#include "scenarios/study_summary.hpp"

#include <cmath>

#include "analysis/statistics.hpp"

namespace repose {
namespace {

using nlohmann::json;

// One run has no scatter: null, not 0.
json summary_json(const Summary& s) {
  return {{"mean", s.mean}, {"sd_seed", s.n > 1 ? json(s.sd) : json(nullptr)}, {"se", s.n > 1 ? json(s.se) : json(nullptr)}, {"n", s.n}};
}

// Values of each observable over the seeds of one point; missing ones left out.
std::map<std::string, std::vector<double>> gather(const std::vector<const JobResult*>& results) {
  std::map<std::string, std::vector<double>> values;
  for (const JobResult* result : results)
    for (const auto& [name, value] : result->observables.items())
      if (value.is_number()) values[name].push_back(value.get<double>());
  return values;
}

struct PointRuns {
  std::vector<const JobResult*> good;
  std::size_t failed = 0, missing = 0;
  std::string failure;
};

std::vector<PointRuns> runs_by_point(const StudyPlan& plan, const std::vector<Job>& jobs, const JobsReport& report) {
  std::vector<PointRuns> runs(plan.points.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    PointRuns& point = runs[jobs[i].scene];
    const std::optional<JobResult>& result = report.results[i];
    if (!result) {
      ++point.missing;
    } else if (!result->failure.empty()) {
      ++point.failed;
      point.failure = result->failure;
    } else {
      point.good.push_back(&*result);
    }
  }
  return runs;
}

json point_json(const StudyPlan& plan, const StudyPoint& point, const PointRuns& runs, const PrincipalObservable& principal) {
  json set = json::object();
  for (const Override& o : point.set) set[o.path] = override_json(o.value);
  json observables = json::object();
  auto values = gather(runs.good);
  for (const auto& [name, list] : values)
    if (name != principal.scatter_within) observables[name] = summary_json(summarise(list));
  if (observables.contains(principal.name) && values.contains(principal.scatter_within))
    observables[principal.name][principal.scatter_within] = summarise(values[principal.scatter_within]).mean;
  std::size_t moving = 0;
  for (double at_rest : values["at_rest"]) moving += at_rest == 0;
  json result = {{"set", set},          {"series", plan.series[point.series].name},
                 {"label", point.label}, {"scene", point.scene.filename().string()}, {"x", point.x ? json(*point.x) : json(nullptr)},
                 {"runs", runs.good.size()}, {"failed", runs.failed}, {"missing", runs.missing},
                 {"not_at_rest", moving}, {"observables", observables}};
  if (!runs.failure.empty()) result["failure"] = runs.failure;
  return result;
}

json line_json(const Line& line) {
  json result = {{"value", line.slope}, {"se", line.slope_se}, {"intercept", line.intercept}, {"n", line.n}};
  if (line.n > 2) {
    const double t = student_t_quantile(0.975, static_cast<int>(std::min<std::size_t>(line.n - 2, 100000)));
    result["interval95"] = {line.slope - t * line.slope_se, line.slope + t * line.slope_se};
  }
  return result;
}

// One line through all single runs of a series; nullopt if x does not vary.
std::optional<Line> series_line(const StudyPlan& plan, std::size_t series, const std::vector<PointRuns>& runs, const std::string& principal) {
  std::vector<double> x, y;
  double low = 1e300, high = -1e300;
  for (std::size_t p = 0; p < plan.points.size(); ++p) {
    if (plan.points[p].series != series || !plan.points[p].x) continue;
    const std::vector<double> values = gather(runs[p].good)[principal];
    for (const double value : values) {
      x.push_back(*plan.points[p].x);
      y.push_back(value);
      low = std::min(low, x.back());
      high = std::max(high, x.back());
    }
  }
  if (x.size() < 3 || !(high > low)) return std::nullopt;
  return fit_line(x, y);
}

json reference_json(const ReferenceSet& reference, const StudyPlan& plan, std::size_t series, const std::optional<Line>& line,
                    const std::vector<PointRuns>& runs, const std::string& principal) {
  const std::vector<ReferenceValue> curve = reference.curve(principal);
  json result = {{"title", reference.title}, {"source", reference.source}, {"values", json::array()}};
  for (const ReferenceValue& v : curve)
    result["values"].push_back({{"x", *v.x}, {"value", v.value}, {"uncertainty", v.uncertainty ? json(*v.uncertainty) : json(nullptr)}});
  const std::optional<Line> published = reference_line(curve);
  if (published) result["slope"] = line_json(*published);
  if (published && line) {
    const double se = std::hypot(published->slope_se, line->slope_se);
    result["slope_difference"] = {{"value", line->slope - published->slope}, {"se", se},
                                  {"standard_errors", se > 0 ? (line->slope - published->slope) / se : 0}};
  }
  json differences = json::array();
  double worst = 0;
  for (std::size_t p = 0; p < plan.points.size(); ++p) {
    if (plan.points[p].series != series || !plan.points[p].x) continue;
    const Summary simulated = summarise(gather(runs[p].good)[principal]);
    for (const ReferenceValue& v : curve) {
      if (simulated.n == 0 || std::abs(*v.x - *plan.points[p].x) > 1e-9 * std::abs(*v.x)) continue;
      const double difference = simulated.mean - v.value;
      worst = std::max(worst, std::abs(difference));
      differences.push_back({{"x", *v.x}, {"simulated", simulated.mean}, {"published", v.value}, {"difference", difference},
                             {"se", simulated.se}, {"within_uncertainty", v.uncertainty && std::abs(difference) <= *v.uncertainty}});
    }
  }
  result["differences"] = differences;
  result["largest_difference"] = worst;
  return result;
}

}  // namespace

json override_json(const std::string& value) {
  const json parsed = json::parse(value, nullptr, false);
  return parsed.is_discarded() ? json(value) : parsed;
}

json summarise_study(const StudyPlan& plan, const std::vector<Job>& jobs, const JobsReport& report,
                     const std::map<std::string, ReferenceSet>& references, const PrincipalObservable& principal) {
  const std::vector<PointRuns> runs = runs_by_point(plan, jobs, report);
  json result = {{"title", plan.title}, {"points", json::array()}, {"series", json::array()}};
  for (std::size_t p = 0; p < plan.points.size(); ++p) result["points"].push_back(point_json(plan, plan.points[p], runs[p], principal));
  for (std::size_t s = 0; s < plan.series.size(); ++s) {
    const StudySeries& series = plan.series[s];
    const std::optional<Line> line = series_line(plan, s, runs, principal.name);
    json entry = {{"name", series.name}, {"label", series.label}, {"x", series.x_key}, {"x_unit", series.x_unit}};
    if (line) entry["slope"] = line_json(*line);
    const auto reference = references.find(series.reference);
    if (reference != references.end()) entry["reference"] = reference_json(reference->second, plan, s, line, runs, principal.name);
    result["series"].push_back(entry);
  }
  return result;
}

}  // namespace repose
