/// A slowly rotating drum, half full: its surface angle grows with the speed.
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Drum : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Drum);

constexpr double d = 0.02, g = 9.81, radius = 8 * d, width = 4 * d;
constexpr int count = 360, first_grain = 3;

/// Mean surface angle [deg] at the Froude number omega^2 R / g, after `turn_before` [rad], over the next `turn_during`.
double surface_angle(const std::string& backend, double froude, double turn_before, double turn_during) {
  const double omega = std::sqrt(froude * g / radius), h = 1.2e-3, settling = 0.3;
  ModelBuilder builder;
  builder.material("ball", 1000).material("drum").material("glass");
  builder.law("ball", "ball", {.friction = 0.5, .rolling_friction = 0.05, .spinning_friction = 0.05});
  builder.law("ball", "drum", {.friction = 0.8, .rolling_friction = 0.05, .spinning_friction = 0.05});
  Motion motion;
  motion.angular_velocity = {0, omega, 0};
  motion.start = settling;
  builder.wall("drum", tube(radius, -width, width, d), {Vec3::Zero(), turn(M_PI / 2, Vec3::UnitX())}, motion);
  builder.floor("glass", Vec3::UnitY(), {0, -width / 2, 0}).floor("glass", -Vec3::UnitY(), {0, width / 2, 0});
  // Grains start along the whole width of the drum and beyond it is glass: a box that fits into the cylinder.
  FillRegion region;
  region.lower = {-0.72 * radius, -width / 2, -0.68 * radius};
  region.upper = {0.72 * radius, width / 2, 0.68 * radius};
  region.grow = false;
  rain(builder, "ball", region, count, d, 3);
  Simulation s(backend, builder.build(), usual(h, 3e-3));
  s.run(static_cast<int>((settling + turn_before / omega) / h));
  const int steps = static_cast<int>(turn_during / omega / h);
  double sum = 0;
  s.run(steps, [&](const Simulation& now) {
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < count; ++i) centre += now.position(first_grain + i);
    sum += std::atan2(-centre.x(), -centre.z()) * 180 / M_PI;
  });
  return sum / steps;
}

TEST_P(Drum, SurfaceAngleGrowsWithTheSpeed) {
  const double slow = surface_angle(GetParam(), 0.003, 0.8, 0.8);
  const double middle = surface_angle(GetParam(), 0.05, 2, 3);
  const double fast = surface_angle(GetParam(), 0.25, 4, 6);
  note("drum, Froude number 0.003: surface angle [deg]", slow);
  note("drum, Froude number 0.05: surface angle [deg]", middle);
  note("drum, Froude number 0.25: surface angle [deg]", fast);
  EXPECT_GT(slow, 15);
  EXPECT_GT(middle, slow + 2);
  EXPECT_GT(fast, middle + 2);
  EXPECT_LT(fast, 75);
}

}  // namespace
}  // namespace repose::test
