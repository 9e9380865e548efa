#pragma once
/// Nearest-hit and any-hit queries over many placed primitives. The hierarchy is Embree's, the intersections are ours.
#include <cstddef>
#include <memory>
#include <vector>

#include "core/shape.hpp"

namespace repose {

/// A primitive in the world, with the number of what it belongs to.
struct Solid {
  Primitive primitive;
  Pose pose;
  int owner = -1;
};

struct RayHit {
  double distance = 0;          ///< in units of the length of the ray's direction
  Vec3 normal = Vec3::UnitZ();  ///< unit, out of the solid, world frame
  int owner = -1;
};

/// Lengths should be scaled so that a typical solid is about 1 in size and the scene lies about the origin: the
/// hierarchy is held in single precision. Unbounded solids (half-spaces) are tested one by one. Queries are safe from
/// many threads.
class RayScene {
 public:
  explicit RayScene(std::vector<Solid> solids);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  bool empty() const;
  /// The nearest surface with 0 < t < t_max; false if there is none.
  bool nearest(const Vec3& origin, const Vec3& direction, double t_max, RayHit& hit) const;
  /// True if anything lies on the ray before t_max.
  bool blocked(const Vec3& origin, const Vec3& direction, double t_max) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace repose
