/// A rotating drum, half full: its surface angle grows with the speed.
#include <cmath>
#include <cstdio>
#include <string>

#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Drum : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Drum);

constexpr double d = 0.02, g = 9.81, radius = 8 * d, width = 4 * d;
constexpr int count = 400, first_grain = 3;  // half of the drum

/// Adds grains on a lattice, from the lowest layer up, as many as the drum's length takes side by side.
void fill_drum(ModelBuilder& builder) {
  const Shape ball = make_grain_shape("sphere");
  const double pitch = 1.1 * d, reach = radius - 0.55 * d;
  int placed = 0;
  for (int z = 0; placed < count; ++z)
    for (int x = -8; x <= 8; ++x)
      for (int y = -1; y <= 1 && placed < count; ++y) {
        const Vec3 at(pitch * x, pitch * y, pitch * z - reach);
        if (std::hypot(at.x(), at.z()) > reach) continue;
        // Moved a little, each by its own amount, so that no symmetry holds the lattice up.
        const Vec3 aside = 0.04 * d * Vec3(std::sin(2.0 * placed), std::sin(3.0 * placed), 0);
        builder.body("ball", ball, {.position = at + aside}, d).as_grain();
        ++placed;
      }
}

struct Angle {
  double mean = 0;   ///< [deg]
  double error = 0;  ///< of the mean, from the scatter of the quarters of the time [deg]
};

/// Surface angle at the Froude number omega^2 R / g, after `turn_before` [rad], over the next `turn_during`: the
/// direction in which the centre of all grains lies.
Angle surface_angle(const std::string& backend, double froude, double turn_before, double turn_during) {
  const double omega = std::sqrt(froude * g / radius), h = 1.2e-3, settling = 0.3;
  ModelBuilder builder;
  builder.material("ball", 1000).material("drum").material("glass");
  builder.law("ball", "ball", {.friction = 0.5, .rolling_friction = 0.05, .spinning_friction = 0.05});
  // As if grains were glued to the drum: on a smooth one, on which they roll, the whole fill slips back in surges of 5
  // degrees.
  builder.law("ball", "drum", {.friction = 1, .rolling_friction = 1, .spinning_friction = 1});
  Motion motion;
  motion.angular_velocity = {0, omega, 0};
  motion.start = settling;
  builder.wall("drum", tube(radius, -width, width, d), {Vec3::Zero(), turn(M_PI / 2, Vec3::UnitX())}, motion);
  builder.floor("glass", Vec3::UnitY(), {0, -width / 2, 0}).floor("glass", -Vec3::UnitY(), {0, width / 2, 0});
  fill_drum(builder);
  Simulation s(backend, builder.build(), usual(h, 3e-3));
  s.run(static_cast<int>((settling + turn_before / omega) / h));
  const int steps = static_cast<int>(turn_during / omega / h) / 4;
  double quarter[4] = {};
  for (double& angle : quarter)
    s.run(steps, [&](const Simulation& now) {
      Vec3 centre = Vec3::Zero();
      for (int i = 0; i < count; ++i) centre += now.position(first_grain + i);
      angle += std::atan2(-centre.x(), -centre.z()) * 180 / M_PI / steps;
    });
  Angle result;
  for (const double angle : quarter) result.mean += angle / 4;
  for (const double angle : quarter) result.error += std::pow(angle - result.mean, 2) / (4 * 3);
  result.error = std::sqrt(result.error);
  return result;
}

TEST_P(Drum, SurfaceAngleGrowsWithTheSpeed) {
  const double froude[] = {0.003, 0.1, 0.4}, before[] = {0.8, 2, 4}, during[] = {1.6, 6, 8};
  Angle angle[3];
  for (int k = 0; k < 3; ++k) {
    angle[k] = surface_angle(GetParam(), froude[k], before[k], during[k]);
    char name[64];
    std::snprintf(name, sizeof name, "drum, Froude number %g: surface angle [deg]", froude[k]);
    note(name, angle[k].mean);
    expect_answer({std::string(name) + ", standard error", 0, angle[k].error, 1.5, 0, 1}, GetParam());
  }
  for (int k = 0; k < 2; ++k) {
    const double rise = angle[k + 1].mean - angle[k].mean;
    const double sigmas = rise / std::hypot(angle[k].error, angle[k + 1].error);
    note("drum: rise of the angle to the next speed / its standard error", sigmas);
    EXPECT_GT(rise, 3);
    EXPECT_GT(sigmas, 3);
  }
  // Between the angle of repose of such grains and where they fly.
  EXPECT_GT(angle[0].mean, 25);
  EXPECT_LT(angle[2].mean, 75);
}

}  // namespace
}  // namespace repose::test
