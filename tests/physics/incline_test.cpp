/// Blocks and spheres on an inclined plane: where they start to move, and how fast they then go.
#include <algorithm>
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Incline : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Incline);

constexpr double g = 9.81, h = 1e-3;
constexpr int steps = 500;

/// Unit vectors of a plane that falls towards +x by `angle` [rad].
struct Slope {
  double angle;
  Vec3 normal() const { return {std::sin(angle), 0, std::cos(angle)}; }
  Vec3 down() const { return {std::cos(angle), 0, -std::sin(angle)}; }
};

ModelBuilder plane(const Slope& slope, const PairLaw& law) {
  ModelBuilder builder;
  builder.material("body").material("plane").law("body", "plane", law).floor("plane", slope.normal());
  return builder;
}

Model block_on(const Slope& slope, const PairLaw& law) {
  const Vec3 half(0.3, 0.2, 0.1);
  return plane(slope, law)
      .box("body", half, {.position = half.z() * slope.normal(), .orientation = turn(slope.angle, Vec3::UnitY())})
      .build();
}

constexpr double radius = 0.1;

Model sphere_on(const Slope& slope, const PairLaw& law) {
  return plane(slope, law).sphere("body", radius, {.position = radius * slope.normal()}).build();
}

/// Along the plane; off the plane nothing may happen.
double speed_down(const Simulation& s, const Slope& slope) {
  EXPECT_LT(std::abs(s.velocity(1).dot(slope.normal())), 1e-9 * g);
  return s.velocity(1).dot(slope.down());
}

std::string degrees(double angle) { return std::to_string(angle * 180 / M_PI).substr(0, 6) + " deg"; }

TEST_P(Incline, BlockRestsUpToTheFrictionAngle) {
  const double mu = 0.5;
  for (const double share : {0.5, 0.99, 0.9999}) {
    const Slope slope{std::atan(share * mu)};
    auto s = simulation(block_on(slope, {.friction = mu}), precise(h));
    s.run(steps);
    expect_answer({"block at rest, tan = " + std::to_string(share).substr(0, 6) + " mu, speed / (g t)", 0,
                   s.velocity(1).norm() / (g * h * steps), 1e-12, 0, 1},
                  GetParam());
    EXPECT_LT(s.spin(1).norm() * radius, 1e-10);
  }
}

TEST_P(Incline, BlockSlidesBeyondIt) {
  const double mu = 0.5;
  for (const double tangent : {1.001 * mu, 1.2 * mu, 1.0}) {
    const Slope slope{std::atan(tangent)};
    auto s = simulation(block_on(slope, {.friction = mu}), precise(h));
    s.run(steps);
    const double a = g * (std::sin(slope.angle) - mu * std::cos(slope.angle));
    expect_answer(
        {"sliding block, " + degrees(slope.angle) + ", a [m/s^2]", a, speed_down(s, slope) / (h * steps), 1e-9},
        GetParam());
    EXPECT_LT(s.spin(1).norm() * radius, 1e-9 * speed_down(s, slope));
  }
}

TEST_P(Incline, SphereRollsAtFiveSevenths) {
  const double mu = 0.4;
  for (const double angle : {0.1, 0.5, std::atan(3.5 * mu) - 1e-3}) {
    const Slope slope{angle};
    auto s = simulation(sphere_on(slope, {.friction = mu}), precise(h));
    s.run(steps);
    const double v = speed_down(s, slope);
    expect_answer(
        {"rolling sphere, " + degrees(angle) + ", a [m/s^2]", 5.0 / 7 * g * std::sin(angle), v / (h * steps), 1e-10},
        GetParam());
    expect_answer({"rolling sphere, " + degrees(angle) + ", R omega / v", 1, radius * s.spin(1).y() / v, 1e-10},
                  GetParam());
  }
}

