#include "backends/dvi/collide_box.hpp"

#include <Eigen/LU>

#include "backends/dvi/collide_ellipsoid.hpp"
#include "backends/dvi/collide_segment.hpp"

namespace repose::dvi {

namespace {

/// In the frame of the box.
PointDistance distance_to_box(const Vec3& half, const Vec3& p) {
  const Vec3 nearest = p.cwiseMax(-half).cwiseMin(half);
  const Vec3 d = p - nearest;
  const double outside = d.norm();
  if (outside > 0) return {outside, d / outside};
  int axis = 0;
  double depth = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double value = std::abs(p[i]) - half[i];
    if (value > depth) {
      depth = value;
      axis = i;
    }
  }
  Vec3 n = Vec3::Zero();
  n[axis] = p[axis] < 0 ? -1 : 1;
  return {depth, n};
}

void add_ball(const PlacedBox& b, const Vec3& centre, double radius, const PointDistance& d, std::uint32_t feature,
              const ContactSink& sink) {
  const double gap = d.distance - radius;
  if (!(gap <= sink.margin)) return;
  const Vec3 outward = b.rotation * d.normal;
  sink.add(b.centre + b.rotation * centre - (radius + 0.5 * gap) * outward, -outward, gap, feature);
}

}  // namespace

PointDistance point_distance(const PlacedBox& box, const Vec3& point) {
  const PointDistance local = distance_to_box(box.half_extents, box.rotation.transpose() * (point - box.centre));
  return {local.distance, box.rotation * local.normal};
}

void collide_sphere_box(const PlacedSphere& a, const PlacedBox& b, const ContactSink& sink) {
  const Vec3 centre = b.rotation.transpose() * (a.centre - b.centre);
  add_ball(b, centre, a.radius, distance_to_box(b.half_extents, centre), 0, sink);
}

bool collide_round_cone_box(const PlacedRoundCone& a, const PlacedBox& b, const ContactSink& sink) {
  const PlacedRoundCone own{b.rotation.transpose() * (a.start - b.centre),
                            b.rotation.transpose() * a.axis,
                            a.length,
                            a.radius_start,
                            a.radius_end,
                            a.slope};
  const auto distance = [&](const Vec3& p) { return distance_to_box(b.half_extents, p); };
  const Vec3 middle = own.centre(0.5 * own.length);
  if (distance(middle).distance > 0.5 * own.length + std::max(a.radius_start, a.radius_end) + sink.margin) return true;
  const SegmentMinimum least = minimise_along(own, distance);
  if (least.nearest.distance <= 0) return false;
  add_ball(b, own.start, a.radius_start, distance(own.start), 0, sink);
  if (a.length > 0) add_ball(b, own.centre(a.length), a.radius_end, distance(own.centre(a.length)), 1, sink);
  if (least.s > 0 && least.s < a.length) add_ball(b, own.centre(least.s), a.radius(least.s), least.nearest, 2, sink);
  return true;
}

bool collide_ellipsoid_box(const PlacedEllipsoid& a, const PlacedBox& b, const ContactSink& sink) {
  // In the frame of the box; the ellipsoid's rotation seen from there.
  const Mat3 turn = b.rotation.transpose() * a.rotation;
  const Vec3 centre = b.rotation.transpose() * (a.centre - b.centre), &half = b.half_extents, &e = a.semi_axes;
  const double largest = e.maxCoeff();
  const PointDistance from_box = distance_to_box(half, centre);
  if (from_box.distance > largest + sink.margin) return true;
  if (from_box.distance <= 0) return false;

  const auto nearest = [&](const Vec3& p) { return nearest_on_ellipsoid(e, turn.transpose() * (p - centre)); };
  // Start below the ellipsoid's lowest point over the face or edge that the centre sees.
  const Vec3 lowered = e.cwiseProduct(turn.transpose() * from_box.normal);
  const Vec3 lowest = centre - turn * e.cwiseProduct(lowered) / lowered.norm();
  Vec3 p = lowest.cwiseMax(-half).cwiseMin(half);
  // Straight over a face, and not deep: the lowest point and its foot on the face are the witness points.
  const double over_face = from_box.distance - lowered.norm();
  const Vec3 beside = (lowest.cwiseAbs() - half).cwiseProduct(Vec3::Ones() - from_box.normal.cwiseAbs());
  if (from_box.normal.cwiseAbs().maxCoeff() == 1 && beside.maxCoeff() <= 0 && over_face > -0.2 * e.minCoeff()) {
    const Vec3 outward = b.rotation * from_box.normal;
    sink.add(b.centre + b.rotation * lowest - 0.5 * over_face * outward, -outward, over_face, 0);
    return true;
  }
  EllipsoidPoint now = nearest(p);
  for (int iteration = 0; iteration < 60; ++iteration) {
    const Vec3 g = turn * now.normal();
    Mat3 h = turn * distance_hessian(e, now) * turn.transpose();
    Vec3 slope = g;
    bool any = false;
    for (int i = 0; i < 3; ++i) {
      const bool pinned = (p[i] >= half[i] && g[i] <= 0) || (p[i] <= -half[i] && g[i] >= 0);
      if (!pinned) {
        any = any || std::abs(g[i]) > 1e-15;
        h(i, i) += 1e-9 / largest;
        continue;
      }
      h.row(i).setZero();
      h.col(i).setZero();
      h(i, i) = 1;
      slope[i] = 0;
    }
    if (!any) break;
    Vec3 move = -(h.inverse() * slope);
    const double length = move.norm();
    if (!(length < largest)) move = -slope * (0.5 * largest / slope.norm());
    bool moved = false;
    for (double step = 1; step > 1e-9; step *= 0.5) {
      const Vec3 trial = (p + step * move).cwiseMax(-half).cwiseMin(half);
      const EllipsoidPoint there = nearest(trial);
      const double change = there.distance() - now.distance();
      if (change <= 1e-4 * slope.dot(trial - p) || (step == 1 && length < 1e-6 * largest && change < 1e-14 * largest)) {
        moved = (trial - p).norm() > 1e-14 * largest;
        p = trial;
        now = there;
        break;
      }
    }
    if (!moved) break;
  }
  const Vec3 n = turn * now.normal();  // outward from the ellipsoid
  const double gap = now.distance();
  // Weak duality: along n the two are at least `certain` apart; equality proves that no better normal exists.
  const Vec3 scaled_normal = e.cwiseProduct(turn.transpose() * n);
  const double certain = -(half.dot(n.cwiseAbs()) + n.dot(centre) + scaled_normal.norm());
  if (gap - certain > 1e-7 * largest) return gap > sink.margin;
  sink.add(b.centre + b.rotation * (p - 0.5 * gap * n), b.rotation * n, gap, 0);
  return true;
}

}  // namespace repose::dvi
