#pragma once
/// Grains against solids of revolution (funnels, discs, rims, rollers, drums; cylinders and cones).
#include "backends/dvi/collide_profile.hpp"

namespace repose::dvi {

/// One contact per surface feature (edge of the profile or circle of a profile point) that is a local minimum of the
/// distance, all in the azimuth of the ball's centre: exact while the ball is smaller than the hollow it lies in. A
/// ball wide enough to touch a hollow all round gets two more contacts, a third of a turn away on either side. A centre
/// inside the solid gets the nearest feature alone, with the depth to it.
void collide_sphere_profile(const PlacedSphere& a, const PlacedProfile& b, const ContactSink& sink,
                            std::uint32_t feature_offset = 0, std::uint32_t feature_stride = 1);

/// The body in the frame and unit of the solid.
PlacedRoundCone to_local(const PlacedRoundCone& a, const PlacedProfile& b);

/// The side of a round cone (strictly between its ends) against the circles and bulging surfaces in reach.
/// `a` in the frame of the solid; `reach` of the search from the middle of its axis.
void collide_sides(const PlacedRoundCone& a, double reach, const PlacedProfile& b, const ContactSink& sink,
                   std::uint32_t feature_offset, std::uint32_t feature_stride);

/// The end balls as spheres (features 8 f, 8 f + 1), and the side where it touches a circle or a surface bulging
/// towards it (8 f + 2 and on). False, with nothing added, if b is convex and the axis pierces it.
bool collide_round_cone_profile(const PlacedRoundCone& a, const PlacedProfile& b, const ContactSink& sink);

/// Edges (cones, cylinders, planes): stationary point of  n(phi).c - k - h(n(phi))  over the azimuth, by Newton.
/// Circles: stationary point of the distance of the circle's points from the ellipsoid.
/// False, with nothing added, if b is convex and the general convex routine must decide (deep overlap).
bool collide_ellipsoid_profile(const PlacedEllipsoid& a, const PlacedProfile& b, const ContactSink& sink);

}  // namespace repose::dvi
