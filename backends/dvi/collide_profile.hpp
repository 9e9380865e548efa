#pragma once
/// Solids of revolution about the z axis, given by a polygon in the (r, z) half-plane: the plane problem.
///
/// Serves Revolved tools (concave or convex) and, as polygons of their own, cylinders and cones. Lengths are in the
/// profile's own unit.
#include <array>
#include <span>

#include "backends/dvi/collide_placed.hpp"

namespace repose::dvi {

/// Edge k runs from point k to point k + 1 with the solid on its left; edges on the axis are no surface.
class Profile {
 public:
  explicit Profile(std::span<const Vec2> points) : points_(points) {}

  int size() const { return static_cast<int>(points_.size()); }
  const Vec2& point(int k) const { return points_[static_cast<std::size_t>(k)]; }
  int next(int k) const { return k + 1 == size() ? 0 : k + 1; }
  int previous(int k) const { return k == 0 ? size() - 1 : k - 1; }
  Vec2 direction(int k) const { return point(next(k)) - point(k); }
  bool is_surface(int k) const {
    const Vec2 &a = point(k), &b = point(next(k));
    return (a.x() > 0 || b.x() > 0) && a != b;
  }
  /// Outward unit normal of edge k.
  Vec2 normal(int k) const {
    const Vec2 d = direction(k);
    return Vec2(d.y(), -d.x()) / d.norm();
  }
  /// Sum of the outward normals of the surface edges that meet at point k, the mirror image counted on the axis.
  Vec2 vertex_normal(int k) const {
    const int in = previous(k);
    Vec2 n = Vec2::Zero();
    if (is_surface(in)) n += normal(in);
    if (is_surface(k)) n += normal(k);
    if (point(k).x() == 0) n.x() = 0;
    return n;
  }
  /// Whether point k stands out of the solid: a rim, or the apex of a cone.
  bool is_convex(int k) const {
    const int in = previous(k);
    if (!is_surface(in) || !is_surface(k)) {
      const int edge = is_surface(in) ? in : k;
      return point(k).x() == 0 && is_surface(edge) && normal(edge).x() > 0;
    }
    const Vec2 a = direction(in), c = direction(k);
    return a.x() * c.y() - a.y() * c.x() > 0;
  }
  /// Whether the direction `d`, seen from point k, lies between the normals of its edges (with slack, relative to |d|).
  bool in_vertex_cone(int k, const Vec2& d, double slack = 0) const {
    const int in = previous(k);
    const double size = slack * d.norm();
    if (is_surface(in)) {
      const Vec2 dir = direction(in);
      if (d.dot(dir) < -size * dir.norm()) return false;
    }
    if (is_surface(k)) {
      const Vec2 dir = direction(k);
      if (d.dot(dir) > size * dir.norm()) return false;
    }
    return d.dot(vertex_normal(k)) > 0;
  }

 private:
  std::span<const Vec2> points_;
};

/// A surface feature: edge k or the circle of point k.
struct ProfileFeature {
  int index = 0;
  bool vertex = false;
  std::uint32_t id() const { return 2 * static_cast<std::uint32_t>(index) + (vertex ? 1 : 0); }
};

/// Nearest point of the surface in the half-plane.
struct ProfileNearest {
  ProfileFeature feature;
  double distance = 0;         ///< signed: < 0 inside the solid
  Vec2 normal = Vec2::Zero();  ///< unit gradient of the signed distance
};

ProfileNearest nearest_on_profile(const Profile& profile, const Vec2& p);

/// Calls f(ProfileNearest) for every surface feature within `reach` whose distance from p is a local minimum over the
/// surface and that faces p; if p is inside the solid, for the nearest feature alone, however deep.
template <class F>
void for_each_near_feature(const Profile& profile, const Vec2& p, double reach, const F& f) {
  const ProfileNearest nearest = nearest_on_profile(profile, p);
  if (nearest.distance <= 0) {
    f(nearest);
    return;
  }
  if (nearest.distance > reach) return;
  for (int k = 0; k < profile.size(); ++k) {
    const bool surface = profile.is_surface(k);
    if (!surface && !profile.is_surface(profile.previous(k))) continue;
    const Vec2 d = p - profile.point(k);
    if (surface) {
      const Vec2 dir = profile.direction(k);
      const double along = d.dot(dir), length2 = dir.squaredNorm();
      if (along > 0 && along < length2) {
        const double side = d.x() * dir.y() - d.y() * dir.x();  // distance times length
        if (side > 0 && side * side <= reach * reach * length2) {
          const double length = std::sqrt(length2);
          f(ProfileNearest{{k, false}, side / length, Vec2(dir.y(), -dir.x()) / length});
        }
        continue;  // point k is out of the question: p projects into the edge
      }
    }
    const double distance2 = d.squaredNorm();
    if (distance2 > 0 && distance2 <= reach * reach && profile.in_vertex_cone(k, d)) {
      const double distance = std::sqrt(distance2);
      f(ProfileNearest{{k, true}, distance, d / distance});
    }
  }
}

/// A solid of revolution in the world.
struct PlacedProfile {
  Profile profile;
  Vec3 position;
  Mat3 rotation;
  double scale = 1;
  bool convex = false;  ///< then a smooth body has one contact with it

  Vec3 to_local(const Vec3& world) const { return rotation.transpose() * (world - position) / scale; }
  Vec3 to_world(const Vec3& local) const { return position + rotation * (scale * local); }
};

/// A point of space in cylinder coordinates of the solid.
struct HalfPlane {
  Vec2 point;   ///< (r, z)
  Vec3 radial;  ///< unit; x on the axis

  explicit HalfPlane(const Vec3& local) {
    const double r = std::sqrt(local.x() * local.x() + local.y() * local.y());
    point = {r, local.z()};
    radial = r > 0 ? Vec3(local.x() / r, local.y() / r, 0) : Vec3(Vec3::UnitX());
  }
  Vec3 lift(const Vec2& v) const { return v.x() * radial + Vec3(0, 0, v.y()); }
};

std::array<Vec2, 4> profile_of(const Cylinder& cylinder, double scale);
std::array<Vec2, 3> profile_of(const Cone& cone, double scale);

}  // namespace repose::dvi
