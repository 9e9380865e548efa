#include "backends/dvi/collide_revolved.hpp"

#include "backends/dvi/collide_segment.hpp"

namespace repose::dvi {

namespace {

/// Adds the contact of a ball with the surface whose outward normal is `n`, at `distance` from the ball's centre.
void add_ball(const PlacedProfile& b, const Vec3& centre, double radius, const Vec3& n, double distance,
              std::uint32_t feature, const ContactSink& sink) {
  const double gap = b.scale * (distance - radius);
  if (!(gap <= sink.margin)) return;
  const Vec3 outward = b.rotation * n;
  sink.add(b.to_world(centre) - (b.scale * radius + 0.5 * gap) * outward, -outward, gap, feature);
}

/// A ball that touches a hollow all round: the tangent planes a third of a turn away hold it as well.
void add_ring(const PlacedProfile& b, const Vec3& centre, const HalfPlane& at, double radius, double reach,
              const ProfileNearest& nearest, std::uint32_t feature, const ContactSink& sink) {
  if (!(nearest.normal.x() < 0)) return;
  const Vec2 foot = at.point - nearest.distance * nearest.normal;
  const double opposite2 =
      (foot.x() + at.point.x()) * (foot.x() + at.point.x()) + (foot.y() - at.point.y()) * (foot.y() - at.point.y());
  if (opposite2 > reach * reach) return;
  for (int turn = 0; turn < 2; ++turn) {
    constexpr double half_sqrt3 = 0.86602540378443865;
    const double sine = turn == 0 ? half_sqrt3 : -half_sqrt3;
    const Vec3 radial(-0.5 * at.radial.x() - sine * at.radial.y(), sine * at.radial.x() - 0.5 * at.radial.y(), 0);
    const Vec3 point = foot.x() * radial + Vec3(0, 0, foot.y());
    const Vec3 n = nearest.normal.x() * radial + Vec3(0, 0, nearest.normal.y());
    add_ball(b, centre, radius, n, n.dot(centre - point), feature + (turn == 0 ? 0x40000000u : 0x80000000u), sink);
  }
}

void collide_local_ball(const Vec3& centre, double radius, const PlacedProfile& b, const ContactSink& sink,
                        std::uint32_t offset, std::uint32_t stride) {
  const HalfPlane at(centre);
  const double reach = radius + sink.margin / b.scale;
  const auto add = [&](const ProfileNearest& nearest) {
    const std::uint32_t feature = offset + stride * nearest.feature.id();
    add_ball(b, centre, radius, at.lift(nearest.normal), nearest.distance, feature, sink);
    if (!b.convex) add_ring(b, centre, at, radius, reach, nearest, feature, sink);
  };
  if (b.convex)
    add(nearest_on_profile(b.profile, at.point));
  else
    for_each_near_feature(b.profile, at.point, reach, add);
}

}  // namespace

void collide_sphere_profile(const PlacedSphere& a, const PlacedProfile& b, const ContactSink& sink,
                            std::uint32_t feature_offset, std::uint32_t feature_stride) {
  collide_local_ball(b.to_local(a.centre), a.radius / b.scale, b, sink, feature_offset, feature_stride);
}

namespace {

/// Distance from one feature, extended over its whole cone or circle, and whether the foot lies on the feature itself.
struct FeatureDistance {
  double distance = 0;
  Vec3 normal = Vec3::UnitZ();
  bool on_feature = false;
};

FeatureDistance feature_distance(const Profile& profile, ProfileFeature feature, const Vec3& p) {
  const HalfPlane at(p);
  const Vec2 d = at.point - profile.point(feature.index);
  if (feature.vertex) {
    const double distance = d.norm();
    const Vec2 n = distance > 0 ? Vec2(d / distance) : profile.vertex_normal(feature.index).normalized();
    return {distance, at.lift(n), profile.in_vertex_cone(feature.index, n)};
  }
  const Vec2 n = profile.normal(feature.index), dir = profile.direction(feature.index);
  const double along = d.dot(dir);
  return {n.dot(d), at.lift(n), along >= 0 && along <= dir.squaredNorm()};
}

/// The side of a round cone against one feature: minima of distance - radius strictly between its ends.
void collide_side(const PlacedRoundCone& a, ProfileFeature feature, const PlacedProfile& b, std::uint32_t name,
                  const ContactSink& sink) {
  constexpr int pieces = 4;
  const auto derivative = [&](double s) {
    return feature_distance(b.profile, feature, a.centre(s)).normal.dot(a.axis) + a.slope;
  };
  double low_start = 0, g_start = derivative(0);
  std::uint32_t found = 0;
  for (int piece = 1; piece <= pieces; ++piece) {
    const double high_start = a.length * piece / pieces, g_end = derivative(high_start);
    if (g_start < 0 && g_end > 0) {
      double low = low_start, high = high_start, g_low = g_start, g_high = g_end, s = low;
      for (int k = 0; k < 80 && high - low > 1e-14 * a.length; ++k) {
        s = k % 3 == 2 ? 0.5 * (low + high) : low + (high - low) * (g_low / (g_low - g_high));
        const double g = derivative(s);
        if (std::abs(g) < 1e-14) break;
        if (g < 0) {
          low = s;
          g_low = g;
          if (k % 3 != 2) g_high *= 0.5;
        } else {
          high = s;
          g_high = g;
          if (k % 3 != 2) g_low *= 0.5;
        }
      }
      const FeatureDistance foot = feature_distance(b.profile, feature, a.centre(s));
      if (foot.on_feature && foot.distance >= 0)
        add_ball(b, a.centre(s), a.radius(s), foot.normal, foot.distance, name + found++, sink);
    }
    low_start = high_start;
    g_start = g_end;
  }
}

}  // namespace

PlacedRoundCone to_local(const PlacedRoundCone& a, const PlacedProfile& b) {
  return {b.to_local(a.start),      b.rotation.transpose() * a.axis, a.length / b.scale,
          a.radius_start / b.scale, a.radius_end / b.scale,          a.slope};
}

void collide_sides(const PlacedRoundCone& a, double reach, const PlacedProfile& b, const ContactSink& sink,
                   std::uint32_t feature_offset, std::uint32_t feature_stride) {
  const Profile& profile = b.profile;
  const HalfPlane at(a.centre(0.5 * a.length));
  const auto name = [&](ProfileFeature f) { return feature_offset + feature_stride * f.id(); };
  for (int k = 0; k < profile.size(); ++k) {
    const Vec2 d = at.point - profile.point(k);
    if (profile.is_surface(k)) {
      const Vec2 dir = profile.direction(k);
      const double length = dir.norm(), along = d.dot(dir);
      const double side = (d.x() * dir.y() - d.y() * dir.x()) / length;
      if (dir.y() > 0 && std::abs(side) <= reach && along > -reach * length && along < (length + reach) * length)
        collide_side(a, {k, false}, b, name({k, false}), sink);
    }
    if (d.squaredNorm() <= reach * reach && profile.is_convex(k)) collide_side(a, {k, true}, b, name({k, true}), sink);
  }
}

bool collide_round_cone_profile(const PlacedRoundCone& world, const PlacedProfile& b, const ContactSink& sink) {
  const PlacedRoundCone a = to_local(world, b);
  const Profile& profile = b.profile;
  const double largest = std::max(a.radius_start, a.radius_end);
  const double reach = 0.5 * a.length + largest + sink.margin / b.scale;
  const Vec3 middle = a.centre(0.5 * a.length);
  const HalfPlane at(middle);
  const ProfileNearest nearest = nearest_on_profile(profile, at.point);
  if (nearest.distance > reach) return true;
  SegmentMinimum least;
  if (b.convex) {
    least = minimise_along(a, [&](const Vec3& p) {
      const HalfPlane there(p);
      const ProfileNearest found = nearest_on_profile(profile, there.point);
      return PointDistance{found.distance, there.lift(found.normal)};
    });
    if (least.nearest.distance <= 0) return false;
  }
  collide_local_ball(a.start, a.radius_start, b, sink, 0, 8);
  if (a.length == 0) return true;
  collide_local_ball(a.centre(a.length), a.radius_end, b, sink, 1, 8);
  if (!b.convex)
    collide_sides(a, reach, b, sink, 2, 8);
  else if (least.s > 0 && least.s < a.length)
    add_ball(b, a.centre(least.s), a.radius(least.s), least.nearest.normal, least.nearest.distance, 2, sink);
  return true;
}

}  // namespace repose::dvi
