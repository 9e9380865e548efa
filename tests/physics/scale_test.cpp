/// A scene scaled by 2^-14 in length and 2^-7 in time is the same scene: the same bits on DVI.
#include <cmath>

#include "core/random.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Scale : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Scale);

/// Runs the model and the scaled one; the largest difference of positions relative to the size of the first body, and
/// the number of coordinates, velocities and quaternion components that are not the same bits.
void expect_same(const std::string& backend, const std::string& name, const Model& model, double h, int steps,
                 double tolerance = 1e-3) {
  const double length = 0x1p-14, time = 0x1p-7;
  Simulation large(backend, model, usual(h, tolerance)),
      small(backend, froude_scaled(model, length), usual(h * time, tolerance));
  double worst = 0;
  long different = 0;
  int contacts = 0;
  const double size = model.bodies.back().radius;
  for (int i = 0; i < steps; ++i) {
    large.step();
    small.step();
    contacts = std::max(contacts, large.report().contacts);
    different += large.report().iterations != small.report().iterations;
  }
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Snapshot &l = large.state(), &s = small.state();
    worst = std::max(worst, (l.position[b] * length - s.position[b]).norm() / (length * size));
    for (int k = 0; k < 3; ++k) {
      different += l.position[b][k] * length != s.position[b][k];
      different += l.velocity[b][k] * (length / time) != s.velocity[b][k];
      different += l.angular_velocity[b][k] / time != s.angular_velocity[b][k];
    }
    for (int k = 0; k < 4; ++k) different += l.orientation[b].coeffs()[k] != s.orientation[b].coeffs()[k];
  }
  note(name + ": most contacts", contacts);
  EXPECT_GT(contacts, 0) << name;
  expect_answer({name + ": largest difference / R", 0, worst, 0, 0, 1}, backend);
  if (backend == "dvi") {
    EXPECT_EQ(different, 0) << name;
  }
}

const PairLaw everything{.friction = 0.5,
                         .rolling_friction = 0.05,
                         .spinning_friction = 0.05,
                         .rolling_friction_length = 1e-4,
                         .restitution = 0.4,
                         .cohesion = 0.01,
                         .cohesion_range = 1e-4};

TEST_P(Scale, Spheres) {
  const Model model = pile({.count = 60, .kinds = {"sphere"}, .law = {.friction = 0.5}});
  expect_same(GetParam(), "scaled spheres", model, 1e-3, 300);
}

TEST_P(Scale, EveryGrainShapeWithEveryLaw) {
  const Model model = pile({.count = 70, .kinds = grain_shape_names(), .law = everything});
  REPOSE_SKIP_UNSUPPORTED(model);
  expect_same(GetParam(), "scaled grains of seven shapes, cohesion, restitution, rolling, spinning", model, 1e-3, 250);
}

TEST_P(Scale, FluidDrag) {
  Model model = pile({.count = 40, .kinds = {"sphere", "ellipsoid"}, .law = everything});
  model.effects = {LinearDrag{0.02}, QuadraticDrag{0.47, 1.2}, FiniteReynoldsDrag{0.01, 1.2}, Buoyancy{1.2},
                   GravityTilt{2, 3}, Magnus{0.5, 1.2}, PeriodicForce{{1, 0, 2}, 5, 0.3}};
  REPOSE_SKIP_UNSUPPORTED(model);
  expect_same(GetParam(), "scaled grains with drag, buoyancy and tilt", model, 1e-3, 250);
}

TEST_P(Scale, EveryContactEffect) {
  const double weight = 1000 * 4.0 / 3 * M_PI * 1e-6 * 9.81;
  Model model = pile({.count = 40, .kinds = {"sphere", "twin"}, .law = everything});
  model.contact_effects = {RateDependentFriction{0.02, 0.1}, AnisotropicFriction{0.6, 20},
                           RateDependentRestitution{0.25, 0.1}, LiquidBridge{weight, 5e-4},
                           ContactCompliance{1e3 * weight / 0.01, 0.01}};
  REPOSE_SKIP_UNSUPPORTED(model);
  expect_same(GetParam(), "scaled grains with every contact effect", model, 1e-3, 250);
}

TEST_P(Scale, BoxesOnATurningAndShakingPlate) {
  ModelBuilder builder;
  builder.material("m")
      .material("p")
      .law("m", "m", {.friction = 0.5, .restitution = 0.3})
      .law("m", "p", {.friction = 0.4});
  Motion motion;
  motion.angular_velocity = {0, 0, 2};
  motion.velocity = {0.1, 0, 0};
  motion.vibration_amplitude = {0, 0, 1e-3};
  motion.vibration_frequency = 20;
  builder.wall("p", shape_of("plate", Box{{1, 1, 0.05}}), {{0, 0, -0.05}, Quat::Identity()}, motion);
  for (int i = 0; i < 6; ++i)
    builder.box("m", {0.02, 0.03, 0.025},
                {.position = {0.03 * (i % 2), 0.01 * i, 0.04 + 0.08 * i}, .orientation = turn(0.3 * i, {1, 2, 3})});
  expect_same(GetParam(), "scaled boxes on a turning, shaking plate", builder.build(), 1e-3, 400);
}

TEST_P(Scale, ATightTolerance) {
  const Model model = pile({.count = 30, .kinds = {"sphere", "twin"}, .law = everything});
  REPOSE_SKIP_UNSUPPORTED(model);
  expect_same(GetParam(), "scaled grains, tolerance 1e-8", model, 1e-3, 100, 1e-8);
}

}  // namespace
}  // namespace repose::test
