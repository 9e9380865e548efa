#pragma once
/// The least gap between balls strung along a segment and a convex body: one-dimensional and convex.
#include "backends/dvi/collide_placed.hpp"

namespace repose::dvi {

struct SegmentMinimum {
  double s = 0;           ///< place along the axis
  PointDistance nearest;  ///< of the axis point from the body
  double gap = 0;         ///< nearest.distance - radius(s)
};

/// Minimises  f(s) = distance(centre(s)) - radius(s)  over [0, length] for a convex `distance(Vec3) -> PointDistance`:
/// the root of f'(s) = normal . axis + slope, by regula falsi (Illinois) with a bisection every third step.
template <class Distance>
SegmentMinimum minimise_along(const PlacedRoundCone& cone, const Distance& distance) {
  const auto at = [&](double s) {
    const PointDistance nearest = distance(cone.centre(s));
    return SegmentMinimum{s, nearest, nearest.distance - cone.radius(s)};
  };
  const auto derivative = [&](const SegmentMinimum& m) { return m.nearest.normal.dot(cone.axis) + cone.slope; };
  SegmentMinimum low = at(0);
  if (cone.length == 0) return low;
  double g_low = derivative(low);
  if (g_low >= 0) return low;
  SegmentMinimum high = at(cone.length);
  double g_high = derivative(high);
  if (g_high <= 0) return high;
  // f is flat at a smooth minimum: among points that f cannot tell apart, the least |f'| has the best normal.
  SegmentMinimum best = low.gap <= high.gap ? low : high;
  double g_best = 2;
  const double rounding = 1e-14 * (cone.length + std::abs(best.gap) + cone.radius_start);
  for (int k = 0; k < 100 && high.s - low.s > 1e-14 * cone.length; ++k) {
    const double s = k % 3 == 2 ? 0.5 * (low.s + high.s) : low.s + (high.s - low.s) * (g_low / (g_low - g_high));
    if (!(s > low.s) || !(s < high.s)) break;
    const SegmentMinimum middle = at(s);
    const double g = derivative(middle);
    if (middle.gap < best.gap - rounding || (middle.gap < best.gap + rounding && std::abs(g) < g_best)) {
      best = middle;
      g_best = std::abs(g);
    }
    if (std::abs(g) < 1e-14) return middle;
    if (g < 0) {
      low = middle;
      g_low = g;
      if (k % 3 != 2) g_high *= 0.5;
    } else {
      high = middle;
      g_high = g;
      if (k % 3 != 2) g_low *= 0.5;
    }
  }
  return best;
}

}  // namespace repose::dvi
