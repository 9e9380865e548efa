#pragma once
/// Prescribed motion of a tool, and the times at which it is there at all.
#include <vector>

#include "core/math.hpp"

namespace repose {

/// pose(t) for a body that no contact can move.
///
/// Between `start` and `stop` the body translates with `velocity` and turns with `angular_velocity` about the line
/// through `pivot` (which translates with it); outside it stands still. A vibration
///   x(t) += amplitude sin(2 pi frequency t + phase) - amplitude sin(phase)
/// is added at all times.
struct Motion {
  Vec3 velocity = Vec3::Zero();          ///< [m/s], world frame
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s], world frame
  Vec3 pivot = Vec3::Zero();             ///< [m], a point of the axis at `start`, world frame
  double start = 0;                      ///< [s]
  double stop = 1e300;                   ///< [s], >= start
  Vec3 vibration_amplitude = Vec3::Zero();  ///< [m], world frame
  double vibration_frequency = 0;        ///< [Hz], >= 0
  double vibration_phase = 0;            ///< [rad]

  bool operator==(const Motion&) const = default;
};

/// How a body of prescribed motion gives way upward, like a roller whose carriage is held down by a weight. It follows its Motion
/// along x and y and in turning. Along z it stands on rigid stops where the motion would have it, and rises where contacts
/// push harder than the load:
///   mass dw/dt = F_z - load + N,   N >= 0,   z >= z of pose_at(),   N (z - that) = 0.
struct Yield {
  double load = 0;  ///< [N], >= 0, all that presses down: no weight is added
  double mass = 0;  ///< of what moves up and down [kg], > 0

  bool operator==(const Yield&) const = default;
};

/// The pose at time t of a body that starts at `initial`.
Pose pose_at(const Motion& motion, const Pose& initial, double t);

/// The constant twist that carries the body from pose_at(t) to pose_at(t + h): what a time stepper must use so that a
/// wall is where it was prescribed to be at the end of each step.
Twist mean_twist(const Motion& motion, const Pose& initial, double t, double h);

/// The clock is set to 0 at time t >= 0:  pose_at(motion', initial', s) = pose_at(motion, initial, t + s)  for s >= 0.
void set_clock_to_zero_at(double t, Motion& motion, Pose& initial);

/// A stretch of time [from, to) [s].
struct Interval {
  double from = 0, to = 1e300;
};

}  // namespace repose
