#pragma once
/// Ellipsoids: distance of a point, and of a second ellipsoid.
#include "backends/dvi/collide_placed.hpp"

namespace repose::dvi {

/// Nearest surface point of the ellipsoid x^T diag(e)^-2 x = 1 to the point y, in the ellipsoid's frame.
///
///   y = x + t w,  w_i = y_i / (t + e_i^2),  x_i = e_i^2 w_i,  sum e_i^2 w_i^2 = 1,  t > -min e_i^2
///   signed distance = t |w|,  normal = w / |w|
///
/// The root t is found by Newton's method on 1/sqrt(S(t)) - 1, S = sum (e_i y_i / (t + e_i^2))^2 (More & Sorensen
/// 1983), from below: monotone. Points inside are served too (t < 0), the centre included (the shortest axis wins).
struct EllipsoidPoint {
  double t = 0;
  Vec3 w = Vec3::Zero();
  Vec3 denominator = Vec3::Zero();  ///< t + e_i^2, without cancellation
  double w_norm = 0;

  double distance() const { return t * w_norm; }
  Vec3 normal() const { return w / w_norm; }
};
EllipsoidPoint nearest_on_ellipsoid(const Vec3& semi_axes, const Vec3& y);

/// Second derivative of the signed distance at y, in the ellipsoid's frame.
Mat3 distance_hessian(const Vec3& semi_axes, const EllipsoidPoint& nearest);

PointDistance point_distance(const PlacedEllipsoid& ellipsoid, const Vec3& point);

/// The matrix Q of the support function h(n) = sqrt(n^T Q n).
inline Mat3 support_matrix(const PlacedEllipsoid& ellipsoid) {
  const Mat3 m = ellipsoid.rotation * ellipsoid.semi_axes.asDiagonal();
  return m * m.transpose();
}

/// The direction n that maximises  F(n) = n.d - sqrt(n^T A n) - sqrt(n^T B n)  over unit vectors, d: from the first
/// centre to the second. max F is the signed gap. Newton's method on the sphere with a line search; in deep overlap,
/// where F has several maxima, from the directions of all axes as well.
struct EllipsoidGap {
  Vec3 normal = Vec3::UnitZ();
  double gap = 0;
  bool beyond = false;  ///< F exceeded `margin` on the way: the pair is farther apart, and `gap` is a lower bound
};
EllipsoidGap ellipsoid_gap(const PlacedEllipsoid& first, const PlacedEllipsoid& second, double margin);

void collide_ellipsoids(const PlacedEllipsoid& a, const PlacedEllipsoid& b, const ContactSink& sink);
void collide_sphere_ellipsoid(const PlacedSphere& a, const PlacedEllipsoid& b, const ContactSink& sink);

}  // namespace repose::dvi
