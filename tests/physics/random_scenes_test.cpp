/// Small scenes at random, over shapes, sizes, materials, laws and containers that stand, turn or shake: nothing escapes, nothing
/// gains energy, momentum is accounted for, every number stays finite.
#include <algorithm>
#include <cmath>

#include "analysis/ledger.hpp"
#include "core/grain_shape.hpp"
#include "core/random.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class RandomScenes : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(RandomScenes);

constexpr int scenes = 1000;

/// An open box of inner half width `w` with its floor at z = 0, walls `w` thick, made of one kind of primitive. Half-spaces stand
/// still.
void add_container(ModelBuilder& builder, int kind, double w, const Motion& motion) {
  const double high = 6 * w;
  if (kind == 0) {
    builder.floor("wall");
    for (const Vec3& n : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) builder.floor("wall", n, -w * n);
  } else if (kind == 1) {
    builder.wall("wall", shape_of("cup", Revolved{{{0, -w}, {2 * w, -w}, {2 * w, high}, {w, high}, {w, 0}, {0, 0}}}), {}, motion);
  } else if (kind == 2) {
    builder.wall("wall", shape_of("bottom", Box{{2 * w, 2 * w, w / 2}}), {{0, 0, -w / 2}, Quat::Identity()}, motion);
    for (const double side : {-1.0, 1.0}) {
      builder.wall("wall", shape_of("side", Box{{w / 2, 2 * w, high / 2}}),
                   {{side * 1.5 * w, 0, high / 2}, Quat::Identity()}, motion);
      builder.wall("wall", shape_of("side", Box{{2 * w, w / 2, high / 2}}),
                   {{0, side * 1.5 * w, high / 2}, Quat::Identity()}, motion);
    }
  } else {
    // A bowl of one solid: a hollow inverted cone over a thick bottom.
    builder.wall("wall", shape_of("bowl", Revolved{{{0, -w}, {3 * w, -w}, {3 * w, high}, {2 * w, high}, {0.2 * w, 0},
                                                    {0, 0}}}), {}, motion);
  }
}

struct RandomScene {
  Model model;
  double width = 0, step = 0;
  int container = 0;
};

/// Half of the scenes have rolling and spinning friction, a third cohesion below a grain's weight, whose range holds a thousandth
/// of the energy that a grain has.
void add_resistance(PairLaw& law, int number, double weight, double size, Random& random) {
  if (number % 2 == 1) {
    law.rolling_friction = random.uniform(0, 0.3);
    law.spinning_friction = random.uniform(0, 0.3);
  }
  if (number % 3 == 1) {
    law.cohesion = weight * random.uniform(0, 0.5);
    law.cohesion_range = 1e-3 * size;
  }
}

/// A third of the containers move: those of revolution turn about their axis, boxes shake sideways, with an acceleration below g.
Motion random_motion(int number, double size, Random& random) {
  Motion motion;
  if (number % 3 != 2) return motion;
  const double rate = std::sqrt(9.81 / size);
  if (number % 2 == 1) {
    motion.angular_velocity = {0, 0, rate * random.uniform(-0.5, 0.5)};
  } else {
    motion.vibration_amplitude = {0.05 * size, 0.05 * size, 0};
    motion.vibration_frequency = rate * random.uniform(0.1, 0.5);
    motion.vibration_phase = random.uniform(0, 2 * M_PI);
  }
  return motion;
}

