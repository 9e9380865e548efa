#include "analysis/render/intersect.hpp"

#include <algorithm>
#include <cmath>

namespace repose {
namespace {

/// The ray and the nearest hit so far.
struct Trace {
  const Vec3& origin;
  const Vec3& direction;
  double t_min, t_max;
  SurfaceHit& hit;
  bool found = false;

  Vec3 at(double t) const { return origin + t * direction; }
  bool in_range(double t) const { return t > t_min && t < t_max; }
  void accept(double t, const Vec3& normal) {
    t_max = t;
    hit = {t, normal};
    found = true;
  }
};

struct Roots {
  int count = 0;
  double t[2] = {0, 0};
};

/// a t^2 + 2 b t + c = 0, ascending, without cancellation.
Roots solve_quadratic(double a, double b, double c) {
  Roots roots;
  if (a == 0) {
    if (b != 0) roots = {1, {-c / (2 * b), 0}};
    return roots;
  }
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return roots;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  if (q == 0) return {1, {0, 0}};
  roots = {2, {q / a, c / q}};
  if (roots.t[0] > roots.t[1]) std::swap(roots.t[0], roots.t[1]);
  return roots;
}

/// A ball about `centre`. The discriminant is formed from the ray's closest approach, so that a small ball far away
/// keeps its outline.
void ball(Trace& trace, const Vec3& centre, double radius) {
  const Vec3 to_origin = trace.origin - centre;
  const double a = trace.direction.squaredNorm();
  const double b = to_origin.dot(trace.direction);
  const Vec3 nearest = to_origin - (b / a) * trace.direction;
  const double discriminant = radius * radius - nearest.squaredNorm();
  if (discriminant < 0) return;
  const double half = std::sqrt(discriminant / a);
  for (const double t : {-b / a - half, -b / a + half}) {
    if (!trace.in_range(t)) continue;
    trace.accept(t, (to_origin + t * trace.direction) / radius);
    return;
  }
}

/// The side of a cone about `axis` (0: x, 2: z) between two rings (place along the axis, radius).
void frustum(Trace& trace, int axis, double place_0, double radius_0, double place_1, double radius_1) {
  if (place_1 < place_0) {
    std::swap(place_0, place_1);
    std::swap(radius_0, radius_1);
  }
  const double slope = (radius_1 - radius_0) / (place_1 - place_0);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Vec3& o = trace.origin;
  const Vec3& d = trace.direction;
  const double r_o = radius_0 + slope * (o[axis] - place_0), r_d = slope * d[axis];
  const Roots roots = solve_quadratic(d[u] * d[u] + d[v] * d[v] - r_d * r_d, o[u] * d[u] + o[v] * d[v] - r_o * r_d,
                                      o[u] * o[u] + o[v] * o[v] - r_o * r_o);
  for (int i = 0; i < roots.count; ++i) {
    const double t = roots.t[i];
    if (!trace.in_range(t)) continue;
    const Vec3 p = trace.at(t);
    const double radius = radius_0 + slope * (p[axis] - place_0);
    if (p[axis] < place_0 || p[axis] > place_1 || radius < 0) continue;
    Vec3 normal;
    normal[axis] = -slope * radius;
    normal[u] = p[u];
    normal[v] = p[v];
    if (normal.squaredNorm() == 0) normal[axis] = slope < 0 ? 1 : -1;
    trace.accept(t, normal.normalized());
    return;
  }
}

/// The ring inner <= r <= outer in the plane z = place.
void ring(Trace& trace, double place, double inner, double outer, double normal_z) {
  if (trace.direction.z() == 0) return;
  const double t = (place - trace.origin.z()) / trace.direction.z();
  if (!trace.in_range(t)) return;
  const Vec3 p = trace.at(t);
  const double r2 = p.x() * p.x() + p.y() * p.y();
  if (r2 > outer * outer || r2 < inner * inner) return;
  trace.accept(t, Vec3(0, 0, normal_z));
}

void visit(Trace& trace, const Sphere& s) { ball(trace, Vec3::Zero(), s.radius); }

void visit(Trace& trace, const Ellipsoid& e) {
  const Vec3 origin = trace.origin.cwiseQuotient(e.semi_axes);
  const Vec3 direction = trace.direction.cwiseQuotient(e.semi_axes);
  SurfaceHit hit;
  Trace unit{origin, direction, trace.t_min, trace.t_max, hit};
  ball(unit, Vec3::Zero(), 1);
  if (unit.found) trace.accept(hit.distance, hit.normal.cwiseQuotient(e.semi_axes).normalized());
}

void visit(Trace& trace, const RoundCone& c) {
  const double difference = c.radius_a - c.radius_b;
  if (c.length <= std::abs(difference)) {
    if (difference >= 0)
      ball(trace, Vec3::Zero(), c.radius_a);
    else
      ball(trace, Vec3(c.length, 0, 0), c.radius_b);
    return;
  }
  // The cone touches both spheres along circles; between these it is the hull, beyond them the spheres are.
  const double sine = difference / c.length, cosine = std::sqrt(1 - sine * sine);
  ball(trace, Vec3::Zero(), c.radius_a);
  if (c.radius_b > 0) ball(trace, Vec3(c.length, 0, 0), c.radius_b);
  frustum(trace, 0, c.radius_a * sine, c.radius_a * cosine, c.length + c.radius_b * sine, c.radius_b * cosine);
}

void visit(Trace& trace, const Cone& c) {
  ring(trace, 0, 0, c.radius, -1);
  frustum(trace, 2, 0, c.radius, c.height, 0);
}

void visit(Trace& trace, const Box& box) {
  double enter = -std::numeric_limits<double>::infinity(), leave = std::numeric_limits<double>::infinity();
  int enter_axis = 0, leave_axis = 0;
  for (int i = 0; i < 3; ++i) {
    const double h = box.half_extents[i], o = trace.origin[i], d = trace.direction[i];
    if (d == 0) {
      if (std::abs(o) > h) return;
      continue;
    }
    const double near = (-std::copysign(h, d) - o) / d, far = (std::copysign(h, d) - o) / d;
    if (near > enter) enter = near, enter_axis = i;
    if (far < leave) leave = far, leave_axis = i;
  }
  if (enter > leave) return;
  if (trace.in_range(enter)) {
    trace.accept(enter, -std::copysign(1.0, trace.direction[enter_axis]) * Vec3::Unit(enter_axis));
  } else if (trace.in_range(leave)) {
    trace.accept(leave, std::copysign(1.0, trace.direction[leave_axis]) * Vec3::Unit(leave_axis));
  }
}

void visit(Trace& trace, const Cylinder& c) {
  frustum(trace, 2, -c.half_height, c.radius, c.half_height, c.radius);
  ring(trace, -c.half_height, 0, c.radius, -1);
  ring(trace, c.half_height, 0, c.radius, 1);
}

void visit(Trace& trace, const HalfSpace& h) {
  const double approach = h.normal.dot(trace.direction);
  if (approach == 0) return;
  const double t = -h.normal.dot(trace.origin) / approach;
  if (trace.in_range(t)) trace.accept(t, h.normal);
}

void visit(Trace& trace, const Revolved& solid) {
  const std::size_t n = solid.profile.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& p = solid.profile[i];
    const Vec2& q = solid.profile[(i + 1) % n];
    if (p.x() == 0 && q.x() == 0) continue;
    const Vec2 edge = q - p;
    // The solid is on the left of an edge: an edge that runs outwards has it above, and faces down.
    if (std::abs(edge.y()) <= 1e-12 * std::abs(edge.x())) {
      ring(trace, p.y(), std::min(p.x(), q.x()), std::max(p.x(), q.x()), edge.x() > 0 ? -1 : 1);
      continue;
    }
    const double before = trace.t_max;
    frustum(trace, 2, p.y(), p.x(), q.y(), q.x());
    if (trace.t_max < before && edge.y() < 0) trace.hit.normal = -trace.hit.normal;
  }
}

void visit(Trace& trace, const TriMesh& mesh) {
  for (const auto& triangle : mesh.triangles) {
    const Vec3& a = mesh.vertices[static_cast<std::size_t>(triangle[0])];
    const Vec3 ab = mesh.vertices[static_cast<std::size_t>(triangle[1])] - a;
    const Vec3 ac = mesh.vertices[static_cast<std::size_t>(triangle[2])] - a;
    const Vec3 normal = ab.cross(ac), p = trace.direction.cross(ac);
    const double determinant = ab.dot(p);
    if (determinant == 0) continue;
    const Vec3 s = trace.origin - a;
    const double u = s.dot(p) / determinant;
    const Vec3 q = s.cross(ab);
    const double v = trace.direction.dot(q) / determinant, t = ac.dot(q) / determinant;
    if (u < 0 || v < 0 || u + v > 1 || !trace.in_range(t)) continue;
    trace.accept(t, normal.normalized());
  }
}

}  // namespace

bool intersect(const Primitive& primitive, const Vec3& origin, const Vec3& direction, double t_min, double t_max,
               SurfaceHit& hit) {
  Trace trace{origin, direction, t_min, t_max, hit};
  std::visit([&](const auto& p) { visit(trace, p); }, primitive);
  return trace.found;
}

}  // namespace repose
