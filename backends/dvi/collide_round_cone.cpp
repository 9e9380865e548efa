#include "backends/dvi/collide_round_cone.hpp"

#include <array>

#include "backends/dvi/collide_ellipsoid.hpp"
#include "backends/dvi/collide_segment.hpp"

namespace repose::dvi {

RoundConePoint nearest_on_round_cone(const PlacedRoundCone& cone, const Vec3& point) {
  const Vec3 d = point - cone.start;
  const double x = d.dot(cone.axis);
  const Vec3 across = d - x * cone.axis;
  const double q = across.norm();
  const double cosine = std::sqrt(1 - cone.slope * cone.slope);
  RoundConePoint result;
  result.s = std::clamp(x - q * cone.slope / cosine, 0.0, cone.length);
  const Vec3 from = d - result.s * cone.axis;
  const double distance = from.norm();
  result.nearest.distance = distance - cone.radius(result.s);
  result.nearest.normal =
      distance > 0 ? Vec3(from / distance) : Vec3(cone.slope * cone.axis + cosine * any_perpendicular(cone.axis));
  return result;
}

void collide_sphere_round_cone(const PlacedSphere& a, const PlacedRoundCone& b, const ContactSink& sink) {
  const PointDistance d = nearest_on_round_cone(b, a.centre).nearest;
  const double gap = d.distance - a.radius;
  sink.add(a.centre - (a.radius + 0.5 * gap) * d.normal, -d.normal, gap, 0);
}

namespace {

struct AxisPair {
  double s = 0, t = 0;
  Vec3 normal = Vec3::UnitZ();  ///< from a to b
  double gap = std::numeric_limits<double>::infinity();
};

/// Both feet inside their axes: n makes a fixed angle with each axis (n.ua = slope_a, n.ub = -slope_b), so that it is
/// known from the axes alone; then  b(t) - a(s) = d n  is linear in s, t, d. The problem is convex: if such a point
/// exists, it is the minimum.
bool side_to_side(const PlacedRoundCone& a, const PlacedRoundCone& b, AxisPair& out) {
  if (a.length == 0 || b.length == 0) return false;
  const Vec3 cross = a.axis.cross(b.axis);
  const double sin2 = cross.squaredNorm();
  if (!(sin2 > 1e-20)) return false;
  const double c = a.axis.dot(b.axis);
  const Vec3 in_plane = ((a.slope + c * b.slope) * a.axis + (-b.slope - c * a.slope) * b.axis) / sin2;
  const double rest = 1 - in_plane.squaredNorm();
  if (!(rest > 0)) return false;
  const Vec3 w = b.start - a.start;
  const double height = w.dot(cross), up = std::sqrt(rest / sin2);
  const Vec3 n = in_plane + std::copysign(up, height) * cross;
  const double d = std::abs(height) / (up * sin2);
  const Vec3 v = w - d * n;  // v + t ub = s ua
  const double va = v.dot(a.axis), vb = v.dot(b.axis);
  const double s = (va - c * vb) / sin2, t = (c * va - vb) / sin2;
  if (!(s >= 0 && s <= a.length && t >= 0 && t <= b.length)) return false;
  out = {s, t, n, d - a.radius(s) - b.radius(t)};
  return true;
}

/// Which halves of the axes touch: survives the exchange of main and second contact when the sides are parallel.
std::uint32_t halves(const PlacedRoundCone& a, const PlacedRoundCone& b, const AxisPair& p) {
  return (2 * p.s > a.length ? 2u : 0u) + (2 * p.t > b.length ? 1u : 0u);
}

void add_pair(const PlacedRoundCone& a, const AxisPair& p, std::uint32_t feature, const ContactSink& sink) {
  sink.add(a.centre(p.s) + (a.radius(p.s) + 0.5 * p.gap) * p.normal, p.normal, p.gap, feature);
}

}  // namespace

void collide_round_cones(const PlacedRoundCone& a, const PlacedRoundCone& b, const ContactSink& sink) {
  std::array<AxisPair, 4> ends;
  for (int k = 0; k < 2; ++k) {
    const double s = k == 0 ? 0 : a.length;
    const RoundConePoint p = nearest_on_round_cone(b, a.centre(s));
    ends[static_cast<std::size_t>(k)] = {s, p.s, -p.nearest.normal, p.nearest.distance - a.radius(s)};
    const double t = k == 0 ? 0 : b.length;
    const RoundConePoint q = nearest_on_round_cone(a, b.centre(t));
    ends[static_cast<std::size_t>(k) + 2] = {q.s, t, q.nearest.normal, q.nearest.distance - b.radius(t)};
  }
  AxisPair main = ends[0];
  for (const AxisPair& end : ends)
    if (end.gap < main.gap) main = end;
  AxisPair side;
  if (side_to_side(a, b, side)) main = side;
  if (!(main.gap <= sink.margin)) return;
  const std::uint32_t feature = halves(a, b, main);
  add_pair(a, main, feature, sink);
  // The end farthest from the main contact that is within the margin as well.
  int other = -1;
  double farthest = 1e-3 * (a.length + b.length);
  for (int k = 0; k < 4; ++k) {
    const AxisPair& end = ends[static_cast<std::size_t>(k)];
    const double away = std::min(std::abs(end.s - main.s), std::abs(end.t - main.t));
    if (end.gap <= sink.margin && away > farthest) {
      farthest = away;
      other = k;
    }
  }
  if (other < 0) return;
  const AxisPair& second = ends[static_cast<std::size_t>(other)];
  const std::uint32_t second_feature = halves(a, b, second);
  add_pair(a, second, second_feature == feature ? feature + 4 : second_feature, sink);
}

bool collide_ellipsoid_round_cone(const PlacedEllipsoid& a, const PlacedRoundCone& b, const ContactSink& sink) {
  const double half = 0.5 * b.length, largest = a.semi_axes.maxCoeff();
  const double reach = largest + half + std::max(b.radius_start, b.radius_end) + sink.margin;
  if ((b.centre(half) - a.centre).squaredNorm() > reach * reach) return true;
  const SegmentMinimum m = minimise_along(b, [&](const Vec3& p) { return point_distance(a, p); });
  if (m.gap > sink.margin) return true;
  const Vec3& n = m.nearest.normal;
  // Weak duality: along n the two are at least `certain` apart; equality proves that no better normal exists.
  const double support = a.semi_axes.cwiseProduct(a.rotation.transpose() * n).norm();
  const double certain =
      std::min(n.dot(b.start - a.centre) - b.radius_start, n.dot(b.centre(b.length) - a.centre) - b.radius_end) -
      support;
  if (m.gap - certain > 1e-7 * largest) return false;
  const double r = b.radius(m.s);
  sink.add(b.centre(m.s) - (r + 0.5 * m.gap) * n, n, m.gap, 0);
  return true;
}

void collide_round_cone_plane(const PlacedRoundCone& a, const Vec3& plane_point, const Vec3& plane_normal,
                              const ContactSink& sink) {
  for (int end = 0; end < (a.length == 0 ? 1 : 2); ++end) {
    const Vec3 c = a.centre(end == 0 ? 0 : a.length);
    const double r = end == 0 ? a.radius_start : a.radius_end;
    const double gap = plane_normal.dot(c - plane_point) - r;
    sink.add(c - (r + 0.5 * gap) * plane_normal, -plane_normal, gap, static_cast<std::uint32_t>(end));
  }
}

}  // namespace repose::dvi
