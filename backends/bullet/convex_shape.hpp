#pragma once
/// Convex primitives as Bullet shapes with exact support functions, and their contact by Bullet's GJK.
///
/// Bullet's GJK is exact and cheap while the cores of two shapes are apart; a shape is its core swept by a ball (its margin).
/// So every core here is the inner parallel body of the true shape, as deep as its sharpest curvature allows, and
/// core + margin is the shape itself, not an approximation. With p(n) the support point of the true shape in direction n:
///
///   sphere      core: its centre                   margin: R
///   ellipsoid   core: p(n) - margin n              margin: 0.9 c^2/a, c the shortest and a the longest semi-axis
///   round cone  core: both radii less the margin   margin: the smaller radius (0 for a cone with a sharp tip)
///   box, cylinder, cone                            margin: 0
///
/// Where cores meet (overlap deeper than both margins), Bullet would go on with its expanding polytope, which takes a wrong
/// direction for one pair of sharp cones in eight: such pairs are left to the caller.
#include <cstdint>
#include <memory>

#include "backends/dvi/narrow_phase.hpp"

namespace repose::bullet {

class ConvexShape;

struct ConvexShapeDeleter {
  void operator()(ConvexShape* shape) const;
};
using ConvexShapePointer = std::unique_ptr<ConvexShape, ConvexShapeDeleter>;

/// The primitive scaled by `scale`; null for half-spaces, solids of revolution and meshes.
ConvexShapePointer convex_shape(const Primitive& primitive, double scale);

struct PlacedShape {
  const ConvexShape* shape = nullptr;
  Vec3 position = Vec3::Zero();
  Mat3 rotation = Mat3::Identity();
};

enum class Touch : std::uint8_t {
  apart,       ///< farther than the margin
  found,       ///< gap (to 1e-8 of shapes of size 1), normal (to 1e-4)
  no_answer,   ///< the cores overlap or stand closer than 1e-3, or no answer could be proven
};

/// The deepest or nearest point of the pair: gap, normal from a to b, midpoint (narrow_phase.hpp). Lengths in a unit in which
/// the smaller of the two is of the order of one.
Touch touch(const PlacedShape& a, const PlacedShape& b, double margin, dvi::ContactPoint& out);

}  // namespace repose::bullet
