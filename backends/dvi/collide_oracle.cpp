#include <type_traits>

#include "backends/dvi/collide_oracle_search.hpp"
#include "backends/dvi/narrow_phase.hpp"

namespace repose::dvi {

namespace {

using namespace oracle;

/// Support functions h(n) = max n.x of the convex primitives, in their own frame and unit; n unit.
double reach(const Sphere& s, const Vec3&) { return s.radius; }
double reach(const Ellipsoid& e, const Vec3& n) { return e.semi_axes.cwiseProduct(n).norm(); }
double reach(const RoundCone& c, const Vec3& n) { return std::max(c.radius_a, c.length * n.x() + c.radius_b); }
double reach(const Cone& c, const Vec3& n) {
  return std::max(c.radius * std::sqrt(std::max(0.0, 1 - n.z() * n.z())), c.height * n.z());
}
double reach(const Box& b, const Vec3& n) { return b.half_extents.dot(n.cwiseAbs()); }
double reach(const Cylinder& c, const Vec3& n) {
  return c.radius * std::sqrt(std::max(0.0, 1 - n.z() * n.z())) + c.half_height * std::abs(n.z());
}
double reach(const TriMesh& m, const Vec3& n) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Vec3& v : m.vertices) most = std::max(most, n.dot(v));
  return most;
}

template <class T>
constexpr bool is_convex = !std::is_same_v<T, HalfSpace> && !std::is_same_v<T, Revolved> && !std::is_same_v<T, TriMesh>;

using Triangle = std::array<Vec3, 3>;  // world

double reach(const Triangle& t, const Vec3& n) { return std::max({n.dot(t[0]), n.dot(t[1]), n.dot(t[2])}); }

template <class T>
double world_reach(const T& shape, const PlacedPrimitive& p, const Vec3& n) {
  return n.dot(p.position) + p.scale * reach(shape, p.rotation.transpose() * n);
}

std::vector<Triangle> world_triangles(const TriMesh& mesh, const PlacedPrimitive& p) {
  std::vector<Triangle> result;
  const auto at = [&](int k) {
    return Vec3(p.position + p.rotation * (p.scale * mesh.vertices[static_cast<std::size_t>(k)]));
  };
  for (const auto& t : mesh.triangles) result.push_back({at(t[0]), at(t[1]), at(t[2])});
  return result;
}

bool is_convex_mesh(const TriMesh& m) {
  double size = 0;
  for (const Vec3& v : m.vertices) size = std::max(size, v.norm());
  for (const auto& t : m.triangles) {
    const auto at = [&](std::size_t k) { return m.vertices[static_cast<std::size_t>(t[k])]; };
    const Vec3 n = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (const Vec3& v : m.vertices)
      if (n.dot(v - at(0)) > 1e-9 * size) return false;
  }
  return true;
}

/// Signed gap of two convex bodies: the largest distance between two parallel planes that hold them apart.
template <class ReachA, class ReachB>
double convex_oracle(const ReachA& a, const ReachB& b) {
  return -minimum_over_directions([&](const Vec3& n) { return a(n) + b(-n); });
}

/// Signed distance of a point [profile unit] from a solid of revolution: segments in the half-plane, sign by crossings.
double revolved_distance(const Revolved& solid, const Vec3& p) {
  const Vec2 q(std::hypot(p.x(), p.y()), p.z());
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t k = 0; k < solid.profile.size(); ++k) {
    const Vec2 &a = solid.profile[k], &b = solid.profile[(k + 1) % solid.profile.size()];
    if ((a.y() > q.y()) != (b.y() > q.y()) && q.x() < a.x() + (q.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
    if (a.x() == 0 && b.x() == 0) continue;
    const double t = std::clamp((q - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (q - a - t * (b - a)).norm());
  }
  return inside ? -nearest : nearest;
}

/// The least of f(point, radius) over balls that fill the body, in the world.
template <class F>
double least_over_body(const Sphere& s, const PlacedPrimitive& p, const F& f) {
  return f(p.position, p.scale * s.radius);
}
template <class F>
double least_over_body(const RoundCone& c, const PlacedPrimitive& p, const F& f) {
  return minimum_over_cube<1>(
      [&](const std::array<double, 1>& u) {
        return f(p.position + p.rotation.col(0) * (p.scale * c.length * u[0]),
                 p.scale * (c.radius_a + u[0] * (c.radius_b - c.radius_a)));
      },
      201);
}
template <class F>
double least_over_body(const Ellipsoid& e, const PlacedPrimitive& p, const F& f) {
  return minimum_over_directions(
      [&](const Vec3& n) { return f(p.position + p.rotation * (p.scale * e.semi_axes.cwiseProduct(n)), 0); });
}
template <class F>
double least_over_body(const Box& b, const PlacedPrimitive& p, const F& f) {
  return minimum_over_cube<3>(
      [&](const std::array<double, 3>& u) {
        const Vec3 local = p.scale * b.half_extents.cwiseProduct(2 * Vec3(u[0], u[1], u[2]) - Vec3::Ones());
        return f(p.position + p.rotation * local, 0);
      },
      13);
}
template <class F>
double least_over_lathe(double low, double high, double r_low, double r_high, const PlacedPrimitive& p, const F& f) {
  return minimum_over_cube<3>(
      [&](const std::array<double, 3>& u) {
        const double r = u[0] * (r_low + u[2] * (r_high - r_low)), angle = 6.2831853071795865 * u[1];
        const Vec3 local(r * std::cos(angle), r * std::sin(angle), low + u[2] * (high - low));
        return f(p.position + p.rotation * (p.scale * local), 0);
      },
      17);
}
template <class F>
double least_over_body(const Cylinder& c, const PlacedPrimitive& p, const F& f) {
  return least_over_lathe(-c.half_height, c.half_height, c.radius, c.radius, p, f);
}
template <class F>
double least_over_body(const Cone& c, const PlacedPrimitive& p, const F& f) {
  return least_over_lathe(0, c.height, c.radius, 0, p, f);
}
template <class F>
double least_over_body(const TriMesh& mesh, const PlacedPrimitive& p, const F& f) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : world_triangles(mesh, p)) {
    const double value = minimum_over_cube<2>(
        [&](const std::array<double, 2>& u) {
          const double s = u[0] + u[1] > 1 ? 1 - u[0] : u[0], v = u[0] + u[1] > 1 ? 1 - u[1] : u[1];
          return f(t[0] + s * (t[1] - t[0]) + v * (t[2] - t[0]), 0);
        },
        15, 4);
    least = std::min(least, value);
  }
  return least;
}

