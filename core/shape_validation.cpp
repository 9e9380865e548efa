#include "core/shape_validation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "core/error.hpp"
#include "core/overloaded.hpp"

namespace repose {
namespace {

void positive(const std::string& place, const char* what, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw Error(place, fmt::format("{} is {}, but must be positive and finite", what, value),
                fmt::format("give {} in metres, above zero", what));
}

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool edges_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

void validate_profile(const std::string& place, const std::vector<Vec2>& p) {
  const std::size_t n = p.size();
  if (n < 3) throw Error(place, fmt::format("the profile has {} points", n), "give at least three points (r, z)");
  double area = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &a = p[i], &b = p[(i + 1) % n];
    if (!a.allFinite())
      throw Error(place, fmt::format("profile point {} is not finite", i + 1), "give numbers in metres");
    if (a.x() < 0)
      throw Error(place, fmt::format("profile point {} has r = {}", i + 1, a.x()),
                  "r is a distance from the axis: use r >= 0");
    if (a == b)
      throw Error(place, fmt::format("profile points {} and {} coincide", i + 1, (i + 1) % n + 1),
                  "leave one of them out");
    area += 0.5 * (a.x() * b.y() - b.x() * a.y());
    for (std::size_t j = i + 2; j < n; ++j)
      if (edges_cross(a, b, p[j], p[(j + 1) % n]))
        throw Error(place, fmt::format("profile edges {} and {} cross", i + 1, j + 1),
                    "order the points along the outline, without crossing it");
  }
  if (!(area > 0))
    throw Error(place, "the profile is clockwise or has no area",
                "order the points counterclockwise in the (r, z) plane, solid on the left of each edge");
}

void validate_mesh(const std::string& place, const TriMesh& mesh) {
  const int n = static_cast<int>(mesh.vertices.size());
  for (const Vec3& v : mesh.vertices)
    if (!v.allFinite()) throw Error(place, "a mesh vertex is not finite", "give numbers in metres");
  std::map<std::pair<int, int>, int> edges;
  double volume = 0;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& t = mesh.triangles[k];
    for (std::size_t i = 0; i < 3; ++i) {
      if (t[i] < 0 || t[i] >= n)
        throw Error(place, fmt::format("triangle {} names vertex {}, but there are {} vertices", k, t[i], n),
                    "number the vertices from 0");
      if (t[i] == t[(i + 1) % 3])
        throw Error(place, fmt::format("triangle {} names vertex {} twice", k, t[i]), "remove the triangle");
      if (++edges[{t[i], t[(i + 1) % 3]}] > 1)
        throw Error(place,
                    fmt::format("two triangles run along the edge {}-{} in the same direction", t[i], t[(i + 1) % 3]),
                    "orient all triangles counterclockwise seen from outside, and list each once");
    }
    const auto at = [&](std::size_t i) {
      return Vec3(mesh.vertices[static_cast<std::size_t>(t[i])] - mesh.vertices[0]);
    };
    volume += at(0).dot(at(1).cross(at(2))) / 6;
  }
  for (const auto& [edge, count] : edges)
    if (!edges.count({edge.second, edge.first}))
      throw Error(place, fmt::format("the mesh is open at the edge {}-{}", edge.first, edge.second),
                  "close it: every edge belongs to exactly two triangles");
  if (!(volume > 0))
    throw Error(place, mesh.triangles.empty() ? "the mesh has no triangles" : "the mesh is inside out or has no volume",
                "order the vertices of each triangle counterclockwise seen from outside");
}

void validate_primitive(const std::string& place, const Primitive& primitive) {
  std::visit(
      Overloaded{
          [&](const Sphere& s) { positive(place, "the radius", s.radius); },
          [&](const Ellipsoid& e) {
            for (double a : e.semi_axes) positive(place, "a semi-axis", a);
          },
          [&](const RoundCone& c) {
            positive(place, "radius_a", c.radius_a);
            if (c.radius_b != 0) positive(place, "radius_b", c.radius_b);
            positive(place, "the length", c.length);
            if (c.length <= std::abs(c.radius_a - c.radius_b))
              throw Error(
                  place,
                  fmt::format("the length {} is not above |radius_a - radius_b| = {}: one sphere swallows the other",
                              c.length, std::abs(c.radius_a - c.radius_b)),
                  "make it longer, or use a sphere");
          },
          [&](const Cone& c) { positive(place, "the radius", c.radius), positive(place, "the height", c.height); },
          [&](const Box& b) {
            for (double h : b.half_extents) positive(place, "a half extent", h);
          },
          [&](const Cylinder& c) {
            positive(place, "the radius", c.radius), positive(place, "the half height", c.half_height);
          },
          [&](const HalfSpace& h) {
            if (!(std::abs(h.normal.norm() - 1) < 1e-9))
              throw Error(place, fmt::format("the normal has length {}", h.normal.norm()), "give a unit vector");
          },
          [&](const Revolved& r) { validate_profile(place, r.profile); },
          [&](const TriMesh& m) { validate_mesh(place, m); },
      },
      primitive);
}

}  // namespace

void validate_parts(const std::string& kind, const std::vector<Part>& parts) {
  if (parts.empty()) throw Error(fmt::format("shape '{}'", kind), "it has no parts", "give at least one part");
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string place =
        parts.size() == 1 ? fmt::format("shape '{}'", kind) : fmt::format("shape '{}', part {}", kind, i + 1);
    validate_primitive(place, parts[i].primitive);
    const Pose& pose = parts[i].pose;
    if (!pose.position.allFinite()) throw Error(place, "its position is not finite", "give three numbers in metres");
    if (!(std::abs(pose.orientation.norm() - 1) < 1e-6))
      throw Error(place, fmt::format("its orientation is a quaternion of length {}", pose.orientation.norm()),
                  "give a unit quaternion [w, x, y, z]");
  }
}

}  // namespace repose
