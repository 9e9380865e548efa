#pragma once
/// The point of a segment or triangle nearest to the origin.
#include <array>

#include "backends/dvi/collide_placed.hpp"

namespace repose::dvi {

/// Weights of the corners of a simplex at its point nearest to the origin.
struct Weights {
  std::array<double, 4> w{};
  double distance2 = std::numeric_limits<double>::infinity();
};

inline Weights on_segment(const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0 ? std::clamp(-a.dot(ab) / length2, 0.0, 1.0) : 0.0;
  return {{1 - t, t, 0, 0}, (a + t * ab).squaredNorm()};
}

inline Weights on_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double n2 = n.squaredNorm();
  const double scale = std::max((b - a).squaredNorm(), (c - a).squaredNorm());
  if (n2 > 1e-24 * scale * scale) {
    const double wa = n.dot(b.cross(c)), wb = n.dot(c.cross(a)), wc = n.dot(a.cross(b));
    if (wa >= 0 && wb >= 0 && wc >= 0) {
      const double sum = wa + wb + wc, height = n.dot(a);
      return {{wa / sum, wb / sum, wc / sum, 0}, height * height / n2};
    }
  }
  Weights best = on_segment(a, b);
  const Weights bc = on_segment(b, c), ca = on_segment(c, a);
  if (bc.distance2 < best.distance2) best = {{0, bc.w[0], bc.w[1], 0}, bc.distance2};
  if (ca.distance2 < best.distance2) best = {{ca.w[1], 0, ca.w[0], 0}, ca.distance2};
  return best;
}

}  // namespace repose::dvi
