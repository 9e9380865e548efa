/// What every world promises apart from its contacts: tools that move and gates that appear, saving and restoring, errors,
/// and that two worlds of one process do not influence each other.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/grain_shape.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/same_state.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Worlds : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Worlds);

constexpr double g = 9.81;

/// Grains of all shapes that fall into a heap, with the laws that the backend can do.
Model falling_heap(const std::string& backend, int count) {
  const PairLaw friction{.friction = 0.5, .restitution = 0.3};
  PairLaw everything = friction;
  everything.rolling_friction = everything.spinning_friction = 0.05;
  everything.cohesion = 0.01;
  everything.cohesion_range = 1e-4;
  Pile heap{.count = count, .kinds = grain_shape_names(), .law = everything};
  const Model model = pile(heap);
  if (find_backend(backend).unsupported(model).empty()) return model;
  heap.law = friction;
  return pile(heap);
}

TEST_P(Worlds, APlateThatStartsToMoveDragsABlockAlong) {
  const double mu = 0.3, speed = 0.5, h = 1e-3;
  Motion motion;
  motion.velocity = {speed, 0, 0};
  const Model model =
      ModelBuilder()
          .material("m")
          .law("m", "m", {.friction = mu})
          .wall("m", shape_of("plate", Box{{2, 1, 0.05}}), {{0, 0, -0.05}, Quat::Identity()}, motion)
          .box("m", {0.05, 0.05, 0.02}, {.position = {0, 0, 0.02}})
          .build();
  auto s = simulation(model, precise(h));
  s.run(100);
  expect_answer({"block on a plate that starts to move, speed after 0.1 s [m/s]", mu * g * 0.1, s.velocity(1).x(), 1e-9},
                GetParam());
  s.run(200);
  expect_answer({"that block, speed of the plate in the end [m/s]", speed, s.velocity(1).x(), 1e-9}, GetParam());
}

TEST_P(Worlds, ABlockRidesOnAShakingPlate) {
  const double h = 1e-3, amplitude = 2e-3, frequency = 5;  // (2 pi f)^2 A = 0.2 g: it never leaves the plate
  Motion motion;
  motion.vibration_amplitude = {0, 0, amplitude};
  motion.vibration_frequency = frequency;
  const Model model =
      ModelBuilder()
          .material("m")
          .law("m", "m", {.friction = 0.5})
          .wall("m", shape_of("plate", Box{{1, 1, 0.05}}), {{0, 0, -0.05}, Quat::Identity()}, motion)
          .box("m", {0.05, 0.05, 0.02}, {.position = {0, 0, 0.02}})
          .build();
  auto s = simulation(model, precise(h));
  double worst = 0;
  s.run(500, [&](const Simulation& now) {
    const double plate = amplitude * std::sin(2 * M_PI * frequency * now.state().time);
    worst = std::max(worst, std::abs(now.position(1).z() - 0.02 - plate));
  });
  expect_answer({"block on a shaking plate, largest distance from it / amplitude", 0, worst / amplitude, 1e-6, 0, 1},
                GetParam());
}

TEST_P(Worlds, AGateThatAppearsExpelsNothing) {
  // Two spheres: one in the gate's way, one above it. The gate is there from 0.05 s to 0.1 s.
  const double radius = 0.02, h = 1e-3;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = 0.5})
                          .gravity(Vec3::Zero())
                          .wall("m", shape_of("gate", Box{{0.1, 0.1, 0.01}}))
                          .active({{0.05, 0.1}}, 1e-3)
                          .sphere("m", radius, {.position = {0.05, 0, 0.005}})
                          .sphere("m", radius, {.position = {-0.05, 0, 0.06}, .velocity = {0, 0, -1}})
                          .build();
  auto s = simulation(model, precise(h));
  s.run(45);
  EXPECT_LT(s.position(2).z(), 0.02) << "it passed before the gate was there";
  auto later = simulation(model, precise(h));
  double fastest = 0;
  later.run(200, [&](const Simulation& now) { fastest = std::max(fastest, now.velocity(1).norm()); });
  EXPECT_EQ(fastest, 0) << "the gate pushed what stood in its way";
  EXPECT_EQ(later.position(1), Vec3(0.05, 0, 0.005));
  // The second starts so that it arrives while the gate is there.
  Model late = model;
  late.initial.position[2].z() = 0.06 + 0.05;
  auto stopped = simulation(late, precise(h));
  stopped.run(95);
  expect_answer({"sphere stopped by a gate, height [m]", 0.01 + radius, stopped.position(2).z(), 1e-9}, GetParam());
}

TEST_P(Worlds, SavedAndRestoredItGoesOnBitForBit) {
  const Model model = falling_heap(GetParam(), 60);
  auto through = simulation(model, usual(1e-3)), before = simulation(model, usual(1e-3)),
       after = simulation(model, usual(1e-3));
  through.run(160);
  before.run(90);
  Frame frame;
  before.world().save(frame);
  after.restore(frame);
  after.run(70);
  expect_that("saved and restored: the same bytes after 70 more steps", same_state(through.state(), after.state()),
              GetParam());
  double apart = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    apart = std::max(apart, (through.state().position[i] - after.state().position[i]).norm());
  expect_answer({"saved and restored: largest distance from the run that went through / d", 0, apart / 0.02, 0, 0, 1},
                GetParam());
}

TEST_P(Worlds, AFrameThatDoesNotFitIsRefused) {
  Frame frame;
  simulation(falling_heap(GetParam(), 8), usual(1e-3)).world().save(frame);
  EXPECT_THROW(simulation(falling_heap(GetParam(), 9), usual(1e-3)).world().restore(frame), Error);
  EXPECT_THROW(simulation(falling_heap(GetParam(), 8), usual(1e-3)).world().restore(Frame{}), Error);
}

TEST_P(Worlds, ALoadThatIsNotANumberIsAnErrorOfTheSimulation) {
  const Model model = falling_heap(GetParam(), 8);
  auto s = simulation(model, usual(1e-3));
  BodyLoads loads;
  evaluate_loads(model, s.state(), loads);
  loads.force.back() = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  try {
    for (int i = 0; i < 3; ++i) s.world().step(1e-3, loads);
    FAIL() << "it went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::simulation);
  }
}

TEST_P(Worlds, TwoInOneProcessDoNotInfluenceEachOther) {
  const Model model = falling_heap(GetParam(), 40);
  const Snapshot alone = simulation(model, usual(1e-3)).run(120).state();
  for (const std::string& other : backend_names()) {
    auto first = simulation(model, usual(1e-3));
    Simulation second(other, falling_heap(other, 20), usual(2e-3));
    for (int i = 0; i < 120; ++i) {
      first.step();
      second.step();
    }
    EXPECT_TRUE(same_state(alone, first.state())) << "beside a world of " << other;
  }
}

}  // namespace
}  // namespace repose::test
