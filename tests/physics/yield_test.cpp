/// Tools that give way upward (Yield of core/motion.hpp): what presses them down is what they press with.
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/same_state.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Yields : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Yields);

constexpr double g = 9.81, radius = 0.01, thickness = 0.01;

/// Body 0: a plate whose lower face stands at `height`; body 1: the floor; body 2: a sphere.
Model plate_over_sphere(double height, const Yield& yield, const Start& sphere, double gravity = g, double friction = 0.5) {
  Motion motion;
  motion.pivot = {0, 0, height + thickness};
  Model model = ModelBuilder()
                    .material("m")
                    .law("m", "m", {.friction = friction})
                    .gravity({0, 0, -gravity})
                    .wall("m", shape_of("plate", Box{{0.5, 0.5, thickness}}), {{0, 0, height + thickness}, Quat::Identity()}, motion)
                    .floor("m")
                    .sphere("m", radius, sphere)
                    .build();
  model.bodies[0].yield = yield;
  return model;
}

TEST_P(Yields, APlateLoweredOntoASphereStandsOnItWithItsLoad) {
  // Its stops sink below the top of the sphere at 5 mm/s; it stays on the sphere.
  Model model = plate_over_sphere(2.2 * radius, {.load = 3, .mass = 0.2}, {.position = {0, 0, radius}});
  model.bodies[0].motion.velocity = {0, 0, -0.005};
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, precise(1e-3));
  s.run(1000);
  expect_answer({"plate held down by a load, on a sphere: height / R", 2, (s.position(0).z() - thickness) / radius, 1e-9}, GetParam());
  expect_answer({"that plate: force on it / load", 1, s.force_on(0).z() / 3, 1e-9}, GetParam());
  expect_answer({"the sphere: force on the floor / (load + weight)", 1, -s.force_on(1).z() / (3 + model.bodies[2].mass * g), 1e-9},
                GetParam());
}

TEST_P(Yields, ABlowLiftsThePlateAgainstItsLoad) {
  // The sphere hits at v, both go on at w = m v / (m + M), and come back after rising by w^2 (m + M) / (2 load).
  const double height = 3 * radius, v = 0.4, load = 0.05, mass = 0.02;
  const Model model = plate_over_sphere(height, {load, mass}, {.position = {0, 0, height - radius}, .velocity = {0, 0, v}}, 0);
  REPOSE_SKIP_UNSUPPORTED(model);
  const double m = model.bodies[2].mass, w = m * v / (m + mass), rise = w * w * (m + mass) / (2 * load);
  double error[2] = {0, 0};
  for (const int i : {0, 1}) {
    const double h = i == 0 ? 1e-4 : 5e-5;
    auto s = simulation(model, precise(h));
    double highest = 0, first = 0;
    s.run(static_cast<int>(std::lround(3 * w * (m + mass) / load / h)), [&](const Simulation& now) {
      highest = std::max(highest, now.position(0).z() - thickness - height);
      if (first == 0) first = now.velocity(0).z();
    });
    expect_answer({"plate hit from below, h = " + std::to_string(h).substr(0, 7) + ": speed / (w - h load / (m + M))", 1,
                   first / (w - h * load / (m + mass)), 1e-9}, GetParam());
    expect_answer({"that plate, highest rise / (w^2 (m + M) / (2 load))", 1, highest / rise, 0.02}, GetParam());
    expect_answer({"that plate, back on its stops / R", 0, (s.position(0).z() - thickness - height) / radius, 1e-12, 0, 1}, GetParam());
    error[i] = std::abs(highest / rise - 1);
  }
  EXPECT_LE(error[1], 0.55 * error[0]);
}