/// Deepest point of the solid's circles inside a convex body: what the body's own points miss where a rim cuts into it.
template <class T>
double deepest_circle(const T& body, const PlacedPrimitive& pa, const Revolved& solid, const PlacedPrimitive& pb) {
  double least = 0;
  for (const Vec2& v : solid.profile) {
    double best = 0, best_angle = 0;
    const auto depth = [&](double angle, int samples) {
      const Vec3 p =
          pb.position + pb.rotation * (pb.scale * Vec3(v.x() * std::cos(angle), v.x() * std::sin(angle), v.y()));
      if (!contains(Primitive(body), pa.rotation.transpose() * (p - pa.position) / pa.scale)) return 0.0;
      return -minimum_over_directions([&](const Vec3& n) { return world_reach(body, pa, n) - n.dot(p); }, samples, 3);
    };
    constexpr int samples = 2000;
    for (int k = 0; k < samples; ++k) {
      const double angle = 6.2831853071795865 * k / samples, d = depth(angle, 60);
      if (d < best) {
        best = d;
        best_angle = angle;
      }
    }
    if (best == 0) continue;
    double step = 6.2831853071795865 / samples;
    for (int k = 0; k < 30; ++k, step *= 0.6)
      for (const double side : {-step, step}) {
        const double d = depth(best_angle + side, 300);
        if (d < best) {
          best = d;
          best_angle += side;
        }
      }
    least = std::min(least, best);
  }
  return least;
}

template <class A>
double oracle_pair(const A& a, const PlacedPrimitive& pa, const HalfSpace& b, const PlacedPrimitive& pb) {
  const Vec3 n = pb.rotation * b.normal;
  if constexpr (is_convex<A>) {
    return -world_reach(a, pa, -n) - n.dot(pb.position);
  } else {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& v : a.vertices)
      least = std::min(least, n.dot(pa.position + pa.rotation * (pa.scale * v) - pb.position));
    return least;
  }
}

template <class A>
double oracle_pair(const A& a, const PlacedPrimitive& pa, const Revolved& b, const PlacedPrimitive& pb) {
  double gap = least_over_body(a, pa, [&](const Vec3& p, double r) {
    return pb.scale * revolved_distance(b, pb.rotation.transpose() * (p - pb.position) / pb.scale) - r;
  });
  if constexpr (is_convex<A> && !std::is_same_v<A, Sphere> && !std::is_same_v<A, RoundCone>)
    if (gap < 0) gap = std::min(gap, deepest_circle(a, pa, b, pb));
  return gap;
}

template <class A>
double oracle_pair(const A& a, const PlacedPrimitive& pa, const TriMesh& b, const PlacedPrimitive& pb) {
  const auto of_a = [&](const Vec3& n) { return world_reach(a, pa, n); };
  if (is_convex_mesh(b)) {
    bool both = true;
    if constexpr (!is_convex<A>) both = is_convex_mesh(a);
    if (both) return convex_oracle(of_a, [&](const Vec3& n) { return world_reach(b, pb, n); });
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : world_triangles(b, pb)) {
    const auto of_b = [&](const Vec3& n) { return reach(t, n); };
    if constexpr (is_convex<A>) {
      least = std::min(least, convex_oracle(of_a, of_b));
    } else {
      for (const Triangle& s : world_triangles(a, pa))
        least = std::min(least, convex_oracle([&](const Vec3& n) { return reach(s, n); }, of_b));
    }
  }
  return least;
}

}  // namespace

double oracle_gap(const PlacedPrimitive& a, const PlacedPrimitive& b) {
  return std::visit(
      [&](const auto& pa, const auto& pb) -> double {
        using A = std::decay_t<decltype(pa)>;
        using B = std::decay_t<decltype(pb)>;
        constexpr bool a_is_tool = std::is_same_v<A, HalfSpace> || std::is_same_v<A, Revolved>;
        constexpr bool b_is_tool = std::is_same_v<B, HalfSpace> || std::is_same_v<B, Revolved>;
        if constexpr (is_convex<A> && is_convex<B>) {
          return convex_oracle([&](const Vec3& n) { return world_reach(pa, a, n); },
                               [&](const Vec3& n) { return world_reach(pb, b, n); });
        } else if constexpr (a_is_tool && b_is_tool) {
          return std::numeric_limits<double>::infinity();
        } else if constexpr (b_is_tool || (std::is_same_v<B, TriMesh> && !a_is_tool)) {
          return oracle_pair(pa, a, pb, b);
        } else {
          return oracle_pair(pb, b, pa, a);
        }
      },
      *a.primitive, *b.primitive);
}

}  // namespace repose::dvi
