#include "analysis/diagnosis/bulk_sampling.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

std::vector<Observation> sampled_like(std::vector<Observation> simulated, const std::vector<Observation>& recorded) {
  for (Observation& o : simulated) {
    if (o.kind != ObservableKind::series || o.time.empty()) continue;
    const auto as = std::find_if(recorded.begin(), recorded.end(), [&](const Observation& r) { return r.kind == o.kind && r.name == o.name && r.body == o.body; });
    if (as == recorded.end()) continue;
    Observation seen = o;
    seen.time.clear();
    seen.value.clear();
    for (std::size_t i = 0; i < as->time.size(); ++i)
      if (std::isfinite(as->value[i])) {
        seen.time.push_back(as->time[i]);
        seen.value.push_back(value_at_time(o, as->time[i]));
      }
    o = std::move(seen);
  }
  return simulated;
}

}  // namespace repose::diagnosis