TEST_P(Yields, APlateThatTravelsKeepsToItsPathAndDragsWithMuTimesItsLoad) {
  const double mu = 0.2, load = 2, speed = 0.3;
  Model model = plate_over_sphere(2.2 * radius, {load, 0.1}, {.position = {0, 0, radius}}, g, mu);
  model.bodies[0].motion.velocity = {speed, 0, -0.01};
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, precise(5e-4));
  double drag = 0, press = 0;
  int steps = 0;
  s.run(1400, [&](const Simulation& now) {
    if (now.state().time < 0.4) return;
    drag += std::hypot(now.force_on(0).x(), now.force_on(0).y());
    press += now.force_on(0).z();
    ++steps;
  });
  expect_answer({"travelling plate on a sphere: x from its path / R", 0, (s.position(0).x() - speed * 0.7) / radius, 1e-12, 0, 1}, GetParam());
  expect_answer({"travelling plate: y / R", 0, s.position(0).y() / radius, 1e-12, 0, 1}, GetParam());
  expect_answer({"travelling plate: force upward / load", 1, press / steps / load, 1e-6}, GetParam());
  EXPECT_LE(drag / steps, mu * load * (1 + 1e-9));
}

Pile loose_pile() { return {.count = 120, .law = {.friction = 0.5, .rolling_friction = 0.05}, .across = 4}; }

constexpr double sinking = 0.2, sinks_for = 0.9;

/// The pile under a plate, the last body, that sinks into it.
Model pressed_pile(const Yield& yield) {
  Model model = pile(loose_pile());
  double top = 0;
  for (Body& body : model.bodies) body.role = BodyRole::body;  // grains must be the last bodies
  for (const Vec3& place : model.initial.position) top = std::max(top, place.z());
  Body plate = plate_over_sphere(0, yield, {}).bodies[0];
  plate.shape = static_cast<int>(model.shapes.size());
  plate.motion = {.velocity = {0, 0, -sinking}, .stop = sinks_for};
  model.shapes.push_back(shape_of("plate", Box{{0.5, 0.5, thickness}}));
  model.bodies.push_back(plate);
  model.initial.position.push_back({0, 0, top + 0.04 + thickness});
  model.initial.orientation.push_back(Quat::Identity());
  model.initial.velocity.push_back(Vec3::Zero());
  model.initial.angular_velocity.push_back(Vec3::Zero());
  return model;
}

TEST_P(Yields, AHeapIsPressedWithTheLoadAndNoMore) {
  const Model model = pressed_pile({.load = 8, .mass = 0.5});
  REPOSE_SKIP_UNSUPPORTED(model);
  const int plate = static_cast<int>(model.bodies.size()) - 1;
  auto s = simulation(model, usual(1e-3, 1e-6));
  s.run(1000);
  double push = 0;
  const int steps = 200;
  s.run(steps, [&](const Simulation& now) { push += now.force_on(plate).z() / steps; });
  const double stops = model.initial.position.back().z() - sinking * sinks_for;
  expect_that("plate on a heap: it stands on the grains, above its stops", s.position(plate).z() > stops + 0.01, GetParam());
  expect_answer({"plate on a heap: force on it / load", 1, push / 8, 1e-3}, GetParam());
}

TEST_P(Yields, ALoadThatIsNeverLiftedChangesNothing) {
  Model rigid = plate_over_sphere(3 * radius, {1e3, 1}, {.position = {0, 0, radius}, .velocity = {0.1, 0, 1}});
  REPOSE_SKIP_UNSUPPORTED(rigid);
  auto held = simulation(rigid, precise(1e-3));
  rigid.bodies[0].yield.reset();
  auto fixed = simulation(rigid, precise(1e-3));
  held.run(200);
  fixed.run(200);
  expect_that("a load that is never lifted: the same bytes as without", same_state(held.state(), fixed.state()), GetParam());
}

TEST_P(Yields, SavedWhileRisenItGoesOnAsItWouldHave) {
  const Model model = pressed_pile({.load = 8, .mass = 0.5});
  REPOSE_SKIP_UNSUPPORTED(model);
  auto through = simulation(model, usual(1e-3));
  through.run(500);
  Frame frame;
  through.world().save(frame);
  auto after = simulation(model, usual(1e-3));
  after.world().restore(frame);
  through.run(100);
  after.run(100);
  expect_that("a tool that yields, saved and restored: the same bytes after 100 more steps", same_state(through.state(), after.state()),
              GetParam());
}

}  // namespace
}  // namespace repose::test
