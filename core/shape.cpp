#include "core/shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/mass_properties.hpp"
#include "core/overloaded.hpp"
#include "core/shape_validation.hpp"

namespace repose {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Radius of the ball about `centre` (in the primitive's frame) that holds the primitive; tight but for an ellipsoid
// seen from a point off its axes.
double reach(const Primitive& primitive, const Vec3& centre) {
  // From the centre to the farthest point of the circle of radius r about the z axis at height z.
  const auto to_circle = [&](double r, double z) {
    return std::hypot(std::hypot(centre.x(), centre.y()) + r, centre.z() - z);
  };
  return std::visit(
      Overloaded{
          [&](const Sphere& s) { return centre.norm() + s.radius; },
          [&](const Ellipsoid& e) { return centre.norm() + e.semi_axes.maxCoeff(); },
          [&](const RoundCone& c) {
            return std::max(centre.norm() + c.radius_a, (centre - c.length * Vec3::UnitX()).norm() + c.radius_b);
          },
          [&](const Cone& c) { return std::max(to_circle(c.radius, 0), (centre - c.height * Vec3::UnitZ()).norm()); },
          [&](const Box& b) { return (centre.cwiseAbs() + b.half_extents).norm(); },
          [&](const Cylinder& c) {
            return std::max(to_circle(c.radius, c.half_height), to_circle(c.radius, -c.half_height));
          },
          [](const HalfSpace&) { return infinity; },
          [&](const Revolved& r) {
            double farthest = 0;
            for (const Vec2& p : r.profile) farthest = std::max(farthest, to_circle(p.x(), p.y()));
            return farthest;
          },
          [&](const TriMesh& m) {
            double farthest = 0;
            for (const Vec3& v : m.vertices) farthest = std::max(farthest, (v - centre).norm());
            return farthest;
          },
      },
      primitive);
}

bool inside_polygon(const std::vector<Vec2>& polygon, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

// Solid angle of the surface seen from p over 4 pi (van Oosterom & Strackee 1983): 1 inside, 0 outside.
double winding_number(const TriMesh& mesh, const Vec3& p) {
  double angle = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[static_cast<std::size_t>(t[0])] - p,
               b = mesh.vertices[static_cast<std::size_t>(t[1])] - p,
               c = mesh.vertices[static_cast<std::size_t>(t[2])] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace

double bounding_radius(const Primitive& primitive) { return reach(primitive, Vec3::Zero()); }

double smallest_extent(const Primitive& primitive) {
  return std::visit(Overloaded{
                        [](const Sphere& s) { return 2 * s.radius; },
                        [](const Ellipsoid& e) { return 2 * e.semi_axes.minCoeff(); },
                        [](const RoundCone& c) { return 2 * std::max(c.radius_a, c.radius_b); },
                        [](const Cone& c) { return std::min(2 * c.radius, c.height); },
                        [](const Box& b) { return 2 * b.half_extents.minCoeff(); },
                        [](const Cylinder& c) { return 2 * std::min(c.radius, c.half_height); },
                        [](const HalfSpace&) { return infinity; },
                        [](const Revolved& r) {
                          double shortest = infinity;
                          for (std::size_t i = 0, j = r.profile.size() - 1; i < r.profile.size(); j = i++)
                            shortest = std::min(shortest, (r.profile[i] - r.profile[j]).norm());
                          return shortest;
                        },
                        [](const TriMesh& m) {
                          Vec3 lower = Vec3::Constant(infinity), upper = -lower;
                          for (const Vec3& v : m.vertices) lower = lower.cwiseMin(v), upper = upper.cwiseMax(v);
                          return (upper - lower).minCoeff();
                        },
                    },
                    primitive);
}

bool contains(const Primitive& primitive, const Vec3& p) {
  const double from_z = std::hypot(p.x(), p.y());
  return std::visit(Overloaded{
                        [&](const Sphere& s) { return p.norm() <= s.radius; },
                        [&](const Ellipsoid& e) { return p.cwiseQuotient(e.semi_axes).squaredNorm() <= 1; },
                        [&](const RoundCone& c) {
                          const double sine = (c.radius_a - c.radius_b) / c.length,
                                       cosine = std::sqrt((1 - sine) * (1 + sine));
                          const double from_x = std::hypot(p.y(), p.z());
                          // Coordinate along the side of the cone: it touches the spheres at 0 and at its slant length.
                          const double along = p.x() * cosine - from_x * sine;
                          if (along <= 0) return p.norm() <= c.radius_a;
                          if (along >= c.length * cosine) return (p - c.length * Vec3::UnitX()).norm() <= c.radius_b;
                          return p.x() * sine + from_x * cosine <= c.radius_a;
                        },
                        [&](const Cone& c) { return p.z() >= 0 && from_z * c.height <= c.radius * (c.height - p.z()); },
                        [&](const Box& b) { return (p.cwiseAbs().array() <= b.half_extents.array()).all(); },
                        [&](const Cylinder& c) { return std::abs(p.z()) <= c.half_height && from_z <= c.radius; },
                        [&](const HalfSpace& h) { return h.normal.dot(p) <= 0; },
                        [&](const Revolved& r) { return inside_polygon(r.profile, Vec2(from_z, p.z())); },
                        [&](const TriMesh& m) { return winding_number(m, p) >= 0.5; },
                    },
                    primitive);
}

bool contains(const Shape& shape, const Vec3& point) {
  return std::any_of(shape.parts.begin(), shape.parts.end(),
                     [&](const Part& part) { return contains(part.primitive, part.pose.to_local(point)); });
}

Primitive scaled(const Primitive& primitive, double f) {
  return std::visit(Overloaded{
                        [f](const Sphere& s) -> Primitive { return Sphere{f * s.radius}; },
                        [f](const Ellipsoid& e) -> Primitive { return Ellipsoid{f * e.semi_axes}; },
                        [f](const RoundCone& c) -> Primitive {
                          return RoundCone{f * c.radius_a, f * c.radius_b, f * c.length};
                        },
                        [f](const Cone& c) -> Primitive {
                          return Cone{f * c.radius, f * c.height};
                        },
                        [f](const Box& b) -> Primitive { return Box{f * b.half_extents}; },
                        [f](const Cylinder& c) -> Primitive {
                          return Cylinder{f * c.radius, f * c.half_height};
                        },
                        [](const HalfSpace& h) -> Primitive { return h; },
                        [f](Revolved r) -> Primitive {
                          for (Vec2& p : r.profile) p *= f;
                          return r;
                        },
                        [f](TriMesh m) -> Primitive {
                          for (Vec3& v : m.vertices) v *= f;
                          return m;
                        },
                    },
                    primitive);
}

Part scaled(const Part& part, double factor) {
  return {scaled(part.primitive, factor), {factor * part.pose.position, part.pose.orientation}};
}

Shape make_shape(std::string kind, std::vector<Part> parts) {
  validate_parts(kind, parts);
  Shape shape;
  shape.kind = std::move(kind);
  for (Part& part : parts) part.pose.orientation.normalize();

  const bool heavy = std::any_of(parts.begin(), parts.end(), [](const Part& p) {
    return std::holds_alternative<HalfSpace>(p.primitive) || std::holds_alternative<Revolved>(p.primitive);
  });
  if (!heavy) {
    const MassProperties mass = union_mass_properties(parts);
    const Principal principal = principal_axes(mass.inertia);
    const Quat turn = principal.orientation.conjugate();
    shape.own_frame = {turn * (-mass.centre), turn};
    shape.mass.volume = mass.volume;
    shape.mass.inertia = principal.moments.asDiagonal();
  }
  for (Part& part : parts) {
    part.pose = shape.own_frame.compose(part.pose);
    shape.bounding_radius = std::max(shape.bounding_radius, reach(part.primitive, part.pose.to_local(Vec3::Zero())));
  }
  shape.parts = std::move(parts);
  return shape;
}

}  // namespace repose