TEST_P(Incline, SphereSlipsBeyondSevenHalves) {
  const double mu = 0.4;
  for (const double angle : {std::atan(3.5 * mu) + 1e-3, 1.2}) {
    const Slope slope{angle};
    auto s = simulation(sphere_on(slope, {.friction = mu}), precise(h));
    s.run(steps);
    const double t = h * steps;
    expect_answer({"slipping sphere, " + degrees(angle) + ", a [m/s^2]", g * (std::sin(angle) - mu * std::cos(angle)),
                   speed_down(s, slope) / t, 1e-9},
                  GetParam());
    expect_answer({"slipping sphere, " + degrees(angle) + ", angular a [rad/s^2]",
                   2.5 * mu * g * std::cos(angle) / radius, s.spin(1).y() / t, 1e-9},
                  GetParam());
  }
}

TEST_P(Incline, RollingFrictionHoldsASphereUpToTheSmallerOfMuAndRho) {
  struct Case {
    double mu, rho;
  };
  for (const Case& c : {Case{0.5, 0.1}, Case{0.05, 0.2}}) {
    const PairLaw law{.friction = c.mu, .rolling_friction = c.rho};
    const Model held = sphere_on({std::atan(0.999 * std::min(c.mu, c.rho))}, law);
    REPOSE_SKIP_UNSUPPORTED(held);
    auto s = simulation(held, precise(h));
    s.run(steps);
    const std::string name =
        "mu = " + std::to_string(c.mu).substr(0, 4) + ", rho = " + std::to_string(c.rho).substr(0, 3);
    expect_answer({"sphere held by rolling friction, " + name + ", speed / (g t)", 0,
                   s.velocity(1).norm() / (g * h * steps), 1e-12, 0, 1},
                  GetParam());
  }
}

TEST_P(Incline, SphereBeyondTheRollingAngleRollsAndBeyondTheFrictionAngleSlides) {
  const Slope slope{0.3};
  const double rho = 0.1;
  const Model rolling = sphere_on(slope, {.friction = 0.5, .rolling_friction = rho});
  REPOSE_SKIP_UNSUPPORTED(rolling);
  auto s = simulation(rolling, precise(h));
  s.run(steps);
  expect_answer(
      {"sphere rolling against rho = 0.1, a [m/s^2]",
       5.0 / 7 * g * (std::sin(slope.angle) - rho * std::cos(slope.angle)), speed_down(s, slope) / (h * steps), 1e-10},
      GetParam());
  const double mu = 0.05;
  auto slider = simulation(sphere_on(slope, {.friction = mu, .rolling_friction = 0.2}), precise(h));
  slider.run(steps);
  expect_answer(
      {"sphere sliding without turning, mu = 0.05, rho = 0.2, a [m/s^2]",
       g * (std::sin(slope.angle) - mu * std::cos(slope.angle)), speed_down(slider, slope) / (h * steps), 1e-10},
      GetParam());
  EXPECT_LT(radius * slider.spin(1).norm(), 1e-10);
}

TEST_P(Incline, ASmoothSphereLeavesAFixedOneAtTwoThirds) {
  // It slides down without turning, and leaves where cos = 2/3 of the angle from the top (start: 5 degrees, at rest).
  const double large = 0.3, start = 5 * M_PI / 180, sum = large + radius, fine = 1e-4;
  const Model model = ModelBuilder()
                          .material("m")
                          .wall("m", shape_of("ball", Sphere{large}))
                          .sphere("m", radius, {.position = sum * Vec3(std::sin(start), 0, std::cos(start))})
                          .build();
  auto s = simulation(model, precise(fine));
  double left = 0, spin = 0;
  s.run(20000, [&](const Simulation& now) {
    spin = std::max(spin, now.spin(1).norm());
    if (now.force_on(1).norm() > 0) left = now.position(1).z() / sum;
  });
  expect_answer({"smooth sphere on a fixed one: cosine where it leaves", 2.0 / 3 * std::cos(start), left, 1e-3}, GetParam());
  expect_answer({"smooth sphere on a fixed one: spin / sqrt(g / R)", 0, spin / std::sqrt(g / radius), 1e-12, 0, 1},
                GetParam());
}

}  // namespace
}  // namespace repose::test
