/// What goes wrong at powder scale where thresholds are absolute and units are mixed, and does not here.
#include <algorithm>
#include <cmath>

#include "backends/dvi/cone_solver.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/energy.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class PowderScale : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(PowderScale);

constexpr double g = 9.81, diameter = 58e-6;

const PairLaw rough{.friction = 0.52, .rolling_friction = 0.1, .spinning_friction = 0.1};

double weight_of(const Model& model) {
  double weight = 0;
  for (const Body& body : model.bodies) weight += body.mass * g;
  return weight;
}

/// Mean upward load of the floor (body 0) and of the rough walls of a pile's box (1 to 4) / weight of all grains.
class BoxLoad {
 public:
  void add(const Simulation& s) {
    for (int wall = 0; wall < 5; ++wall) sum_ -= s.force_on(wall).z() / weight_of(s.model());
    ++steps_;
  }
  double mean() const { return sum_ / steps_; }

 private:
  double sum_ = 0;
  int steps_ = 0;
};

TEST_P(PowderScale, GrainsDoNotFallThroughEachOther) {
  struct Run {
    double h, time;
  };
  // m g h of a grain is 1e-14 N s at the first of these steps, and less at the others.
  for (const Run& run : {Run{1e-5, 0.015}, {2e-6, 0.015}, {5e-7, 0.006}}) {
    const Model model = pile({.count = 18,
                              .law = {.friction = 0.5},
                              .wall_law = {},
                              .diameter = diameter,
                              .spread = 0.1,
                              .across = 3,
                              .fall = 0.02});
    auto s = simulation(model, usual(run.h));
    double depth = 0, lowest = 1;
    BoxLoad load;
    s.run(static_cast<int>(std::lround(run.time / run.h)), [&](const Simulation& now) {
      depth = std::max(depth, now.report().penetration);
      if (now.state().time > 0.8 * run.time) load.add(now);
      for (int b = 5; b < 23; ++b)
        lowest = std::min(lowest, now.position(b).z() / model.bodies[static_cast<std::size_t>(b)].radius);
    });
    char name[64];
    std::snprintf(name, sizeof name, "18 grains of 58 um, h = %.0e s", run.h);
    expect_answer({std::string(name) + ": largest penetration / d", 0, depth / diameter, 1e-3, 0, 1}, GetParam());
    expect_answer({std::string(name) + ": mean load of the box / weight", 1, load.mean(), 0.01}, GetParam());
    expect_answer({std::string(name) + ": largest sink into the floor / R", 0, std::max(0.0, 1 - lowest), 2e-3, 0, 1},
                  GetParam());
  }
}

TEST_P(PowderScale, ABedWithRollingFrictionIsHeldInTheFirstStep) {
  const Model model = lattice(10, 20, diameter, rough);
  REPOSE_SKIP_UNSUPPORTED(model);
  const double h = 1e-5;
  SolverOptions options = usual(h, 1e-6);
  options.max_iterations = 4000;
  auto s = simulation(model, options);
  s.step();
  double fastest = 0;
  for (int b = 1; b <= 2000; ++b) fastest = std::max(fastest, s.velocity(b).norm());
  note("bed of 2,000 grains, rho = sigma = 0.1: iterations of a cold step to 1e-6", s.report().iterations);
  EXPECT_TRUE(s.report().converged);
  expect_answer({"that bed: fastest grain / g h", 0, fastest / (g * h), 1e-3, 0, 1}, GetParam());
  expect_answer({"that bed: load of the floor / weight", 1, -s.force_on(0).z() / weight_of(model), 1e-3}, GetParam());
}