RandomScene random_scene(int number) {
  Random random(1000 + static_cast<std::uint64_t>(number), 0);
  RandomScene scene;
  const double size = std::pow(10, random.uniform(-4.5, 0));  // 30 um to 1 m
  const std::vector<std::string> names = grain_shape_names();
  scene.width = 3 * size;
  scene.container = number % 4;
  scene.step = 0.02 * std::sqrt(size / 9.81) * random.uniform(0.2, 1);
  PairLaw law{.friction = random.uniform(0, 1), .restitution = random.uniform() < 0.5 ? 0.0 : random.uniform(0, 0.9)};
  const double density = random.uniform(500, 5000);
  PairLaw wall{.friction = random.uniform(0, 1), .restitution = law.restitution};
  Random extra(1000 + static_cast<std::uint64_t>(number), 1);
  const double weight = 9.81 * density * std::pow(0.4 * size, 3) * M_PI / 6;  // of the smallest grain
  add_resistance(law, number, weight, size, extra);
  add_resistance(wall, number, weight, size, extra);
  ModelBuilder builder;
  builder.material("grain", density).material("wall").law("grain", "grain", law).law("grain", "wall", wall);
  add_container(builder, scene.container, scene.width, random_motion(number, size, extra));
  const int count = 4 + number % 9;
  for (int i = 0; i < count; ++i) {
    // In layers of four, apart at the start: the largest grain is 1.9 sizes long.
    const double lowest = scene.container == 3 ? 7.5 : 2.1;  // where the bowl is wide enough
    const Vec3 at(size * (i % 2 ? 1.05 : -1.05), size * (i / 2 % 2 ? 1.05 : -1.05), size * (lowest + 2.1 * (i / 4)));
    const Shape shape = make_grain_shape(names[random.below(names.size())]);
    const Start start{.position = at,
                      .velocity = std::sqrt(9.81 * size) *
                                  Vec3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-1, 0)),
                      .orientation = random.rotation()};
    builder.body("grain", shape, start, size * random.uniform(0.4, 1)).as_grain();
  }
  scene.model = builder.build();
  return scene;
}

struct Outcome {
  bool finite = true, escaped = false;
  double overlap = 0;  ///< deepest / width of the container
  long contacts = 0;
  Ledger books;
};

Outcome outcome(const std::string& backend, const RandomScene& scene) {
  const SolverOptions options = usual(scene.step);
  MeteredWorld world(scene.model, find_backend(backend).make(scene.model, options));
  Snapshot state;
  BodyLoads loads;
  Outcome result;
  world.read(state);
  for (int i = 0; i < 400; ++i) {
    evaluate_loads(scene.model, state, loads);
    const StepReport report = world.step(scene.step, loads);
    world.read(state);
    result.overlap = std::max(result.overlap, report.penetration / scene.width);
    result.contacts += report.contacts;
  }
  const double wide = scene.container == 3 ? 3 * scene.width : scene.width;
  for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
    if (!scene.model.bodies[i].dynamic) continue;
    const Vec3& x = state.position[i];
    result.finite = result.finite && x.allFinite() && state.velocity[i].allFinite();
    result.escaped = result.escaped || x.z() < 0 || std::abs(x.x()) > wide || std::abs(x.y()) > wide;
  }
  result.books = world.ledger();
  return result;
}

TEST_P(RandomScenes, NothingEscapesOrGainsEnergyAndMomentumIsAccountedFor) {
  int run = 0, escaped = 0, gained = 0;
  long contacts = 0;
  double deepest = 0, momentum = 0, energy = 0;
  for (int number = 0; number < scenes; ++number) {
    const RandomScene scene = random_scene(number);
    if (!find_backend(GetParam()).unsupported(scene.model).empty()) continue;
    const Outcome o = outcome(GetParam(), scene);
    ASSERT_TRUE(o.finite) << "scene " << number;
    if (o.escaped) std::printf("scene %d: a grain escaped\n", number);
    if (o.books.energy_gain > 1e-2) std::printf("scene %d: energy grew by %.2g\n", number, o.books.energy_gain);
    ++run;
    escaped += o.escaped;
    gained += o.books.energy_gain > 1e-2;
    contacts += o.contacts;
    deepest = std::max(deepest, o.overlap);
    momentum = std::max(momentum, o.books.momentum_error);
    energy = std::max(energy, o.books.energy_gain);
  }
  note("random scenes: run", run);
  note("random scenes: contacts in all steps", static_cast<double>(contacts));
  note("random scenes: deepest overlap / width of the container", deepest);
  note("random scenes: largest gain of energy / energy turned over", energy);
  const auto expect_none = [](const std::string& what, double measured, double tolerance) {
    expect_answer({"random scenes: " + what, 0, measured, tolerance, 0, 1}, GetParam());
  };
  expect_none("share in which a grain escapes", static_cast<double>(escaped) / scenes, 0);
  expect_none("share in which energy grows by 1 %", static_cast<double>(gained) / scenes, 0);
  expect_none("largest momentum that no load or wall gave / impulse of the loads", momentum, 1e-11);
}

}  // namespace
}  // namespace repose::test
