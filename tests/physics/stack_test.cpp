/// Static stacks: the reaction of every level, heavy on top of light, and what they cost the solver.
#include <algorithm>
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Stack : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Stack);

constexpr double g = 9.81, side = 0.1;
constexpr int levels = 10;

/// Ten cubes or spheres on a floor; the top one is `ratio` times as heavy as each of the others.
Model stack(bool cubes, double ratio) {
  ModelBuilder builder;
  builder.material("m")
      .law("m", "m", {.friction = 0.5, .rolling_friction = 0.05, .spinning_friction = 0.05})
      .floor("m");
  for (int i = 0; i < levels; ++i) {
    const Start start{.position = {0, 0, (i + 0.5) * side}};
    if (cubes)
      builder.box("m", Vec3::Constant(side / 2), start);
    else
      builder.sphere("m", side / 2, start);
    builder.mass(i + 1 == levels ? ratio : 1.0);
  }
  return builder.build();
}

TEST_P(Stack, ReactionIsTheWeightAboveAtEveryLevel) {
  for (const bool cubes : {false, true}) {
    const Model model = stack(cubes, 1);
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, precise(1e-3));
    s.run(100);
    double worst = 0, speed = 0;
    for (int level = 1; level <= levels; ++level) {
      const double above = (levels - level + 1) * g;
      worst = std::max(worst, std::abs(s.force_on(level, level - 1).z() / above - 1));
      speed = std::max(speed, s.velocity(level).norm());
    }
    const std::string name = cubes ? "ten cubes" : "ten spheres";
    expect_answer({name + ", worst reaction / weight above - 1", 0, worst, 1e-9, 0, 1}, GetParam());
    expect_answer({name + ", largest speed / (g t)", 0, speed / (g * 0.1), 1e-11, 0, 1}, GetParam());
  }
}

struct Cost {
  int cold = 0;          ///< iterations of the first step
  double warm = 0;       ///< mean iterations of the other steps
  double residual = 0;   ///< largest
  double converged = 0;  ///< share of steps
  double load = 0;       ///< mean force of the floor / weight
  double depth = 0;      ///< largest penetration / side
  double height = 0;     ///< of the top body at the end / side
};

Cost stand(const std::string& backend, const Model& model, const SolverOptions& options, int steps) {
  Simulation s(backend, model, options);
  s.step();
  Cost cost;
  cost.cold = s.report().iterations;
  double weight = 0;
  for (const Body& body : model.bodies) weight += body.mass * g;
  s.run(steps, [&](const Simulation& now) {
    cost.warm += static_cast<double>(now.report().iterations) / steps;
    cost.residual = std::max(cost.residual, now.report().residual);
    cost.converged += static_cast<double>(now.report().converged) / steps;
    cost.load += now.force_on(1, 0).z() / weight / steps;
    cost.depth = std::max(cost.depth, now.report().penetration / side);
  });
  cost.height = s.position(levels).z() / side;
  return cost;
}

void tell(const std::string& name, const Cost& cost) {
  note(name + ": iterations of the first, cold step", cost.cold);
  note(name + ": iterations of a warm step", cost.warm);
  note(name + ": largest residual after the first step", cost.residual);
  note(name + ": share of warm steps converged", cost.converged);
}

std::string named(bool cubes, double ratio) {
  return std::string(cubes ? "ten cubes" : "ten spheres") + ", top " + std::to_string(static_cast<int>(ratio)) + " x";
}

TEST_P(Stack, HeavyOnTop) {
  for (const bool cubes : {false, true})
    for (const double ratio : {1.0, 10.0, 100.0, 1000.0}) {
      const Model model = stack(cubes, ratio);
      REPOSE_SKIP_UNSUPPORTED(model);
      // Long thin stacks are stiff: the gradients learn their slow modes, sweeps do not.
      SolverOptions options = usual(1e-3, 1e-6);
      options.kind = SolverKind::barzilai_borwein;
      options.max_iterations = 10000;
      const Cost cost = stand(GetParam(), model, options, 100);
      const std::string name = named(cubes, ratio) + ", Barzilai-Borwein to 1e-6";
      tell(name, cost);
      expect_answer({name + ": residual", 0, cost.residual, 1e-6, 0, 1}, GetParam());
      expect_answer({name + ": mean base load / weight", 1, cost.load, 1e-3}, GetParam());
      expect_answer({name + ": largest penetration / side", 0, cost.depth, 1e-4, 0, 1}, GetParam());
      expect_answer({name + ": height of the top / side", 9.5, cost.height, 1e-4}, GetParam());
    }
}

TEST_P(Stack, WhatSweepsCostWithHeavyOnTop) {
  for (const double ratio : {1.0, 10.0, 100.0, 1000.0}) {
    const Model model = stack(false, ratio);
    REPOSE_SKIP_UNSUPPORTED(model);
    SolverOptions options = usual(1e-3, 1e-6);
    options.max_iterations = 20000;
    auto s = simulation(model, options);
    s.step();
    const std::string name = named(false, ratio) + ", Gauss-Seidel, cold step";
    note(name + ": iterations, at most 20000", s.report().iterations);
    note(name + ": residual", s.report().residual);
    // What is not reached has to be said.
    EXPECT_EQ(s.report().converged, s.report().residual <= 1e-6) << name;
    EXPECT_LE(s.report().residual, 2e-5) << name;
  }
}

// The residual is relative to the impulses, the top's weight: at a tolerance t, light bodies may part or close at
// speeds of the order t * ratio * g h. So a heavy top sinks and rises at a few g h about its place, over some 200
// steps; the load is a mean over many of these, and the mean follows from the top's last speed alone. A tower of cubes
// can also buckle, and under a top of 1,000 times it does at the default tolerance: it needs a tenth of that.
TEST_P(Stack, StandsAtUsualTolerances) {
  struct Case {
    bool cubes;
    double ratio, tolerance;
  };
  for (const Case& c : {Case{false, 1, 1e-3},
                        {false, 10, 1e-3},
                        {false, 100, 1e-3},
                        {false, 1000, 1e-3},
                        {true, 1, 1e-3},
                        {true, 10, 1e-3},
                        {true, 100, 1e-3},
                        {true, 1000, 1e-4}}) {
    const Model model = stack(c.cubes, c.ratio);
    REPOSE_SKIP_UNSUPPORTED(model);
    const Cost cost = stand(GetParam(), model, usual(1e-3, c.tolerance), c.cubes ? 500 : 2000);
    const std::string name = named(c.cubes, c.ratio) + (c.tolerance < 1e-3 ? ", tolerance 1e-4" : ", defaults");
    tell(name, cost);
    expect_answer({name + ": mean base load / weight", 1, cost.load, 0.01}, GetParam());
    expect_answer({name + ": height of the top / side", 9.5, cost.height, 0.01}, GetParam());
  }
}

TEST_P(Stack, ATowerOfCubesUnderAThousandTimesNeedsATighterTolerance) {
  if (GetParam() != "dvi") GTEST_SKIP() << "a limit of the defaults of DVI";
  const double height = stand(GetParam(), stack(true, 1000), usual(1e-3), 500).height;
  note("ten cubes, top 1000 x, defaults: height of the top after 0.5 s / side, a limit", height);
  EXPECT_LT(height, 9.4) << "it stands now: take the limit out of README.md, and this case into StandsAtUsualTolerances";
}

}  // namespace
}  // namespace repose::test
