#include "analysis/silhouette.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr double nothing = -std::numeric_limits<double>::infinity();

// max over t in [0, 1] of  climb t + sqrt(Q(t)),  Q = a t^2 + b t + c, where Q >= 0; `nothing` if Q < 0 throughout.
// `inner` = a - climb^2 < 0 for every proper hull. The extremum solves 4 a inner t^2 + 4 b inner t + b^2 - 4 climb^2 c = 0.
double hull_top(double climb, double a, double b, double c) {
  double best = nothing;
  const auto try_at = [&](double t) {
    if (!(t >= 0 && t <= 1)) return;
    const double q = (a * t + b) * t + c;
    if (q >= 0) best = std::max(best, climb * t + std::sqrt(q));
  };
  try_at(0);
  try_at(1);
  const double inner = a - climb * climb;
  const double qa = 4 * a * inner, qb = 4 * b * inner, qc = b * b - 4 * climb * climb * c;
  const double discriminant = qb * qb - 4 * qa * qc;
  if (discriminant < 0) return best;
  const double sum = -0.5 * (qb + std::copysign(std::sqrt(discriminant), qb));
  if (qa != 0) try_at(sum / qa);
  if (sum != 0) try_at(qc / sum);
  return best;
}

}  // namespace

double GrainPart::reach() const {
  if (is_hull) return std::max(radius_a, axis.norm() + radius_b);
  return std::sqrt(shape.trace());
}

std::vector<GrainPart> grain_parts(const Model& model, const Snapshot& state, const std::vector<int>& bodies) {
  std::vector<GrainPart> result;
  result.reserve(bodies.size() * 2);
  for (int index : bodies) {
    const std::size_t i = static_cast<std::size_t>(index);
    const Body& body = model.bodies[i];
    const Pose pose{state.position[i], state.orientation[i]};
    for (const Part& part : model.shapes[static_cast<std::size_t>(body.shape)].parts) {
      const Pose local{part.pose.position * body.scale, part.pose.orientation};
      const Pose world = pose.compose(local);
      GrainPart g;
      g.body = index;
      g.centre = world.position;
      if (const auto* sphere = std::get_if<Sphere>(&part.primitive)) {
        g.shape = Mat3::Identity() * std::pow(sphere->radius * body.scale, 2);
      } else if (const auto* ellipsoid = std::get_if<Ellipsoid>(&part.primitive)) {
        const Mat3 r = world.orientation.toRotationMatrix();
        g.shape = r * (ellipsoid->semi_axes * body.scale).cwiseAbs2().asDiagonal() * r.transpose();
      } else if (const auto* hull = std::get_if<RoundCone>(&part.primitive)) {
        g.is_hull = true;
        g.axis = world.orientation * Vec3(hull->length * body.scale, 0, 0);
        g.radius_a = hull->radius_a * body.scale;
        g.radius_b = hull->radius_b * body.scale;
      } else {
        throw Error("silhouette", "a grain has a part that is neither sphere, ellipsoid nor round cone",
                    "use the seven grain shapes for grains whose heap is measured");
      }
      result.push_back(g);
    }
  }
  return result;
}

double top_over_point(const GrainPart& part, const Vec2& point) {
  const Vec2 q = point - part.centre.head<2>();
  if (part.is_hull) {
    const Vec2 e = part.axis.head<2>();
    const double s = part.radius_b - part.radius_a, r = part.radius_a;
    const double top = hull_top(part.axis.z(), s * s - e.squaredNorm(), 2 * (r * s + q.dot(e)), r * r - q.squaredNorm());
    return part.centre.z() + top;
  }
  const Eigen::Matrix2d inverse = part.shape.topLeftCorner<2, 2>().inverse();
  const Vec2 b = part.shape.topRightCorner<2, 1>();
  const double inside = 1 - q.dot(inverse * q);
  if (inside < 0) return nothing;
  const double height = std::max(0.0, part.shape(2, 2) - b.dot(inverse * b));
  return part.centre.z() + b.dot(inverse * q) + std::sqrt(height * inside);
}

SideView::SideView(const GrainPart& part, const Vec2& across)
    : is_hull_(part.is_hull), s_(across.dot(part.centre.head<2>())), z_(part.centre.z()) {
  if (is_hull_) {
    es_ = across.dot(part.axis.head<2>());
    ez_ = part.axis.z();
    ra_ = part.radius_a;
    rb_ = part.radius_b;
    left_ = s_ + std::min(-ra_, es_ - rb_);
    right_ = s_ + std::max(ra_, es_ + rb_);
  } else {
    const Vec3 u(across.x(), across.y(), 0);
    const Vec3 su = part.shape * u;
    a_ = u.dot(su);
    b_ = su.z();
    c_ = part.shape(2, 2);
    left_ = s_ - std::sqrt(a_);
    right_ = s_ + std::sqrt(a_);
  }
}

double SideView::top(double s) const {
  const double q = s - s_;
  if (is_hull_) {
    const double step = rb_ - ra_;
    return z_ + hull_top(ez_, step * step - es_ * es_, 2 * (ra_ * step + q * es_), ra_ * ra_ - q * q);
  }
  const double inside = 1 - q * q / a_;
  if (inside < 0) return nothing;
  return z_ + b_ / a_ * q + std::sqrt(std::max(0.0, c_ - b_ * b_ / a_) * inside);
}

}  // namespace repose
