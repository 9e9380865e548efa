#pragma once
/// Contact points between two placed primitives: exact geometry, no state.
///
///   gap > 0: distance; gap < 0: depth (the least translation along the normal that parts the two).
///   normal: unit, from a to b.  point: midpoint of the two witness points; witness on a = point - gap/2 normal.
///
/// Lengths are in the caller's unit; every tolerance inside is relative to the sizes of the two primitives, so the same
/// geometry in other units gives the same answer (bit for bit where the unit is a power of two).
#include <cstdint>
#include <vector>

#include "core/shape.hpp"

namespace repose::dvi {

/// A primitive in the world: x_world = position + rotation * (scale * x_primitive).
struct PlacedPrimitive {
  const Primitive* primitive = nullptr;
  double scale = 1;
  Vec3 position = Vec3::Zero();
  Mat3 rotation = Mat3::Identity();
};

struct ContactPoint {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  double gap = 0;
  /// Names the pair of features that touch (a box corner, a rim's end of a cone ...): the same number in the next step
  /// means the same contact, so that impulses can be carried over. Unique within one call.
  std::uint32_t feature = 0;
};

/// Appends every contact point with gap <= margin: one for a pair that touches at a point, more where the two really have
/// more (face, edge or cone's side on a plane: two to four; for spheres against a hollow, one per surface within reach).
/// `margin` >= 0. Any two primitives except half-space or Revolved against half-space, Revolved (never both dynamic).
void collide(const PlacedPrimitive& a, const PlacedPrimitive& b, double margin, std::vector<ContactPoint>& out);

/// Least signed distance between the two, by slow, dense sampling and refinement that shares no code with collide(): the
/// oracle, and the independent measure of penetration. Accurate to about 1e-4 of the smaller size, better for spheres.
double oracle_gap(const PlacedPrimitive& a, const PlacedPrimitive& b);

}  // namespace repose::dvi
