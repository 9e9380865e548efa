#include "core/body_frame.hpp"

#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"

namespace repose {

Pose body_pose(const Shape& shape, double scale, const Pose& own) {
  const Quat orientation = (own.orientation * shape.own_frame.orientation.conjugate()).normalized();
  return {own.position - orientation * (scale * shape.own_frame.position), orientation};
}

Pose own_pose(const Shape& shape, double scale, const Pose& body) {
  return body.compose({scale * shape.own_frame.position, shape.own_frame.orientation});
}

Twist body_twist(const Shape& shape, double scale, const Pose& own, const Twist& own_twist) {
  const Vec3 arm = body_pose(shape, scale, own).position - own.position;
  return {own_twist.linear + own_twist.angular.cross(arm), own_twist.angular};
}

Shape aligned_with_own_frame(const Shape& shape) {
  Shape aligned = shape;
  const Quat to_own = shape.own_frame.orientation.conjugate();
  const Pose turn{Vec3::Zero(), to_own};
  for (Part& part : aligned.parts) part.pose = turn.compose(part.pose);
  const Mat3 rotation = to_own.toRotationMatrix();
  aligned.mass.centre = rotation * shape.mass.centre;
  aligned.mass.inertia = rotation * shape.mass.inertia * rotation.transpose();
  aligned.own_frame = turn.compose(shape.own_frame);
  aligned.own_frame.orientation = Quat::Identity();
  return aligned;
}

Shape with_centre_offset(const Shape& shape, const Vec3& offset) {
  Shape moved = shape;
  const Vec3 shift = shape.own_frame.orientation * offset;
  for (Part& part : moved.parts) part.pose.position -= shift;
  moved.mass.centre -= shift;
  moved.own_frame.position -= shift;
  moved.bounding_radius += shift.norm();
  return moved;
}

Vec3 scaled_inertia(const Shape& shape, const Vec3& moments, const Vec3& factor) {
  // Columns: the own axes seen from the body frame; rows: the principal axes.
  const Mat3 own = shape.own_frame.orientation.toRotationMatrix();
  Vec3 result = moments;
  for (int k = 0; k < 3; ++k) {
    Eigen::Index nearest = 0;
    own.row(k).cwiseAbs().maxCoeff(&nearest);
    result[k] *= factor[nearest];
  }
  return result;
}

Body dynamic_body(const Shape& shape, int shape_index, double scale, double density, int material) {
  assert(scale > 0 && density > 0);
  if (!(shape.mass.volume > 0) || !std::isfinite(shape.mass.volume))
    throw Error("", "a " + shape.kind + " has no finite mass and cannot move freely",
                "make the body fixed or give it a motion");
  Body body;
  body.shape = shape_index;
  body.scale = scale;
  body.material = material;
  body.volume = shape.mass.volume * scale * scale * scale;
  body.mass = density * body.volume;
  body.inertia = body.mass * scale * scale * (shape.mass.inertia.diagonal() / shape.mass.volume);
  body.radius = std::cbrt(body.volume * (3 / (4 * std::numbers::pi)));
  return body;
}

Body prescribed_body(int shape_index, int material, const Motion& motion) {
  Body body;
  body.shape = shape_index;
  body.material = material;
  body.dynamic = false;
  body.radius = std::numeric_limits<double>::infinity();
  body.motion = motion;
  return body;
}

}  // namespace repose
