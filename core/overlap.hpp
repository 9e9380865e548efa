#pragma once
/// Do two solids cut into each other? By sample points, for the checks of a scene: not for contact detection.
#include <vector>

#include "core/shape.hpp"

namespace repose {

/// Points spread over the surface of a bounded primitive, in its own frame; at least its corners, edges and poles.
/// Empty for a half-space.
std::vector<Vec3> surface_points(const Primitive& primitive);

/// True if a surface point of one shape lies inside the other deeper than `depth` [m] (measured along the world axes).
/// Misses cuts thinner than the spacing of the points, about a twentieth of a shape's size; never invents one.
bool cut_into(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, double depth);

}  // namespace repose
