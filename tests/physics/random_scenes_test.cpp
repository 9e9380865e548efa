/// Small scenes at random, over shapes, sizes, materials, laws and containers: nothing escapes, nothing gains energy, every
/// number stays finite.
#include <algorithm>
#include <cmath>

#include "core/grain_shape.hpp"
#include "core/random.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/energy.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class RandomScenes : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(RandomScenes);

constexpr int scenes = 1000;

/// An open box of inner half width `w` with its floor at z = 0, walls `w` thick, made of one kind of primitive.
void add_container(ModelBuilder& builder, int kind, double w) {
  const double high = 6 * w;
  if (kind == 0) {
    builder.floor("wall");
    for (const Vec3& n : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) builder.floor("wall", n, -w * n);
  } else if (kind == 1) {
    builder.wall("wall", shape_of("cup", Revolved{{{0, -w}, {2 * w, -w}, {2 * w, high}, {w, high}, {w, 0}, {0, 0}}}));
  } else if (kind == 2) {
    builder.wall("wall", shape_of("bottom", Box{{2 * w, 2 * w, w / 2}}), {{0, 0, -w / 2}, Quat::Identity()});
    for (const double side : {-1.0, 1.0}) {
      builder.wall("wall", shape_of("side", Box{{w / 2, 2 * w, high / 2}}),
                   {{side * 1.5 * w, 0, high / 2}, Quat::Identity()});
      builder.wall("wall", shape_of("side", Box{{2 * w, w / 2, high / 2}}),
                   {{0, side * 1.5 * w, high / 2}, Quat::Identity()});
    }
  } else {
    // A bowl of one solid: a hollow inverted cone over a thick bottom.
    builder.wall("wall", shape_of("bowl", Revolved{{{0, -w}, {3 * w, -w}, {3 * w, high}, {2 * w, high}, {0.2 * w, 0},
                                                    {0, 0}}}));
  }
}

struct RandomScene {
  Model model;
  double width = 0, step = 0;
  int container = 0;
};

RandomScene random_scene(int number) {
  Random random(1000 + static_cast<std::uint64_t>(number), 0);
  RandomScene scene;
  const double size = std::pow(10, random.uniform(-4.5, 0));  // 30 um to 1 m
  const std::vector<std::string> names = grain_shape_names();
  scene.width = 3 * size;
  scene.container = number % 4;
  scene.step = 0.02 * std::sqrt(size / 9.81) * random.uniform(0.2, 1);
  const PairLaw law{.friction = random.uniform(0, 1), .restitution = random.uniform() < 0.5 ? 0.0 : random.uniform(0, 0.9)};
  ModelBuilder builder;
  builder.material("grain", random.uniform(500, 5000)).material("wall").law("grain", "grain", law);
  builder.law("grain", "wall", {.friction = random.uniform(0, 1), .restitution = law.restitution});
  add_container(builder, scene.container, scene.width);
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

double energy(const Simulation& s) {
  double sum = kinetic_energy(s);
  for (std::size_t i = 0; i < s.model().bodies.size(); ++i)
    if (s.model().bodies[i].dynamic) sum += 9.81 * s.model().bodies[i].mass * s.state().position[i].z();
  return sum;
}

TEST_P(RandomScenes, NothingEscapesOrGainsEnergy) {
  int escaped = 0, gained = 0, contacts = 0;
  double deepest = 0;
  for (int number = 0; number < scenes; ++number) {
    const RandomScene scene = random_scene(number);
    if (!find_backend(GetParam()).unsupported(scene.model).empty()) continue;
    auto s = simulation(scene.model, usual(scene.step));
    const double first = energy(s);
    double most = first, depth = 0;
    s.run(400, [&](const Simulation& now) {
      most = std::max(most, energy(now));
      depth = std::max(depth, now.report().penetration / scene.width);
      contacts += now.report().contacts;
    });
    deepest = std::max(deepest, depth);
    bool out = false;
    for (std::size_t i = 0; i < scene.model.bodies.size(); ++i) {
      if (!scene.model.bodies[i].dynamic) continue;
      const Vec3& x = s.state().position[i];
      ASSERT_TRUE(x.allFinite()) << "scene " << number;
      const double wide = scene.container == 3 ? 3 * scene.width : scene.width;
      out = out || x.z() < 0 || std::abs(x.x()) > wide || std::abs(x.y()) > wide;
    }
    if (out) std::printf("scene %d: a grain escaped\n", number);
    if (most > first * (1 + 1e-2)) std::printf("scene %d: energy grew by %.2g\n", number, most / first - 1);
    escaped += out;
    gained += most > first * (1 + 1e-2);
  }
  note("random scenes: contacts in all steps", contacts);
  note("random scenes: deepest overlap / width of the container", deepest);
  expect_answer({"random scenes: share in which a grain escapes", 0, static_cast<double>(escaped) / scenes, 0, 0, 1},
                GetParam());
  expect_answer({"random scenes: share in which energy grows by 1 %", 0, static_cast<double>(gained) / scenes, 0, 0, 1},
                GetParam());
}

}  // namespace
}  // namespace repose::test
