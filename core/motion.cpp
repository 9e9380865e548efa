#include "core/motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace repose {
namespace {

/// How long the prescribed motion has lasted at time t [s].
double elapsed(const Motion& motion, double t) { return std::clamp(t, motion.start, motion.stop) - motion.start; }

Vec3 vibration(const Motion& motion, double t) {
  const double turn = 2 * std::numbers::pi * motion.vibration_frequency * t;
  return motion.vibration_amplitude * (std::sin(turn + motion.vibration_phase) - std::sin(motion.vibration_phase));
}

}  // namespace

Pose pose_at(const Motion& motion, const Pose& initial, double t) {
  const double s = elapsed(motion, t);
  Pose pose = initial;
  // Without a turn the pivot cancels out; leaving it out keeps a body that stands still where it is, to the last bit.
  if (!motion.angular_velocity.isZero(0)) {
    const Quat turn = rotation_of(motion.angular_velocity * s);
    const Vec3 arm = initial.position - motion.pivot;
    pose.position = motion.pivot + turn * arm;
    pose.orientation = (turn * initial.orientation).normalized();
  }
  pose.position += motion.velocity * s;
  if (!motion.vibration_amplitude.isZero(0)) pose.position += vibration(motion, t);
  return pose;
}

Twist mean_twist(const Motion& motion, const Pose& initial, double t, double h) {
  assert(h > 0);
  Twist twist;
  twist.linear = (pose_at(motion, initial, t + h).position - pose_at(motion, initial, t).position) / h;
  // The axis does not change, so the turn of one step is the difference of two angles about it.
  twist.angular = motion.angular_velocity * ((elapsed(motion, t + h) - elapsed(motion, t)) / h);
  return twist;
}

void set_clock_to_zero_at(double t, Motion& motion, Pose& initial) {
  assert(t >= 0);
  const double s = elapsed(motion, t);
  initial = pose_at(motion, initial, t);
  motion.pivot += motion.velocity * std::max(0.0, s);
  if (!motion.vibration_amplitude.isZero(0)) motion.pivot += vibration(motion, t);
  motion.vibration_phase += 2 * std::numbers::pi * motion.vibration_frequency * t;
  motion.start = std::max(0.0, motion.start - t);
  motion.stop = std::max(motion.start, motion.stop - t);
}

}  // namespace repose
