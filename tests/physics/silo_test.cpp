/// A narrow silo: its walls carry what is above a few diameters, and the load of its base saturates (Janssen 1895).
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Silo : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Silo);

constexpr double d = 0.02, g = 9.81, radius = 2.75 * d;
constexpr int base = 0, first_grain = 2;

/// Load of the base / weight of all grains, while the base sinks slowly so that friction holds the grains everywhere.
double base_load(const std::string& backend, int count, double wall_friction) {
  const double h = 1e-3, settled = 1.2;
  ModelBuilder builder;
  builder.material("ball", 1000).material("wall").material("base");
  builder.law("ball", "ball", {.friction = 0.5})
      .law("ball", "wall", {.friction = wall_friction})
      .law("ball", "base", {.friction = 0.5});
  Motion sinking;
  sinking.velocity = {0, 0, -0.2 * d};
  sinking.start = settled;
  builder.wall("base", shape_of("base", HalfSpace{}), {}, sinking);
  builder.wall("wall", tube(radius, -2 * d, 200 * d, d));
  FillRegion region;
  region.kind = FillRegion::Kind::frustum;
  region.radius_bottom = region.radius_top = radius;
  region.height = 10 * d;
  rain(builder, "ball", region, count, d, 5);
  const Model model = builder.build();
  Simulation s(backend, model, usual(h));
  double sum = 0;
  int samples = 0;
  s.run(1800, [&](const Simulation& now) {
    if (now.state().time < settled + 0.2) return;
    sum -= now.force_on(base).z();
    ++samples;
  });
  return sum / samples / (count * model.bodies[first_grain].mass * g);
}

/// Janssen's share for a fill of `height` and the length lambda = D / (4 mu K).
double janssen(double height, double lambda) { return lambda / height * (1 - std::exp(-height / lambda)); }

TEST_P(Silo, SmoothWallsCarryNothing) {
  expect_answer(
      {"silo with smooth walls, 150 grains: load of the base / weight", 1, base_load(GetParam(), 150, 0), 0.01},
      GetParam());
}

TEST_P(Silo, TheLoadOfTheBaseSaturates) {
  const double friction = 0.5, fraction = 0.57;
  const double per_grain = M_PI / 6 * d * d * d / (fraction * M_PI * radius * radius);  // height
  const int counts[] = {150, 300, 600};
  double load[3];
  for (int k = 0; k < 3; ++k) {
    const double share = base_load(GetParam(), counts[k], friction);
    load[k] = share * counts[k];
    note("silo, " + std::to_string(counts[k]) + " grains: load of the base / weight", share);
  }
  note("silo: load of 300 grains / of 150", load[1] / load[0]);
  note("silo: load of 600 grains / of 300", load[2] / load[1]);
  // Janssen's length from the highest fill, by bisection; then the other fills follow.
  double low = 0.1 * d, high = 100 * d;
  for (int i = 0; i < 100; ++i) {
    const double lambda = 0.5 * (low + high);
    (janssen(per_grain * counts[2], lambda) < load[2] / counts[2] ? low : high) = lambda;
  }
  note("silo: K = D / (4 mu lambda)", 2 * radius / (4 * friction * low));
  EXPECT_LT(load[2] / load[1], 1.25);
  EXPECT_GT(2 * radius / (4 * friction * low), 0.2);
  EXPECT_LT(2 * radius / (4 * friction * low), 1.3);
  for (int k = 0; k < 2; ++k)
    expect_answer({"silo, " + std::to_string(counts[k]) + " grains: load / weight against Janssen with that K",
                   janssen(per_grain * counts[k], low), load[k] / counts[k], 0.2},
                  GetParam());
}

}  // namespace
}  // namespace repose::test
