#pragma once
/// From shapes to bodies: mass and inertia from the density, and the way between a shape's own frame and the body frame.
///
/// A user describes a shape in its own frame (a box about its middle, a compound about any point). The model keeps each
/// body in its body frame: origin at the centre of mass, axes principal. The two differ by Shape::own_frame.
#include "core/model.hpp"

namespace repose {

/// Pose of the body frame, given that of the shape's own frame (`scale`: Body::scale).
Pose body_pose(const Shape& shape, double scale, const Pose& own);

/// Pose of the shape's own frame, given that of the body frame: the inverse of body_pose.
Pose own_pose(const Shape& shape, double scale, const Pose& body);

/// Velocity of the centre of mass [m/s], given the velocity of the own origin and the angular velocity (world frame).
/// `own`: pose of the own frame.
Twist body_twist(const Shape& shape, double scale, const Pose& own, const Twist& own_twist);

/// The same shape with body axes parallel to its own axes: for a body whose moments of inertia are given about those.
Shape aligned_with_own_frame(const Shape& shape);

/// The same shape with its centre of mass moved by `offset` (own axes, in the unit of the shape): its parts lie that much
/// the other way in the body frame.
Shape with_centre_offset(const Shape& shape, const Vec3& offset);

/// The moments of a body times a factor about each own axis of its shape: each goes to the nearest principal axis.
Vec3 scaled_inertia(const Shape& shape, const Vec3& moments, const Vec3& factor);

/// A body that moves freely. Mass, inertia, volume and radius follow from the shape at `density` [kg/m^3] > 0.
/// Throws Error for a shape without finite mass.
Body dynamic_body(const Shape& shape, int shape_index, double scale, double density, int material);

/// A fixed or prescribed body: infinite mass and radius.
Body prescribed_body(int shape_index, int material, const Motion& motion = {});

}  // namespace repose
