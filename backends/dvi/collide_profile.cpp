#include "backends/dvi/collide_profile.hpp"

namespace repose::dvi {

ProfileNearest nearest_on_profile(const Profile& profile, const Vec2& p) {
  double best = std::numeric_limits<double>::infinity();
  int best_edge = -1;
  int best_end = 0;  // 0: inside the edge, -1: at its start, 1: at its end
  for (int k = 0; k < profile.size(); ++k) {
    if (!profile.is_surface(k)) continue;
    const Vec2 d = p - profile.point(k), dir = profile.direction(k);
    const double along = d.dot(dir), length2 = dir.squaredNorm();
    double distance2;
    int end = 0;
    if (along <= 0) {
      distance2 = d.squaredNorm();
      end = -1;
    } else if (along >= length2) {
      distance2 = (d - dir).squaredNorm();
      end = 1;
    } else {
      const double side = d.x() * dir.y() - d.y() * dir.x();
      distance2 = side * side / length2;
    }
    if (distance2 < best) {
      best = distance2;
      best_edge = k;
      best_end = end;
    }
  }
  ProfileNearest result;
  if (best_end == 0) {
    const Vec2 n = profile.normal(best_edge);
    result.feature = {best_edge, false};
    result.normal = n;
    result.distance = n.dot(p - profile.point(best_edge));
    return result;
  }
  const int vertex = best_end < 0 ? best_edge : profile.next(best_edge);
  result.feature = {vertex, true};
  const Vec2 d = p - profile.point(vertex), outward = profile.vertex_normal(vertex);
  const double distance = std::sqrt(best), sign = d.dot(outward) < 0 ? -1 : 1;
  result.distance = sign * distance;
  result.normal = distance > 0 ? Vec2(sign * d / distance) : Vec2(outward.normalized());
  return result;
}

std::array<Vec2, 4> profile_of(const Cylinder& cylinder, double scale) {
  const double r = scale * cylinder.radius, h = scale * cylinder.half_height;
  return {Vec2(0, -h), Vec2(r, -h), Vec2(r, h), Vec2(0, h)};
}

std::array<Vec2, 3> profile_of(const Cone& cone, double scale) {
  return {Vec2(0, 0), Vec2(scale * cone.radius, 0), Vec2(0, scale * cone.height)};
}

}  // namespace repose::dvi
