/// Cohesion: a force, whatever the step, over a range that belongs to the material.
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Cohesion : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Cohesion);

constexpr double g = 9.81, radius = 29e-6, density = 1020;
constexpr double weight = density * 4.0 / 3.0 * M_PI * radius * radius * radius * g;

/// A chain of `n` grains under a plate, the first at `gap` [m] from it; every contact holds `force` [N].
Model chain(int n, double force, double rolling = 0, double gap = 0, double range = 1e-7) {
  ModelBuilder builder;
  const PairLaw law{.friction = 0.5,
                    .rolling_friction = rolling,
                    .spinning_friction = rolling,
                    .cohesion = force,
                    .cohesion_range = range};
  builder.material("pa12", density).material("plate").law("pa12", "pa12", law).law("pa12", "plate", law);
  builder.floor("plate", -Vec3::UnitZ());
  for (int i = 0; i < n; ++i) builder.sphere("pa12", radius, {.position = {0, 0, -gap - (2 * i + 1) * radius}});
  return builder.build();
}

/// How far the lowest grain has fallen below where it hung, in units of a free fall of the same time.
double fallen(const Simulation& s, int n, double step, int steps) {
  const double free = 0.5 * g * step * step * steps * (steps + 1.0);
  return (-(2 * n - 1) * radius - s.position(n).z()) / free;
}

TEST_P(Cohesion, AChainHangsWhileItsWeightIsHeld) {
  const Model first = chain(1, weight, 0.1);
  REPOSE_SKIP_UNSUPPORTED(first);
  for (const double rolling : {0.0, 0.1})
    for (const int n : {1, 2, 5, 10}) {
      const double h = 1e-5;
      const int steps = 300;
      auto holds = simulation(chain(n, n * weight * (1 + 1e-6), rolling), precise(h));
      holds.run(steps);
      auto breaks = simulation(chain(n, n * weight * (1 - 1e-3), rolling), precise(h));
      breaks.run(steps);
      const std::string name = "chain of " + std::to_string(n) + (rolling > 0 ? ", rho = sigma = 0.1" : "");
      expect_answer({name + ", c = n m g (1 + 1e-6): fall / free fall", 0, fallen(holds, n, h, steps), 1e-6, 0, 1},
                    GetParam());
      // The whole chain is pulled down by the thousandth that the plate does not hold.
      expect_answer(
          {name + ", c = n m g (1 - 1e-3): fall / free fall", 1e-3, fallen(breaks, n, h, steps), 1e-5, 1e-3, 1},
          GetParam());
    }
}

TEST_P(Cohesion, TheForceDoesNotDependOnTheStep) {
  const Model first = chain(1, weight);
  REPOSE_SKIP_UNSUPPORTED(first);
  for (const double h : {1e-3, 1e-4, 1e-5, 1e-6}) {
    const int steps = 20;
    auto s = simulation(chain(1, 0.9 * weight, 0, 0, 1), precise(h));
    s.run(steps);
    char name[64];
    std::snprintf(name, sizeof name, "grain held by 0.9 m g, h = %.0e s: a / g", h);
    expect_answer({name, 0.1, -s.velocity(1).z() / (g * h * steps), 1e-10}, GetParam());
    auto held = simulation(chain(1, 1.0001 * weight), precise(h));
    held.run(steps);
    EXPECT_LT(std::abs(held.velocity(1).z()), 1e-9 * g * h) << h;
  }
}

TEST_P(Cohesion, TheRangeEndsTheForce) {
  const Model first = chain(1, weight);
  REPOSE_SKIP_UNSUPPORTED(first);
  const double range = 1e-6, h = 1e-6;
  auto beyond = simulation(chain(1, 3 * weight, 0, 1.001 * range, range), precise(h));
  beyond.run(50);
  expect_answer({"grain just beyond the range: a / g", 1, -beyond.velocity(1).z() / (50 * h * g), 1e-12}, GetParam());
  auto within = simulation(chain(1, 3 * weight, 0, 0.5 * range, range), precise(h));
  within.run(50);
  expect_answer({"grain within the range, c = 3 m g: a / g", 2, within.velocity(1).z() / (50 * h * g), 1e-11},
                GetParam());
  within.run(1000);
  expect_answer({"the same after it has closed: force of the plate / m g", 1, within.force_on(1).z() / weight, 1e-9},
                GetParam());
  EXPECT_LT(within.velocity(1).norm(), 1e-10);
}

TEST_P(Cohesion, BondNumberOfAGrain) {
  expect_answer({"weight of a 58 um grain of polyamide 12 [N]", 1.0e-9, weight, 0.03}, GetParam());
  for (const double bond : {0.99, 1.01}) {
    const Model model = chain(1, bond * weight, 0, 0, 1);
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, precise(1e-5));
    s.run(100);
    expect_answer({"Bo = " + std::to_string(bond).substr(0, 4) + ": a / g of a hanging grain", std::max(0.0, 1 - bond),
                   -s.velocity(1).z() / (g * 1e-3), 1e-10, std::max(0.0, 1 - bond), 1},
                  GetParam());
  }
}

TEST_P(Cohesion, ADoubledSearchMarginChangesNothing) {
  // A row of grains on a floor, some within and some beyond the range of their neighbours.
  const double range = 4e-6;
  ModelBuilder builder;
  const PairLaw law{.friction = 0.4,
                    .rolling_friction = 0.05,
                    .spinning_friction = 0.05,
                    .cohesion = 5 * weight,
                    .cohesion_range = range};
  builder.material("pa12", density).law("pa12", "pa12", law).floor("pa12");
  double x = 0;
  for (int i = 0; i < 12; ++i) {
    builder.sphere("pa12", radius, {.position = {x, 0, radius + (i % 3) * 1e-6}, .velocity = {0, 1e-3 * (i % 2), 0}});
    x += 2 * radius + 0.3 * i * 2e-6;
  }
  const Model model = builder.build();
  REPOSE_SKIP_UNSUPPORTED(model);
  SolverOptions options = precise(1e-5);
  auto narrow = simulation(model, options);
  options.search_margin = 2;
  auto wide = simulation(model, options);
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    narrow.step();
    wide.step();
    for (int k = 1; k <= 12; ++k) worst = std::max(worst, (narrow.position(k) - wide.position(k)).norm() / radius);
  }
  EXPECT_GE(wide.report().contacts, narrow.report().contacts);
  expect_answer({"search margin doubled, cohesion 5 m g: largest shift of 12 grains / R", 0, worst, 1e-9, 0, 1},
                GetParam());
}

}  // namespace
}  // namespace repose::test
