#include "core/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/overloaded.hpp"

namespace repose {
namespace {

constexpr int around = 48;  // azimuths; a multiple of 4, so that the axes are among them
constexpr int along = 16;   // points per edge of a profile or a box

std::vector<Vec3> ellipsoid_points(const Vec3& axes) {
  std::vector<Vec3> points;
  for (int i = 0; i <= along; ++i) {
    const double polar = std::numbers::pi * i / along;
    for (int j = 0; j < around; ++j) {
      const double azimuth = 2 * std::numbers::pi * j / around;
      const Vec3 unit(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
      points.push_back(axes.cwiseProduct(unit));
    }
  }
  return points;
}

std::vector<Vec3> box_points(const Vec3& half) {
  std::vector<Vec3> points;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      for (int i = 0; i <= along; ++i)
        for (int j = 0; j <= along; ++j) {
          Vec3 unit;
          unit[axis] = side;
          unit[(axis + 1) % 3] = 2.0 * i / along - 1;
          unit[(axis + 2) % 3] = 2.0 * j / along - 1;
          points.push_back(half.cwiseProduct(unit));
        }
  return points;
}

/// The closed profile of points (r, z) turned about the z axis.
std::vector<Vec3> revolved_points(const std::vector<Vec2>& profile) {
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < profile.size(); ++k) {
    const Vec2 &from = profile[k], &to = profile[(k + 1) % profile.size()];
    for (int i = 0; i < along; ++i) {
      const Vec2 point = from + (to - from) * i / along;
      for (int j = 0; j < around; ++j) {
        const double azimuth = 2 * std::numbers::pi * j / around;
        points.emplace_back(point.x() * std::cos(azimuth), point.x() * std::sin(azimuth), point.y());
      }
    }
  }
  return points;
}

std::vector<Vec3> round_cone_points(const RoundCone& cone) {
  std::vector<Vec3> points = ellipsoid_points(Vec3::Constant(cone.radius_a));
  for (const Vec3& point : ellipsoid_points(Vec3::Constant(cone.radius_b)))
    points.push_back(point + Vec3(cone.length, 0, 0));
  // Points inside the hull do no harm: whatever holds them holds a piece of the solid.
  return points;
}

// Each point is tested against every triangle of the other mesh, so a fine mesh is thinned out.
std::vector<Vec3> mesh_points(const TriMesh& mesh) {
  constexpr std::size_t enough = 500;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 1 + mesh.vertices.size() / enough)
    points.push_back(mesh.vertices[i]);
  const auto vertex = [&](int index) { return mesh.vertices[static_cast<std::size_t>(index)]; };
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 1 + mesh.triangles.size() / enough) {
    const std::array<int, 3>& t = mesh.triangles[i];
    points.push_back((vertex(t[0]) + vertex(t[1]) + vertex(t[2])) / 3);
  }
  return points;
}

bool is_deep_inside(const Shape& shape, const Vec3& local, const Pose& pose, double depth) {
  if (!contains(shape, local)) return false;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-depth, depth})
      if (!contains(shape, local + pose.orientation.conjugate() * (side * Vec3::Unit(axis)))) return false;
  return true;
}

bool reaches_into(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, double depth) {
  for (const Part& part : a.parts) {
    std::vector<Vec3> points = surface_points(part.primitive);
    // Two equal solids in one place share their surfaces; their middles tell.
    if (!points.empty() && contains(part.primitive, Vec3::Zero())) points.push_back(Vec3::Zero());
    for (const Vec3& point : points) {
      const Vec3 local = pose_b.to_local(pose_a.to_world(part.pose.to_world(point)));
      if (b.bounded() && local.norm() > b.bounding_radius) continue;
      if (is_deep_inside(b, local, pose_b, depth)) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<Vec3> surface_points(const Primitive& primitive) {
  return std::visit(
      Overloaded{
          [](const Sphere& s) { return ellipsoid_points(Vec3::Constant(s.radius)); },
          [](const Ellipsoid& e) { return ellipsoid_points(e.semi_axes); },
          [](const RoundCone& c) { return round_cone_points(c); },
          [](const Cone& c) {
            return revolved_points({{0, 0}, {c.radius, 0}, {0, c.height}});
          },
          [](const Box& b) { return box_points(b.half_extents); },
          [](const Cylinder& c) {
            return revolved_points(
                {{0, -c.half_height}, {c.radius, -c.half_height}, {c.radius, c.half_height}, {0, c.half_height}});
          },
          [](const HalfSpace&) { return std::vector<Vec3>{}; },
          [](const Revolved& r) { return revolved_points(r.profile); },
          [](const TriMesh& m) { return mesh_points(m); },
      },
      primitive);
}

bool cut_into(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, double depth) {
  if (a.bounded() && b.bounded() && (pose_a.position - pose_b.position).norm() > a.bounding_radius + b.bounding_radius)
    return false;
  return reaches_into(a, pose_a, b, pose_b, depth) || reaches_into(b, pose_b, a, pose_a, depth);
}

}  // namespace repose
