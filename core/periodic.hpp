#pragma once
/// A cell that repeats without end along x, y or both: what leaves it on one side comes back on the other.
#include <cmath>

#include "core/math.hpp"

namespace repose {

/// Every body stands for itself and for its images, shifted by all multiples of the period along the periodic axes. Two
/// bodies meet through their nearest images. Never along z: gravity would have no floor to end on.
struct PeriodicCell {
  Vec3 lower = Vec3::Zero();  ///< [m]
  Vec3 upper = Vec3::Zero();  ///< [m]; periodic along an axis where upper > lower

  bool along(int axis) const { return upper[axis] > lower[axis]; }
  bool any() const { return along(0) || along(1) || along(2); }
  /// The period along an axis [m]; 0 if it is not periodic.
  double length(int axis) const { return upper[axis] - lower[axis]; }

  /// The same cell in a unit of length [m].
  PeriodicCell in_unit(double unit) const { return {lower / unit, upper / unit}; }

  /// What to add to a difference of two places to make it the shortest among images: multiples of the periods.
  Vec3 to_nearest(const Vec3& difference) const {
    Vec3 shift = Vec3::Zero();
    for (int k = 0; k < 3; ++k)  // most differences are short: no division for them
      if (along(k) && std::abs(difference[k]) > 0.499 * length(k)) shift[k] = -length(k) * std::floor(difference[k] / length(k) + 0.5);
    return shift;
  }

  /// The image of a place in the cell: lower <= x < upper along the periodic axes. A place in the cell keeps its bits.
  Vec3 wrapped(Vec3 place) const {
    for (int k = 0; k < 3; ++k) {
      if (!along(k) || (place[k] >= lower[k] && place[k] < upper[k])) continue;
      place[k] -= length(k) * std::floor((place[k] - lower[k]) / length(k));
      // The sum may round up to the far side, which is the near side of the next cell.
      if (!(place[k] >= lower[k] && place[k] < upper[k])) place[k] = lower[k];
    }
    return place;
  }

  /// Calls visit(image) for `place`, which lies in the cell, and for each of its images in the neighbouring cells that is
  /// closer than `reach` [m] to the cell. It may return false to stop; the result is whether all calls returned true.
  template <class Visit>
  bool each_image(const Vec3& place, double reach, Visit&& visit) const {
    const auto steps = [&](int k, int (&list)[3]) {
      int count = 0;
      list[count++] = 0;
      if (along(k) && place[k] + length(k) < upper[k] + reach) list[count++] = 1;
      if (along(k) && place[k] - length(k) > lower[k] - reach) list[count++] = -1;
      return count;
    };
    int x[3], y[3];
    const int count_x = steps(0, x), count_y = steps(1, y);
    for (int j = 0; j < count_y; ++j)
      for (int i = 0; i < count_x; ++i)
        if (!visit(Vec3(place + Vec3(x[i] * length(0), y[j] * length(1), 0)))) return false;
    return true;
  }

  bool operator==(const PeriodicCell&) const = default;
};

}  // namespace repose
