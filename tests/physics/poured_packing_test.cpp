/// Equal spheres poured into a box: how densely they lie, and how many contacts carry them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "analysis/packing.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/energy.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Packing : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Packing);

constexpr double d = 0.02, g = 9.81;
constexpr int walls = 5, count = 1150;
constexpr double side = 10.7 * d;  // not a multiple of the diameter: layers at the walls do not fit

struct Packed {
  double fraction = 0, contacts = 0, energy = 0, rattlers = 0;
  double depth = 0;  ///< deepest overlap while it was poured / d
};

Packed pour(const std::string& backend, double friction, unsigned seed) {
  ModelBuilder builder;
  builder.material("ball", 1000).material("wall");
  builder.law("ball", "ball", {.friction = friction}).law("ball", "wall", {.friction = friction});
  builder.floor("wall");
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    builder.floor("wall", normal, -side / 2 * normal);
  FillRegion region;
  region.lower = {-side / 2, -side / 2, 0};
  region.upper = {side / 2, side / 2, 20 * d};
  rain(builder, "ball", region, count, d, seed);
  const Model model = builder.build();
  const double weight = model.bodies.back().mass * g;

  // Without friction a bed creeps in bursts for seconds, and at a coarser tolerance it never stops trembling; moving
  // balls press on fewer others, so they are counted in a quiet moment.
  const double h = 2e-3, quiet = 1e-5;
  const auto energy = [&](const Simulation& s) { return kinetic_energy(s) / (count * weight * d); };
  Simulation s(backend, model, usual(h, 1e-4));
  Packed packed;
  s.run(500, [&](const Simulation& now) { packed.depth = std::max(packed.depth, now.report().penetration / d); });
  for (int i = 0; i < 100 && energy(s) > quiet; ++i) s.run(20);
  // Which contacts carry is told apart with a tighter solve.
  Frame frame;
  s.world().save(frame);
  Simulation fine(backend, model, usual(h, 1e-6));
  fine.restore(frame);
  fine.run(10);
  packed.energy = energy(fine);

  double top = 0;  // of the bed: twice the mean height of a ball
  std::vector<int> balls(count), carrying(walls + count, 0);
  for (int i = 0; i < count; ++i) {
    balls[static_cast<std::size_t>(i)] = walls + i;
    top += 2 * fine.position(walls + i).z() / count;
  }
  for (const Contact& c : fine.contacts()) {
    if (c.force.norm() < 1e-3 * weight) continue;
    ++carrying[static_cast<std::size_t>(c.a)];
    ++carrying[static_cast<std::size_t>(c.b)];
  }
  // Balls stand in layers at walls; two diameters away from them little of that is left.
  packed.fraction =
      solid_fraction_in_cylinder(model, fine.state(), balls, {0, 0, 2 * d}, side / 2 - 2 * d, top - 4 * d).value;
  int inner = 0, loose = 0;
  for (const int i : balls) {
    const Vec3& x = fine.position(i);
    if (std::max(std::abs(x.x()), std::abs(x.y())) > side / 2 - 1.5 * d) continue;
    if (x.z() < 1.5 * d || x.z() > top - 1.5 * d) continue;
    const int n = carrying[static_cast<std::size_t>(i)];
    n < 3 ? ++loose : ++inner;
    packed.contacts += n < 3 ? 0 : n;
  }
  packed.contacts /= inner;
  packed.rattlers = static_cast<double>(loose) / (inner + loose);
  return packed;
}

void expect_within(const std::string& what, double low, double high, double measured) {
  char range[64];
  std::snprintf(range, sizeof range, " (wanted %.3g to %.3g)", low, high);
  note(what + range, measured);
  EXPECT_GE(measured, low) << what;
  EXPECT_LE(measured, high) << what;
}

TEST_P(Packing, FrictionlessSpheres) {
  const Packed packed = pour(GetParam(), 0, 7);
  // 0.63 to 0.64, and what the region adds, some 170 balls: four fillings gave 0.641 +- 0.003 (standard deviation).
  expect_within("frictionless spheres: volume fraction", 0.62, 0.65, packed.fraction);
  // As many contact forces as degrees of freedom, each shared by two: 6. Four fillings gave 5.92 to 5.99.
  expect_within("frictionless spheres: contacts per grain that is held", 5.8, 6.2, packed.contacts);
  note("frictionless spheres: share of rattlers", packed.rattlers);
  expect_answer({"frictionless spheres: deepest overlap while poured / d", 0, packed.depth, 1e-3, 0, 1}, GetParam());
  note("frictionless spheres: kinetic energy / m g d per grain", packed.energy);
  EXPECT_LT(packed.energy, 5e-5);
}

TEST_P(Packing, FrictionalSpheres) {
  const Packed packed = pour(GetParam(), 0.5, 7);
  expect_within("spheres, mu = 0.5: volume fraction", 0.55, 0.60, packed.fraction);
  // Fewer than without friction, and at least the 4 that hold a rough sphere.
  expect_within("spheres, mu = 0.5: contacts per grain that is held", 4.0, 5.6, packed.contacts);
  note("spheres, mu = 0.5: share of rattlers", packed.rattlers);
  expect_answer({"spheres, mu = 0.5: deepest overlap while poured / d", 0, packed.depth, 1e-3, 0, 1}, GetParam());
  note("spheres, mu = 0.5: kinetic energy / m g d per grain", packed.energy);
  EXPECT_LT(packed.energy, 5e-5);
}

}  // namespace
}  // namespace repose::test
