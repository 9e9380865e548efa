#include "backends/dvi/collide_gjk.hpp"
#include "backends/dvi/collide_simplex.hpp"

namespace repose::dvi {

namespace {

/// Up to four points of the difference and the weights of the point of their hull that is nearest to the origin.
struct Simplex {
  std::array<DifferencePoint, 4> points;
  std::array<double, 4> weights{};
  int count = 0;

  DifferencePoint nearest() const {
    DifferencePoint p;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      p.w += weights[k] * points[k].w;
      p.on_a += weights[k] * points[k].on_a;
      p.on_b += weights[k] * points[k].on_b;
    }
    return p;
  }
};

/// Distance 0 with no weights if the origin is inside.
Weights on_tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double volume = (b - a).cross(c - a).dot(d - a);
  const double scale = std::max({(b - a).norm(), (c - a).norm(), (d - a).norm()});
  const bool flat = !(std::abs(volume) > 1e-14 * scale * scale * scale);
  const auto outside = [&](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& other) {
    const Vec3 n = (q - p).cross(r - p);
    return flat || n.dot(-p) * n.dot(other - p) < 0;
  };
  Weights best;
  bool inside = true;
  const auto consider = [&](const Vec3& p, const Vec3& q, const Vec3& r, std::array<std::size_t, 3> index) {
    inside = false;
    const Weights t = on_triangle(p, q, r);
    if (t.distance2 >= best.distance2) return;
    best = {};
    best.distance2 = t.distance2;
    for (std::size_t k = 0; k < 3; ++k) best.w[index[k]] = t.w[k];
  };
  if (outside(a, b, c, d)) consider(a, b, c, {0, 1, 2});
  if (outside(a, b, d, c)) consider(a, b, d, {0, 1, 3});
  if (outside(a, c, d, b)) consider(a, c, d, {0, 2, 3});
  if (outside(b, c, d, a)) consider(b, c, d, {1, 2, 3});
  if (inside) best.distance2 = 0;
  return best;
}

/// Finds the nearest point and drops the points that do not carry it. False if the origin is inside.
bool reduce(Simplex& s) {
  Weights found;
  const auto& p = s.points;
  switch (s.count) {
    case 1:
      found = {{1, 0, 0, 0}, p[0].w.squaredNorm()};
      break;
    case 2:
      found = on_segment(p[0].w, p[1].w);
      break;
    case 3:
      found = on_triangle(p[0].w, p[1].w, p[2].w);
      break;
    default:
      found = on_tetrahedron(p[0].w, p[1].w, p[2].w, p[3].w);
      break;
  }
  if (s.count == 4 && found.distance2 == 0) return false;
  int kept = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(s.count); ++k) {
    if (found.w[k] <= 0) continue;
    s.points[static_cast<std::size_t>(kept)] = s.points[k];
    s.weights[static_cast<std::size_t>(kept++)] = found.w[k];
  }
  s.count = kept;
  return true;
}

}  // namespace

CoreDistance core_distance(const Difference& difference, double margin) {
  const double size = difference.size();
  Vec3 start = difference.a.centre - difference.b.centre;
  if (!(start.norm() > 1e-12 * size)) start = difference.a.rotation.col(0) * size;
  Simplex simplex;
  simplex.points[0] = difference.support(-start);
  simplex.weights[0] = 1;
  simplex.count = 1;
  CoreDistance result;
  result.nearest = simplex.points[0];
  result.distance = result.nearest.w.norm();
  for (int iteration = 0; iteration < 128; ++iteration) {
    const Vec3 v = result.nearest.w;
    const double distance = result.distance;
    if (!(distance > 1e-9 * size)) {
      result.state = CoreDistance::State::touching;
      return result;
    }
    const DifferencePoint p = difference.support(-v);
    const double along = v.dot(p.w);
    if (along > margin * distance) {
      result.state = CoreDistance::State::beyond;
      return result;
    }
    if (distance * distance - along <= 1e-10 * distance * distance + 2e-16 * size * distance) return result;
    simplex.points[static_cast<std::size_t>(simplex.count++)] = p;
    if (!reduce(simplex)) {
      result.state = CoreDistance::State::touching;
      return result;
    }
    const DifferencePoint nearest = simplex.nearest();
    const double next = nearest.w.norm();
    if (!(next < distance)) return result;  // as near as rounding allows
    result.nearest = nearest;
    result.distance = next;
  }
  return result;
}

}  // namespace repose::dvi
