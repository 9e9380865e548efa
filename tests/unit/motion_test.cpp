#include "core/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace repose {
namespace {

constexpr double pi = std::numbers::pi;

double angle_between(const Quat& a, const Quat& b) { return a.angularDistance(b); }

Motion tumbling() {
  Motion motion;
  motion.velocity = {0.3, -0.2, 0.1};
  motion.angular_velocity = {1, -2, 3};
  motion.pivot = {0.4, 0.5, -0.6};
  motion.start = 0.25;
  motion.stop = 1.75;
  motion.vibration_amplitude = {0.01, 0, 0.02};
  motion.vibration_frequency = 7;
  motion.vibration_phase = 0.4;
  return motion;
}

TEST(Motion, NoneLeavesTheBodyWhereItIsToTheLastBit) {
  const Pose start{{0.1, 0.2, 0.3}, rotation_of({0.3, 0.2, 0.1})};
  const Pose later = pose_at({}, start, 17.3);
  EXPECT_EQ(later.position, start.position);
  EXPECT_EQ(later.orientation.coeffs(), start.orientation.coeffs());
  const Twist twist = mean_twist({}, start, 0.1, 1e-3);
  EXPECT_EQ(twist.linear, Vec3::Zero());
  EXPECT_EQ(twist.angular, Vec3::Zero());
}

TEST(Motion, TranslatesBetweenStartAndStopOnly) {
  Motion motion;
  motion.velocity = {0.127, 0, 0};
  motion.start = 1;
  motion.stop = 3;
  EXPECT_EQ(pose_at(motion, {}, 0.5).position.x(), 0);
  EXPECT_DOUBLE_EQ(pose_at(motion, {}, 2).position.x(), 0.127);
  EXPECT_DOUBLE_EQ(pose_at(motion, {}, 10).position.x(), 0.254);
}

TEST(Motion, TurnsAboutAPivot) {
  Motion motion;
  motion.angular_velocity = {0, 0, pi / 2};
  motion.pivot = {1, 0, 0};
  const Pose pose = pose_at(motion, {{2, 0, 5}, Quat::Identity()}, 1);
  EXPECT_TRUE(pose.position.isApprox(Vec3(1, 1, 5), 1e-15));
  EXPECT_NEAR(angle_between(pose.orientation, rotation_of({0, 0, pi / 2})), 0, 1e-7);
}

TEST(Motion, ThePivotTravelsWithTheBody) {
  Motion motion;
  motion.angular_velocity = {0, 2, 0};
  motion.velocity = {0.5, 0, 0};
  const double radius = 0.25;  // rolls without slip on a ceiling or a floor: the rim's point at the bottom stands still
  const Pose centre = pose_at(motion, {}, 1.5);
  EXPECT_DOUBLE_EQ(centre.position.x(), 0.75);
  const double h = 1e-6;
  const auto rim = [&](double t) {
    return pose_at(motion, {}, t).to_world(centre.to_local(centre.position - radius * Vec3::UnitZ()));
  };
  EXPECT_NEAR(((rim(1.5 + h) - rim(1.5 - h)) / (2 * h)).norm(), 0, 1e-9);
}

TEST(Motion, VibratesAroundWhereItStarted) {
  Motion motion;
  motion.vibration_amplitude = {0, 0, 0.003};
  motion.vibration_frequency = 50;
  motion.vibration_phase = 0.7;
  EXPECT_EQ(pose_at(motion, {}, 0).position, Vec3::Zero());
  const double t = 0.0123;
  const double expected = 0.003 * (std::sin(2 * pi * 50 * t + 0.7) - std::sin(0.7));
  EXPECT_NEAR(pose_at(motion, {}, t).position.z(), expected, 1e-17);
}

TEST(Motion, MeanTwistLandsOnThePrescribedPose) {
  const Motion motion = tumbling();
  const Pose start{{1, 2, 3}, rotation_of({0.5, -1, 0.2})};
  // Across the start, in the middle, across the stop, and after it.
  for (const double t : {0.0, 0.2, 0.24, 0.7, 1.74, 2.5}) {
    for (const double h : {1e-6, 1e-3, 0.1, 1.0}) {
      const Pose now = pose_at(motion, start, t), then = pose_at(motion, start, t + h);
      const Twist twist = mean_twist(motion, start, t, h);
      EXPECT_LT((now.position + h * twist.linear - then.position).norm(), 1e-15);
      const Quat landed = rotation_of(h * twist.angular) * now.orientation;
      EXPECT_LT((landed.toRotationMatrix() - then.orientation.toRotationMatrix()).norm(), 2e-15) << t << " " << h;
    }
  }
}

TEST(Motion, FroudeSimilarMotionGivesTheSameBits) {
  const double length = std::ldexp(1.0, -14), time = std::ldexp(1.0, -7);
  const Motion big = tumbling();
  Motion small = big;
  small.velocity *= time;
  small.angular_velocity /= time;
  small.pivot *= length;
  small.start *= time;
  small.stop *= time;
  small.vibration_amplitude *= length;
  small.vibration_frequency /= time;
  const Pose start{{1, 2, 3}, rotation_of({0.5, -1, 0.2})};
  const Pose small_start{length * start.position, start.orientation};
  for (const double t : {0.0, 0.3, 1.1, 2.2}) {
    const Pose a = pose_at(big, start, t), b = pose_at(small, small_start, t * time);
    EXPECT_EQ(length * a.position, b.position);
    EXPECT_EQ(a.orientation.coeffs(), b.orientation.coeffs());
    const Twist u = mean_twist(big, start, t, 0.01), v = mean_twist(small, small_start, t * time, 0.01 * time);
    EXPECT_EQ(time * u.linear, v.linear);
    EXPECT_EQ(u.angular / time, v.angular);
  }
}

// Before it starts, while it moves, and after it has stopped.
TEST(Motion, GoesOnWithAClockThatWasSetToZero) {
  const Pose start{{0.1, 0.2, 0.3}, rotation_of({0.3, 0.2, 0.1})};
  for (const double t : {0.0, 0.1, 0.8, 2.5}) {
    Motion motion = tumbling();
    Pose initial = start;
    set_clock_to_zero_at(t, motion, initial);
    EXPECT_TRUE(pose_at(motion, initial, 0).position.isApprox(initial.position, 1e-14)) << t;
    for (const double s : {0.0, 0.05, 0.4, 1.2, 3.0}) {
      const Pose expected = pose_at(tumbling(), start, t + s), found = pose_at(motion, initial, s);
      EXPECT_TRUE(found.position.isApprox(expected.position, 1e-13)) << t << " " << s;
      EXPECT_NEAR(angle_between(found.orientation, expected.orientation), 0, 1e-7) << t << " " << s;
    }
  }
}

}  // namespace
}  // namespace repose
