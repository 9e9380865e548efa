#pragma once
/// Vectors, rotations and poses. World frame: right-handed, z up. SI units.
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace repose {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;  ///< unit; rotates body coordinates into world coordinates

/// A rigid placement: x_world = position + orientation * x_local.
struct Pose {
  Vec3 position = Vec3::Zero();            ///< [m]
  Quat orientation = Quat::Identity();

  Vec3 to_world(const Vec3& local) const { return position + orientation * local; }
  Vec3 to_local(const Vec3& world) const { return orientation.conjugate() * (world - position); }
  /// The placement of `inner`, which is given relative to this one.
  Pose compose(const Pose& inner) const {
    return {to_world(inner.position), (orientation * inner.orientation).normalized()};
  }
};

/// Velocity of a rigid body: of its reference point [m/s] and angular [rad/s], both in the world frame.
struct Twist {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();
};

/// The rotation by the vector `w` (axis times angle [rad]); exact for any angle, accurate for a tiny one.
Quat rotation_of(const Vec3& w);

}  // namespace repose
