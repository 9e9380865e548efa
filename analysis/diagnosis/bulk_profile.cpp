#include "analysis/diagnosis/bulk_profile.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace repose::diagnosis {

BulkProfile last_profile(const Observation& o) {
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = 0; i < o.at.size(); ++i)
    if ((o.time.empty() || o.time[i] == o.time.back()) && std::isfinite(o.value[i])) points.emplace_back(std::abs(o.at[i]), o.value[i]);
  std::sort(points.begin(), points.end());
  BulkProfile p;
  for (const auto& [r, h] : points) {
    p.at.push_back(r);
    p.height.push_back(h);
  }
  return p;
}

double height_at(const BulkProfile& p, double radius) {
  radius = std::max(radius, p.at.front());
  const auto [first, last] = std::equal_range(p.at.begin(), p.at.end(), radius);
  auto next = static_cast<std::size_t>(first - p.at.begin());
  if (first != last) {
    const auto from = p.height.begin() + (first - p.at.begin());
    return std::accumulate(from, from + (last - first), 0.0) / static_cast<double>(last - first);
  }
  if (next == p.at.size()) {
    if (next < 2 || radius - p.at[next - 1] > 0.5 * (p.at[next - 1] - p.at[next - 2])) return 0;
    --next;
  }
  const double share = (radius - p.at[next - 1]) / (p.at[next] - p.at[next - 1]);
  return (1 - share) * p.height[next - 1] + share * p.height[next];
}

}  // namespace repose::diagnosis
