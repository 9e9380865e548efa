#pragma once
/// Bodies with corners (boxes, cylinders, cones, meshes) against solids of revolution.
///
/// Corners, and straight edges, rims and round sides against the surfaces: exact. A rim gives its lowest point and
/// those a quarter of a turn from it. Circles of the profile against the body: a fan of samples, the least distance
/// among them refined.
#include "backends/dvi/collide_revolved.hpp"

namespace repose::dvi {

void collide_solid_profile(const Box& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink);
void collide_solid_profile(const Cylinder& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink);
void collide_solid_profile(const Cone& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink);
void collide_solid_profile(const TriMesh& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink);

}  // namespace repose::dvi
