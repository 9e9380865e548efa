#pragma once
/// Random primitives and placements for the tests of the narrow phase, and what can be said of their contacts without
/// it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "backends/dvi/narrow_phase.hpp"

namespace repose::dvi {

class Samples {
 public:
  explicit Samples(std::uint64_t seed) : engine_(seed) {}

  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  Vec3 direction() {
    while (true) {
      const Vec3 v(between(-1, 1), between(-1, 1), between(-1, 1));
      if (v.norm() > 0.1 && v.norm() < 1) return v.normalized();
    }
  }
  Mat3 rotation() { return Eigen::AngleAxisd(between(0, 3.1), direction()).toRotationMatrix(); }

  /// Size about `size`.
  Primitive make(const std::string& kind, double size = 1) {
    if (kind == "sphere") return Sphere{size};
    if (kind == "ellipsoid") {  // aspect ratios up to 10
      const double a = std::pow(10.0, between(0, 1)), b = std::pow(a, between(0, 1)), s = size / std::cbrt(a * b);
      return Ellipsoid{Vec3(s * a, s * b, s)};
    }
    if (kind == "round_cone") {
      const double ra = size * between(0, 1), rb = between(0, 1) < 0.3 ? 0 : size * between(0, 1);
      return RoundCone{ra, rb, std::abs(ra - rb) + size * between(0.1, 2)};
    }
    if (kind == "cone") return Cone{size * between(0.4, 1.5), size * between(0.5, 2)};
    if (kind == "box") return Box{size * Vec3(between(0.4, 1.5), between(0.4, 1.5), between(0.4, 1.5))};
    if (kind == "cylinder") return Cylinder{size * between(0.4, 1.5), size * between(0.4, 1.5)};
    if (kind == "mesh") return block(size * Vec3(between(0.4, 1.5), between(0.4, 1.5), between(0.4, 1.5)));
    if (kind == "half_space") return HalfSpace{direction()};
    if (kind == "dish") return dish();
    return funnel();
  }

  /// Two bodies somewhere near each other; tools are large and fixed.
  struct Pair {
    Primitive first, second;
    PlacedPrimitive a, b;
    double smaller = 1;  ///< size of the smaller one
  };
  void place(Pair& pair, const std::string& first, const std::string& second) {
    const bool tool = second == "half_space" || second == "dish" || second == "funnel";
    const double size_a = tool ? 0.3 : 1, size_b = tool ? 1 : std::pow(10.0, between(-1, 0));
    pair.first = make(first, size_a);
    pair.second = make(second, size_b);
    pair.smaller = std::min(size_a, size_b);
    pair.a = {&pair.first, between(0.5, 1), Vec3::Zero(), rotation()};
    pair.b = {&pair.second, 1, Vec3::Zero(), rotation()};
    pair.smaller *= pair.a.scale;
    const double reach_a = pair.a.scale * bounding_radius(pair.first);
    if (!tool) {
      pair.b.position = between(0.3, 1.2) * (reach_a + bounding_radius(pair.second)) * direction();
      return;
    }
    const double angle = between(0, 6.28);
    Vec3 local = Vec3::Zero();
    if (const auto* plane = std::get_if<HalfSpace>(&pair.second)) local = between(0.3, 1.5) * reach_a * plane->normal;
    if (second == "dish") {  // over the plate, in the corner, or over the rim
      const double r = between(0, 1) < 0.4 ? between(4.8, 6) : between(0, 5);
      local = Vec3(r * std::cos(angle), r * std::sin(angle), between(0, 1.2) * reach_a + (r > 5 ? 1.5 : 0.0));
    } else if (second == "funnel") {  // along the inner wall
      const double t = between(0, 1);
      local = Vec3(0, 0, 6 * t) + (1.5 + 5 * t - between(0, 1.5) * reach_a) * Vec3(std::cos(angle), std::sin(angle), 0);
    }
    pair.b.position = Vec3(3, -2, 1);
    pair.a.position = pair.b.position + pair.b.rotation * local;
  }

  /// A plate of radius 5 whose top is z = 0, with a rim 1.5 high and 1 wide.
  static Revolved dish() { return {{Vec2(0, -2), Vec2(6, -2), Vec2(6, 1.5), Vec2(5, 1.5), Vec2(5, 0), Vec2(0, 0)}}; }
  static Revolved funnel() {
    return {{Vec2(1.5, 0), Vec2(2.5, -0.5), Vec2(8, 6), Vec2(8, 10), Vec2(7, 10), Vec2(6.5, 6)}};
  }
  static TriMesh block(const Vec3& h) {
    TriMesh mesh;
    for (int c = 0; c < 8; ++c)
      mesh.vertices.emplace_back((c & 1) != 0 ? h.x() : -h.x(), (c & 2) != 0 ? h.y() : -h.y(),
                                 (c & 4) != 0 ? h.z() : -h.z());
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
  }

 private:
  std::mt19937_64 engine_;
};

/// Every pair of kinds that collide() serves.
inline std::vector<std::pair<std::string, std::string>> all_kind_pairs() {
  const std::vector<std::string> kinds{"sphere", "ellipsoid", "round_cone", "box", "cylinder", "cone", "mesh"};
  std::vector<std::pair<std::string, std::string>> pairs;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    for (std::size_t j = i; j < kinds.size(); ++j) pairs.emplace_back(kinds[i], kinds[j]);
    for (const char* tool : {"half_space", "dish", "funnel"}) pairs.emplace_back(kinds[i], tool);
  }
  return pairs;
}

inline std::vector<ContactPoint> contacts(const PlacedPrimitive& a, const PlacedPrimitive& b, double margin) {
  std::vector<ContactPoint> out;
  collide(a, b, margin, out);
  return out;
}

inline double least_gap(const std::vector<ContactPoint>& points) {
  double least = std::numeric_limits<double>::infinity();
  for (const ContactPoint& p : points) least = std::min(least, p.gap);
  return least;
}

inline const ContactPoint& deepest(const std::vector<ContactPoint>& points) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < points.size(); ++k)
    if (points[k].gap < points[best].gap) best = k;
  return points.at(best);
}

/// Support function in the world, max n.x, of a convex primitive.
inline double reach(const PlacedPrimitive& p, const Vec3& n) {
  const Vec3 m = p.rotation.transpose() * n;
  const double across = std::hypot(m.x(), m.y());
  double h = 0;
  if (const auto* s = std::get_if<Sphere>(p.primitive)) h = s->radius;
  if (const auto* s = std::get_if<Ellipsoid>(p.primitive)) h = s->semi_axes.cwiseProduct(m).norm();
  if (const auto* s = std::get_if<RoundCone>(p.primitive)) h = std::max(s->radius_a, s->length * m.x() + s->radius_b);
  if (const auto* s = std::get_if<Cone>(p.primitive)) h = std::max(s->radius * across, s->height * m.z());
  if (const auto* s = std::get_if<Box>(p.primitive)) h = s->half_extents.dot(m.cwiseAbs());
  if (const auto* s = std::get_if<Cylinder>(p.primitive)) h = s->radius * across + s->half_height * std::abs(m.z());
  return n.dot(p.position) + p.scale * h;
}

/// Distance between the two planes with normal n that hold the bodies: never more than the signed gap.
inline double separation_along(const PlacedPrimitive& a, const PlacedPrimitive& b, const Vec3& n) {
  return -reach(b, -n) - reach(a, n);
}

}  // namespace repose::dvi
