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

struct Filling {
  double share = 0;   ///< load of the base / weight of all grains
  double height = 0;  ///< of the fill [m]: twice the mean height of a grain
};

/// A filling while its base sinks slowly, so that friction holds the grains everywhere.
Filling fill_silo(const std::string& backend, int count, double wall_friction, unsigned seed) {
  // The base sinks by half a diameter in all; a tenth of that is enough for the walls to carry what they can.
  const double h = 2e-3, settled = 0.8;
  ModelBuilder builder;
  builder.material("ball", 1000).material("wall").material("base");
  builder.law("ball", "ball", {.friction = 0.5})
      .law("ball", "wall", {.friction = wall_friction})
      .law("ball", "base", {.friction = 0.5});
  Motion sinking;
  sinking.velocity = {0, 0, -0.5 * d};
  sinking.start = settled;
  builder.wall("base", shape_of("base", HalfSpace{}), {}, sinking);
  builder.wall("wall", tube(radius, -2 * d, 200 * d, d));
  FillRegion region;
  region.kind = FillRegion::Kind::frustum;
  region.radius_bottom = region.radius_top = radius;
  region.height = 10 * d;
  rain(builder, "ball", region, count, d, seed);
  const Model model = builder.build();
  Simulation s(backend, model, usual(h));
  double sum = 0;
  int samples = 0;
  s.run(900, [&](const Simulation& now) {
    if (now.state().time < settled + 0.1) return;
    sum -= now.force_on(base).z();
    ++samples;
  });
  Filling filling;
  filling.share = sum / samples / (count * model.bodies[first_grain].mass * g);
  for (int i = 0; i < count; ++i) filling.height += 2 * s.position(first_grain + i).z() / count;
  return filling;
}

/// Janssen's share for a fill of `height` and the length lambda = D / (4 mu K).
double janssen(double height, double lambda) { return lambda / height * (1 - std::exp(-height / lambda)); }

TEST_P(Silo, SmoothWallsCarryNothing) {
  expect_answer({"silo with smooth walls, 150 grains: load of the base / weight", 1,
                 fill_silo(GetParam(), 150, 0, 5).share, 1e-3},
                GetParam());
}

TEST_P(Silo, TheLoadOfTheBaseSaturates) {
  const double friction = 0.5;
  const int counts[] = {100, 220, 520};
  double share[3] = {}, height[3] = {};
  for (int k = 0; k < 3; ++k) {
    // The load of a single filling scatters: by 2 % at 100 grains, 5 % at 220, 9 % at 440 (standard deviation of 4).
    for (const unsigned seed : {1u, 2u, 3u}) {
      const Filling filling = fill_silo(GetParam(), counts[k], friction, seed);
      share[k] += filling.share / 3;
      height[k] += filling.height / 3;
    }
    note("silo, " + std::to_string(counts[k]) + " grains: height of the fill / d", height[k] / d);
    note("silo, " + std::to_string(counts[k]) + " grains: load of the base / weight", share[k]);
  }
  // Janssen's length from the highest fill, by bisection; then the other fills follow.
  double low = 0.1 * d, high = 100 * d;
  for (int i = 0; i < 100; ++i) {
    const double lambda = 0.5 * (low + high);
    (janssen(height[2], lambda) < share[2] ? low : high) = lambda;
  }
  const double lambda = low, ratio = 2 * radius / (4 * friction * lambda);
  note("silo: length lambda / d from the highest fill", lambda / d);
  note("silo: K = D / (4 mu lambda)", ratio);
  // Grains push sideways less than they are pushed down, and more than at the limit of sliding:
  // (1 - sin) / (1 + sin) of an angle of friction of 30 degrees.
  EXPECT_GT(ratio, 0.33);
  EXPECT_LT(ratio, 1);
  for (int k = 0; k < 2; ++k)
    expect_answer({"silo, " + std::to_string(counts[k]) + " grains: load / weight against Janssen with that K",
                   janssen(height[k], lambda), share[k], 0.1},
                  GetParam());
  const double more = static_cast<double>(counts[2]) / counts[1], rise = more * share[2] / share[1];
  expect_answer({"silo: load of 520 grains / of 220; without friction 2.36",
                 more * janssen(height[2], lambda) / janssen(height[1], lambda), rise, 0.1},
                GetParam());
  EXPECT_LT(rise, 1.4);
}

}  // namespace
}  // namespace repose::test
