#pragma once
/// Points sorted into cubic cells, to find those near a place in constant time.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/math.hpp"

namespace repose {

/// A point is found from every place that is less than one cell away along each axis. The number of cells is bounded by a
/// multiple of the number of points: far outliers share the cells at the border.
class NeighbourGrid {
 public:
  /// `cell`: edge of a cell [m], > 0.
  NeighbourGrid(const std::vector<Vec3>& points, double cell) : inverse_(1 / cell) {
    if (points.empty()) return;
    Vec3 lower = points.front(), upper = points.front();
    for (const Vec3& p : points) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
    lower_ = lower;
    const double limit = 16 * std::cbrt(static_cast<double>(points.size())) + 16;
    for (int k = 0; k < 3; ++k)
      cells_[static_cast<std::size_t>(k)] = 1 + static_cast<int>(std::min(limit, (upper[k] - lower[k]) * inverse_));
    start_.assign(static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) *
                      static_cast<std::size_t>(cells_[2]) + 1, 0);
    for (const Vec3& p : points) ++start_[index(cell_of(p)) + 1];
    for (std::size_t i = 1; i < start_.size(); ++i) start_[i] += start_[i - 1];
    members_.resize(points.size());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) members_[next[index(cell_of(points[i]))]++] = static_cast<int>(i);
  }

  /// Calls visit(i) for each point i in the cells around `place`: all near ones, and some that are not. It may return
  /// false to stop.
  template <class Visit>
  void near(const Vec3& place, Visit visit) const {
    if (members_.empty()) return;
    const std::array<int, 3> c = cell_of(place);
    for (int z = std::max(0, c[2] - 1); z <= std::min(cells_[2] - 1, c[2] + 1); ++z)
      for (int y = std::max(0, c[1] - 1); y <= std::min(cells_[1] - 1, c[1] + 1); ++y)
        for (int x = std::max(0, c[0] - 1); x <= std::min(cells_[0] - 1, c[0] + 1); ++x) {
          const std::size_t i = index({x, y, z});
          for (std::size_t m = start_[i]; m < start_[i + 1]; ++m)
            if (!visit(members_[m])) return;
        }
  }

 private:
  std::array<int, 3> cell_of(const Vec3& p) const {
    std::array<int, 3> c{};
    for (int k = 0; k < 3; ++k) {
      const double at = std::floor((p[k] - lower_[k]) * inverse_);
      c[static_cast<std::size_t>(k)] = static_cast<int>(
          std::clamp(at, 0.0, static_cast<double>(cells_[static_cast<std::size_t>(k)] - 1)));
    }
    return c;
  }
  std::size_t index(const std::array<int, 3>& c) const {
    return (static_cast<std::size_t>(c[2]) * static_cast<std::size_t>(cells_[1]) + static_cast<std::size_t>(c[1])) *
               static_cast<std::size_t>(cells_[0]) + static_cast<std::size_t>(c[0]);
  }

  double inverse_;
  Vec3 lower_ = Vec3::Zero();
  std::array<int, 3> cells_{0, 0, 0};
  std::vector<std::size_t> start_;
  std::vector<int> members_;
};

}  // namespace repose
