#pragma once
/// The two ways to integrate over a union of overlapping parts; see mass_properties.hpp, which chooses between them.
#include <optional>
#include <span>

#include "core/shape.hpp"

namespace repose {

/// Exact to rounding if every part is a solid of revolution about one common axis, else nothing.
std::optional<MassProperties> coaxial_union(std::span<const Part> parts);

/// Over a grid of rays x rays parallel rays, oblique to the frame. Throws Error for half-spaces and revolved solids.
MassProperties ray_union(std::span<const Part> parts, int rays = 512);

/// Largest value of direction . x over the part [m]; infinite for a half-space.
double support(const Part& part, const Vec3& direction);

/// Inertia about the centre, given the integral of x x^T about the centre.
inline Mat3 inertia_of(const Mat3& second_moment) { return second_moment.trace() * Mat3::Identity() - second_moment; }

}  // namespace repose
