#pragma once
/// Convex bodies as support functions: what the general convex routine needs to know of a shape.
#include <array>
#include <cstdint>

#include "backends/dvi/collide_placed.hpp"

namespace repose::dvi {

/// A convex body in the world: a core swept by a ball of radius `margin` (balls are points, round cones are thinned).
struct ConvexBody {
  enum class Kind : std::uint8_t { ball, ellipsoid, round_cone, cone, box, cylinder, triangle };
  Kind kind = Kind::ball;
  Vec3 centre = Vec3::Zero();  ///< an inner point
  Mat3 rotation = Mat3::Identity();
  Vec3 size = Vec3::Zero();  ///< ellipsoid: semi-axes; box: half extents; cylinder, cone: radius, -, (half) height
  double margin = 0;
  double extent = 0;              ///< about the largest distance of the body's points from its centre
  std::array<Vec3, 3> points{};   ///< triangle: corners; round cone: the two ends
  std::array<double, 2> radii{};  ///< round cone: of the core

  /// The core's farthest point in direction `d` (need not be unit).
  Vec3 support(const Vec3& d) const;
  /// h(n) = max n.x over the whole body, relative to `origin`; n unit.
  double reach(const Vec3& n, const Vec3& origin) const { return n.dot(support(n) - origin) + margin; }
};

ConvexBody convex(const PlacedSphere& sphere);
ConvexBody convex(const PlacedEllipsoid& ellipsoid);
ConvexBody convex(const PlacedRoundCone& cone);
ConvexBody convex(const PlacedBox& box);
ConvexBody convex(const Cone& cone, const PlacedPrimitive& placed);
ConvexBody convex(const Cylinder& cylinder, const PlacedPrimitive& placed);
ConvexBody convex_triangle(const Vec3& a, const Vec3& b, const Vec3& c);

/// The flat or straight piece of surface that faces direction `d` best: a polygon (counterclockwise seen from outside),
/// a segment, or nothing for bodies that are round there.
struct FaceFeature {
  int count = 0;
  std::array<Vec3, 8> points{};
  std::array<std::uint8_t, 8> names{};  ///< < 32, of the corners
  Vec3 normal = Vec3::Zero();           ///< outward unit normal of a polygon
};
FaceFeature facing(const ConvexBody& body, const Vec3& d);

}  // namespace repose::dvi
