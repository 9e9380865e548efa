#include "analysis/diagnosis/bulk_summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/diagnosis/bulk_profile.hpp"
#include "analysis/discharge.hpp"
#include "analysis/statistics.hpp"

namespace repose::diagnosis {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool is_load(const std::string& name) { return name == "surface_angle" || name.starts_with("roller_"); }

std::vector<double> finite(const std::vector<double>& values) {
  std::vector<double> result;
  for (const double v : values)
    if (std::isfinite(v)) result.push_back(v);
  return result;
}

/// 2 pi int r h dr up to `to`, by trapezia from the axis.
double volume(const BulkProfile& p, double to) {
  double sum = 0, r0 = 0, h0 = p.height.front();
  for (std::size_t i = 0; i < p.at.size() && p.at[i] <= to; ++i) {
    sum += 0.5 * (r0 * h0 + p.at[i] * p.height[i]) * (p.at[i] - r0);
    r0 = p.at[i];
    h0 = p.height[i];
  }
  return 2 * std::numbers::pi * sum;
}

double slope_deg(const BulkProfile& p, double from, double to) {
  std::vector<double> r, h;
  for (std::size_t i = 0; i < p.at.size(); ++i)
    if (p.at[i] >= from * p.at.back() && p.at[i] <= to * p.at.back()) {
      r.push_back(p.at[i]);
      h.push_back(p.height[i]);
    }
  if (r.size() < 2 || !(r.back() > r.front())) return nan;
  return std::atan(-fit_line(r, h).slope) * 180 / std::numbers::pi;
}

double of_profile(const std::string& name, const Observation& o) {
  const BulkProfile p = last_profile(o);
  if (p.at.size() < 4) return nan;
  if (name == "heap_volume") return volume(p, p.at.back());
  if (name == "heap_slope") return slope_deg(p, 0.2, 0.8);
  if (name == "heap_concavity") return slope_deg(p, 0.2, 0.5) - slope_deg(p, 0.5, 0.8);
  double height = 0, area = 0;
  for (std::size_t i = 0; i < p.at.size(); ++i)
    if (i == 0 || p.at[i] <= p.at.back() / 3) {
      height += p.at[i] * p.height[i];
      area += p.at[i];
    }
  return area > 0 ? height / area : p.height.front();
}

double of_discharge(const std::string& name, const Observation& o) {
  DischargeCurve curve;
  for (std::size_t i = 0; i < o.time.size(); ++i)
    if (std::isfinite(o.value[i])) {
      curve.time.push_back(o.time[i]);
      curve.mass.push_back(o.value[i]);
    }
  if (curve.time.size() < 4) return nan;
  const double start = curve.mass.front(), total = curve.mass.back() - start;
  if (name == "poured_mass") return total;
  if (name == "discharge_delay") {
    for (std::size_t i = 1; i < curve.time.size(); ++i)
      if (total > 0 && curve.mass[i] - start >= 0.1 * total) {
        const double rise = curve.mass[i] - curve.mass[i - 1], missing = start + 0.1 * total - curve.mass[i - 1];
        return curve.time[i - 1] + (rise > 0 ? missing / rise : 0) * (curve.time[i] - curve.time[i - 1]);
      }
    return nan;
  }
  const std::optional<DischargeRate> rate = steady_rate(curve);
  return rate ? rate->rate : nan;
}

double of_series(const std::string& name, const Observation& o) {
  const std::vector<double> values = finite(o.value);
  if (values.size() < 2) return nan;
  if (name == "load_on_base") return repose::summarise(std::span(values).last(std::max<std::size_t>(1, values.size() / 10))).mean;
  const repose::Summary s = repose::summarise(values);
  return name.ends_with("_sd") ? s.sd : s.mean;
}

}  // namespace

std::vector<BulkSummary> summaries_of(const std::vector<Observation>& observations) {
  // The slope of a profile is a heap's angle, where nobody read one from its sides.
  const bool has_angle = std::any_of(observations.begin(), observations.end(), [](const Observation& o) { return o.name == "angle_of_repose"; });
  std::vector<std::pair<int, BulkSummary>> found;
  const auto add = [&](int rank, BulkSummary s) {
    for (const auto& [_, other] : found)
      if (other.name == s.name) return;
    found.emplace_back(rank, std::move(s));
  };
  for (const Observation& o : observations) {
    const std::string mass_rate = o.unit.empty() ? "kg/s" : o.unit + "/s";
    if (o.kind == ObservableKind::scalar) add(o.name == "angle_of_repose" ? 0 : 3, {o.name, o.name, "heap", o.unit});
    if (o.kind == ObservableKind::series && o.name == "discharged_mass") {
      add(1, {"discharge_rate", o.name, "flow", mass_rate});
      add(6, {"discharge_delay", o.name, "flow", "s"});
      add(7, {"poured_mass", o.name, "flow", o.unit});
    }
    if (o.kind == ObservableKind::profile && o.name == "heap") {
      add(2, {"heap_apex", o.name, "heap", "m"});
      add(3, {"heap_volume", o.name, "heap", "m^3"});
      add(has_angle ? 4 : 0, {"heap_slope", o.name, "heap", "deg"});
      add(5, {"heap_concavity", o.name, "heap", "deg"});
    }
    if (o.kind == ObservableKind::series && o.name == "mass_on_base") add(8, {"load_on_base", o.name, "heap", o.unit});
    if (o.kind == ObservableKind::surface) {
      add(9, {o.name + "_sd", o.name, "spread", "m"});
      add(10, {o.name + "_mean", o.name, "spread", "m"});
    }
    if (o.kind == ObservableKind::series && is_load(o.name)) {
      const std::string phase = o.name == "surface_angle" ? "flow" : "spread";
      add(9, {o.name + "_mean", o.name, phase, o.unit});
      add(10, {o.name + "_sd", o.name, phase, o.unit});
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<BulkSummary> result;
  for (auto& [_, s] : found) result.push_back(std::move(s));
  return result;
}

std::vector<BulkSummary> three_of(const std::vector<BulkSummary>& all) {
  std::vector<BulkSummary> chosen;
  const auto has = [&](auto same) { return std::any_of(chosen.begin(), chosen.end(), same); };
  for (const bool fresh : {true, false})
    for (const BulkSummary& s : all) {
      if (chosen.size() == 3 || has([&](const BulkSummary& c) { return c.name == s.name; })) continue;
      if (!fresh || !has([&](const BulkSummary& c) { return c.observable == s.observable; })) chosen.push_back(s);
    }
  return chosen;
}

double value_of(const BulkSummary& summary, const std::vector<Observation>& observations) {
  for (const Observation& o : observations) {
    if (o.name != summary.observable) continue;
    if (o.kind == ObservableKind::scalar) return o.scalar;
    if (o.kind == ObservableKind::profile) return of_profile(summary.name, o);
    if (o.kind == ObservableKind::series && o.name == "discharged_mass") return of_discharge(summary.name, o);
    return of_series(summary.name, o);
  }
  return nan;
}

}  // namespace repose::diagnosis