TEST_P(PowderScale, AFallenBedWithRollingFrictionComesToRest) {
  const Model model =
      pile({.count = 300, .law = rough, .wall_law = rough, .diameter = diameter, .across = 7, .fall = 0.02});
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, usual(2e-5));
  int converged = 0, iterations = 0;
  double depth = 0;
  BoxLoad load;
  int steps = 0;
  const auto energy = [&] { return kinetic_energy(s) / (weight_of(model) * diameter); };
  // The last grain rolls into its hole after 0.04 to 0.06 s.
  while (steps < 1500 || (steps < 6000 && energy() > 1e-10)) {
    s.step();
    ++steps;
    converged += s.report().converged;
    iterations += s.report().iterations;
    depth = std::max(depth, s.report().penetration);
  }
  s.run(200, [&](const Simulation& now) { load.add(now); });
  const std::string name = "300 grains fall and settle, rho = sigma = 0.1";
  note(name + ": iterations per step to 1e-3", static_cast<double>(iterations) / steps);
  note(name + ": share of steps converged", static_cast<double>(converged) / steps);
  EXPECT_GE(converged, 0.99 * steps);
  expect_answer({name + ": largest penetration / d", 0, depth / diameter, 0.01, 0, 1}, GetParam());
  expect_answer({name + ": load of the box / weight", 1, load.mean(), 1e-3}, GetParam());
  note(name + ": time until they rest [ms]", steps * 2e-2);
  expect_answer({name + ": kinetic energy / m g d", 0, energy(), 1e-9, 0, 1}, GetParam());
}

TEST_P(PowderScale, AWarmStartSavesIterations) {
  if (GetParam() != "dvi") GTEST_SKIP() << "a choice of DVI alone";
  const Model model =
      pile({.count = 64, .law = rough, .wall_law = rough, .diameter = diameter, .across = 4, .fall = 0.02});
  Simulation settling("dvi", model, usual(2e-5));
  settling.run(1000);
  Frame frame;
  settling.world().save(frame);
  const auto iterations = [&](bool warm) {
    SolverOptions options = usual(2e-5);
    options.warm_start = warm;
    Simulation s("dvi", model, options);
    s.restore(frame);
    int sum = 0;
    s.run(50, [&](const Simulation& now) { sum += now.report().iterations; });
    return sum / 50.0;
  };
  const double warm = iterations(true), cold = iterations(false);
  note("settled bed of 64 grains: iterations per step to 1e-3, warm", warm);
  note("settled bed of 64 grains: iterations per step to 1e-3, cold", cold);
  EXPECT_LT(2 * warm, cold);
}

TEST(PowderScaleMemory, AContactTakesAFewHundredBytes) {
  dvi::ConeProblem problem;
  const int n = 3000;
  problem.dynamic_bodies = n;
  problem.inverse_mass.assign(n + 1, {1, {2.5, 0, 0, 2.5, 0, 2.5}});
  problem.inverse_mass.back() = {};
  problem.velocity.assign(n + 1, Vec3(0, 0, -0.01));
  problem.velocity.back().setZero();
  problem.angular_velocity.assign(n + 1, Vec3::Zero());
  for (int i = 0; i < n; ++i)
    for (const int neighbour : {1, 17, 34}) {
      dvi::ConeContact c;
      c.a = i;
      c.b = (i + neighbour) % (n + 1);
      c.arm_a = Vec3::UnitZ();
      c.arm_b = -Vec3::UnitZ();
      c.friction = 0.5;
      c.rolling = c.spinning = 0.05;
      problem.contacts.push_back(c);
    }
  std::vector<dvi::Impulse> impulse(problem.contacts.size());
  std::vector<Vec3> velocity, spin;
  SolverOptions options = usual(1e-3);
  options.max_iterations = 10;
  dvi::SolverRoom room;
  const auto report = dvi::solve(problem, options, impulse, velocity, spin, room);
  const double bytes = static_cast<double>(report.bytes) / static_cast<double>(problem.contacts.size());
  note("memory of the solver per contact, rolling and spinning on [bytes]", bytes);
  EXPECT_LT(bytes, 400);
}

}  // namespace
}  // namespace repose::test
