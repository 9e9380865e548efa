#pragma once
/// Round cones (convex hulls of two balls) against balls, each other, ellipsoids and planes.
#include "backends/dvi/collide_placed.hpp"

namespace repose::dvi {

/// Exact signed distance of a point from the surface of a round cone.
///
///   foot on the axis: s = x - q tan(alpha), clamped to [0, length];  x along, q across the axis;  sin(alpha) = slope
///   distance = |p - c(s)| - r(s)
struct RoundConePoint {
  PointDistance nearest;
  double s = 0;
};
RoundConePoint nearest_on_round_cone(const PlacedRoundCone& cone, const Vec3& point);

void collide_sphere_round_cone(const PlacedSphere& a, const PlacedRoundCone& b, const ContactSink& sink);

/// The contact of least gap, and where the two lie along each other a second one at the other end of the common
/// stretch. Features: which half of each axis touches.
void collide_round_cones(const PlacedRoundCone& a, const PlacedRoundCone& b, const ContactSink& sink);

/// The least distance of the axis' points from the ellipsoid, less the radius there. False, with nothing added, if the
/// overlap is so deep that this is not the depth along a common normal.
bool collide_ellipsoid_round_cone(const PlacedEllipsoid& a, const PlacedRoundCone& b, const ContactSink& sink);

/// One contact per end ball (feature 0: start, 1: end); the apex is a ball of radius 0.
void collide_round_cone_plane(const PlacedRoundCone& a, const Vec3& plane_point, const Vec3& plane_normal,
                              const ContactSink& sink);

}  // namespace repose::dvi
