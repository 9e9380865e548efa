#pragma once
/// Boxes against round grains.
#include "backends/dvi/collide_placed.hpp"

namespace repose::dvi {

/// Exact signed distance of a point from the surface of a box; inside, the nearest face.
PointDistance point_distance(const PlacedBox& box, const Vec3& point);

void collide_sphere_box(const PlacedSphere& a, const PlacedBox& b, const ContactSink& sink);

/// Both end balls (features 0, 1) and, if it lies between them, the side (2).
/// False if the axis pierces the box: then no direction found here is known to be the shallowest, and nothing is added.
bool collide_round_cone_box(const PlacedRoundCone& a, const PlacedBox& b, const ContactSink& sink);

/// Least signed distance of the box's points from the ellipsoid: convex in the point, bounds on it: projected Newton.
/// False if the overlap is so deep that this is not the depth along a common normal.
bool collide_ellipsoid_box(const PlacedEllipsoid& a, const PlacedBox& b, const ContactSink& sink);

}  // namespace repose::dvi
