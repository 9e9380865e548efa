#pragma once
/// Bodies with corners and rims on a plane: one contact per corner in reach.
#include <array>

#include "backends/dvi/collide_placed.hpp"

namespace repose::dvi {

struct PlacedPlane {
  Vec3 point, normal;  ///< unit normal, out of the solid
};

inline PlacedPlane place(const HalfSpace& half_space, const PlacedPrimitive& p) {
  return {p.position, p.rotation * half_space.normal};
}

/// Four points a quarter of a turn apart on a circle about `rotation`'s z axis, the lowest against `up` first.
std::array<Vec3, 4> rim_points(const Vec3& centre, const Mat3& rotation, double radius, const Vec3& up);

void collide_plane(const Sphere& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink);
void collide_plane(const Ellipsoid& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink);
void collide_plane(const RoundCone& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink);
/// Every corner within the margin (feature: its number, one bit per axis).
void collide_plane(const Box& body, const PlacedPrimitive& placed, const PlacedPlane& plane, const ContactSink& sink);
/// Four points of the lower rim, the first the lowest, and the lowest of the other rim: two for a cylinder on its side.
void collide_plane(const Cylinder& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink);
/// The apex (feature 4) and four points of the rim.
void collide_plane(const Cone& body, const PlacedPrimitive& placed, const PlacedPlane& plane, const ContactSink& sink);
/// Every vertex within the margin (feature: its number).
void collide_plane(const TriMesh& body, const PlacedPrimitive& placed, const PlacedPlane& plane,
                   const ContactSink& sink);

}  // namespace repose::dvi
