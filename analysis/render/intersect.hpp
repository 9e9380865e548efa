#pragma once
/// Where a ray meets a primitive: exact, in closed form, no tessellation.
#include "core/shape.hpp"

namespace repose {

struct SurfaceHit {
  double distance = 0;          ///< along the ray, in units of the length of `direction`
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the solid, in the primitive's frame
};

/// The nearest point of the primitive's surface on the ray origin + t direction with t_min < t < t_max, all in the
/// primitive's own frame. False if there is none; `hit` is then untouched. `direction` is not zero.
///
/// For an origin outside the primitive this is the point where the ray enters. Inside a round cone the answer may also
/// be a point of the spheres and the cone that its hull is made of; rays that start outside never see those.
bool intersect(const Primitive& primitive, const Vec3& origin, const Vec3& direction, double t_min, double t_max,
               SurfaceHit& hit);

}  // namespace repose
