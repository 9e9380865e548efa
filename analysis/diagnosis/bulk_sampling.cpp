#include "analysis/diagnosis/bulk_sampling.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/bulk_profile.hpp"

namespace repose::diagnosis {
namespace {

double value_at_time(const Observation& o, double t) {
  const auto next = std::lower_bound(o.time.begin(), o.time.end(), t);
  if (next == o.time.begin()) return o.value.front();
  if (next == o.time.end()) return o.value.back();
  const auto i = static_cast<std::size_t>(next - o.time.begin());
  const double share = (t - o.time[i - 1]) / (o.time[i] - o.time[i - 1]);
  return (1 - share) * o.value[i - 1] + share * o.value[i];
}

/// Those at which something was recorded.
std::vector<double> times_of(const Observation& o) {
  std::vector<double> times;
  for (std::size_t i = 0; i < o.time.size(); ++i)
    if (std::isfinite(o.value[i])) times.push_back(o.time[i]);
  return times;
}

Observation read_at(Observation o, std::vector<double> times) {
  std::vector<double> values;
  for (const double t : times) values.push_back(value_at_time(o, t));
  o.time = std::move(times);
  o.value = std::move(values);
  return o;
}

/// The recorded times, and of the simulated ones outside these as many as lie no closer than the recorded ones on average.
std::vector<double> kept_times(const std::vector<double>& simulated, const std::vector<double>& recorded) {
  if (recorded.empty()) return {};
  const double spacing = recorded.size() > 1 ? (recorded.back() - recorded.front()) / static_cast<double>(recorded.size() - 1) : 0;
  std::vector<double> times;
  for (const double t : simulated)
    if (t < recorded.front() && (times.empty() || t - times.back() >= spacing)) times.push_back(t);
  times.insert(times.end(), recorded.begin(), recorded.end());
  for (const double t : simulated)
    if (t - times.back() > 0 && (t - times.back() >= spacing || t == simulated.back())) times.push_back(t);
  return times;
}

const Observation* find(const std::vector<Observation>& all, const Observation& like) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Observation& o) { return o.kind == like.kind && o.name == like.name && o.body == like.body; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace

std::vector<Observation> sampled_like(std::vector<Observation> simulated, const std::vector<Observation>& recorded) {
  for (Observation& o : simulated) {
    const Observation* as = find(recorded, o);
    if (as == nullptr) continue;
    if (o.kind == ObservableKind::series && !o.time.empty()) o = read_at(std::move(o), times_of(*as));
    if (o.kind != ObservableKind::profile) continue;
    const BulkProfile whole = last_profile(o);
    if (whole.at.empty()) continue;
    o.time.clear();
    o.value.clear();
    o.at = last_profile(*as).at;
    for (const double r : o.at) o.value.push_back(height_at(whole, r));
  }
  return simulated;
}

std::vector<Observation> thinned_like(std::vector<Observation> simulated, const std::vector<Observation>& recorded) {
  for (Observation& o : simulated) {
    const Observation* as = o.kind == ObservableKind::series && !o.time.empty() ? find(recorded, o) : nullptr;
    if (as == nullptr) continue;
    std::vector<double> kept = kept_times(o.time, times_of(*as));
    o = read_at(std::move(o), std::move(kept));
  }
  return simulated;
}

}  // namespace repose::diagnosis
