#pragma once
/// Primitives with scale and pose applied, and the sink that collects their contacts. Internal to the narrow phase.
///
/// Convention of all collide_* functions: the first body is "a" of the sink, normals point from the first to the
/// second, and every contact with gap <= sink.margin is added.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "backends/dvi/narrow_phase.hpp"

namespace repose::dvi {

/// Receives contacts of a pair; turns them round if the pair was swapped.
struct ContactSink {
  std::vector<ContactPoint>* out = nullptr;
  double margin = 0;
  bool swapped = false;

  /// `point`: midpoint of the witness points; `normal`: unit, from the first to the second body.
  void add(const Vec3& point, const Vec3& normal, double gap, std::uint32_t feature) const {
    if (!(gap <= margin)) return;
    ContactPoint& contact = out->emplace_back();
    contact.point = point;
    contact.normal = swapped ? Vec3(-normal) : normal;
    contact.gap = gap;
    contact.feature = feature;
  }
};

/// Drops every contact from `first` on that repeats an earlier one: same place (to `tolerance` [length]) and normal.
inline void merge_repeated(std::vector<ContactPoint>& out, std::size_t first, double tolerance) {
  std::size_t kept = first;
  for (std::size_t k = first; k < out.size(); ++k) {
    bool known = false;
    for (std::size_t other = first; other < kept && !known; ++other)
      known = (out[other].point - out[k].point).squaredNorm() < tolerance * tolerance &&
              out[other].normal.dot(out[k].normal) > 0.9999;
    if (!known) out[kept++] = out[k];
  }
  out.resize(kept);
}

struct PlacedSphere {
  Vec3 centre;
  double radius;
};

struct PlacedEllipsoid {
  Vec3 centre;
  Mat3 rotation;
  Vec3 semi_axes;
};

/// Balls of radius radius_start - slope s around start + s axis, 0 <= s <= length. |slope| < 1; length 0 is a sphere.
struct PlacedRoundCone {
  Vec3 start, axis;
  double length, radius_start, radius_end, slope;

  Vec3 centre(double s) const { return start + s * axis; }
  double radius(double s) const { return s >= length ? radius_end : radius_start - slope * s; }
};

struct PlacedBox {
  Vec3 centre;
  Mat3 rotation;
  Vec3 half_extents;
};

inline PlacedSphere place(const Sphere& sphere, const PlacedPrimitive& p) {
  return {p.position, p.scale * sphere.radius};
}

inline PlacedEllipsoid place(const Ellipsoid& ellipsoid, const PlacedPrimitive& p) {
  return {p.position, p.rotation, p.scale * ellipsoid.semi_axes};
}

inline PlacedRoundCone place(const RoundCone& cone, const PlacedPrimitive& p) {
  const double ra = p.scale * cone.radius_a, rb = p.scale * cone.radius_b, length = p.scale * cone.length;
  const Vec3 axis = p.rotation.col(0);
  if (length > std::abs(ra - rb)) return {p.position, axis, length, ra, rb, (ra - rb) / length};
  const double r = std::max(ra, rb);
  return {ra >= rb ? p.position : Vec3(p.position + length * axis), axis, 0, r, r, 0};
}

inline PlacedBox place(const Box& box, const PlacedPrimitive& p) {
  return {p.position, p.rotation, p.scale * box.half_extents};
}

/// A unit vector perpendicular to the unit vector `n`; the same for the same n.
inline Vec3 any_perpendicular(const Vec3& n) {
  const Vec3 other = std::abs(n.z()) < 0.7 ? Vec3::UnitZ() : Vec3::UnitX();
  return n.cross(other).normalized();
}

/// Signed distance of a point from a surface and the unit gradient (the outward normal at the nearest surface point).
struct PointDistance {
  double distance = 0;
  Vec3 normal = Vec3::UnitZ();
};

}  // namespace repose::dvi
