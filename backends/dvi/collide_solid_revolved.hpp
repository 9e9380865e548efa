#pragma once
/// Bodies with corners (boxes, cylinders, cones, meshes) against solids of revolution.
///
/// Corners: exact. Straight edges against circles and bulging surfaces: exact. A cylinder's or cone's rim: four points, the
/// first where the rim comes lowest over the surface nearest to the rim's centre: exact on planes, to about r^2/R of a
/// surface of radius R otherwise. Circles of the profile under a face of the body: their least distance is refined from
/// samples; meshes leave this case out.
#include "backends/dvi/collide_revolved.hpp"

namespace repose::dvi {

void collide_solid_profile(const Box& a, const PlacedPrimitive& placed, const PlacedProfile& b, const ContactSink& sink);
void collide_solid_profile(const Cylinder& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink);
void collide_solid_profile(const Cone& a, const PlacedPrimitive& placed, const PlacedProfile& b, const ContactSink& sink);
void collide_solid_profile(const TriMesh& a, const PlacedPrimitive& placed, const PlacedProfile& b,
                           const ContactSink& sink);

}  // namespace repose::dvi
