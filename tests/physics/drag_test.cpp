/// Grains in a still fluid: implicit recursions, terminal speeds, and where Stokes' law ends.
#include <algorithm>
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Drag : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Drag);

constexpr double g = 9.81, air_viscosity = 1.8e-5, air_density = 1.2, polyamide = 1020;

Model grain(double diameter, const std::vector<Effect>& effects, const Start& start = {}) {
  ModelBuilder builder;
  builder.material("pa12", polyamide);
  for (const Effect& effect : effects) builder.effect(effect);
  return builder.sphere("pa12", diameter / 2, start).build();
}

double relaxation_time(double diameter) { return polyamide * diameter * diameter / (18 * air_viscosity); }

TEST_P(Drag, StokesTransientIsTheImplicitRecursionAtAnyStep) {
  const double d = 58e-6, tau = relaxation_time(d);
  note("Stokes drag, relaxation time of a 58 um grain in air [ms]", 1e3 * tau);
  for (const double ratio : {0.01, 1.0, 10.0}) {
    const double h = ratio * tau;
    auto s = simulation(grain(d, {LinearDrag{air_viscosity}}, {.velocity = {0.3, 0, 0.2}}), precise(h));
    double x = 0.3, z = 0.2, worst = 0;
    s.run(100, [&](const Simulation& now) {
      x = x / (1 + ratio);
      z = (z - h * g) / (1 + ratio);
      worst = std::max({worst, std::abs(now.velocity(0).x() - x) / 0.3, std::abs(now.velocity(0).z() - z) / (g * tau)});
    });
    expect_answer({"Stokes drag, worst difference from the recursion, h / tau = " + std::to_string(ratio).substr(0, 5),
                   0, worst, 1e-12, 0, 1},
                  GetParam());
  }
}

TEST_P(Drag, StokesSpinDecays) {
  const double d = 58e-6, h = 1e-3, radius = d / 2;
  auto s = simulation(grain(d, {LinearDrag{air_viscosity}}, {.angular_velocity = {0, 100, 0}}), precise(h));
  s.run(20);
  // 8 pi eta R^3 / (2/5 m R^2)
  const double rate = 15 * air_viscosity / (polyamide * radius * radius);
  expect_answer({"Stokes drag, spin after 20 ms [rad/s]", 100 * std::exp(-rate * 0.02), s.spin(0).y(), 1e-12,
                 100 * std::pow(1 + h * rate, -20)},
                GetParam());
}

TEST_P(Drag, TerminalSpeedOfStokes) {
  const double d = 58e-6;
  auto s = simulation(grain(d, {LinearDrag{air_viscosity}, Buoyancy{air_density}}), precise(2e-3));
  s.run(400);
  expect_answer({"terminal speed, 58 um grain in air, Stokes [m/s]",
                 (polyamide - air_density) * g * d * d / (18 * air_viscosity), -s.velocity(0).z(), 1e-12},
                GetParam());
}

/// Terminal speed of Schiller & Naumann's law, by bisection.
double schiller_naumann_speed(double d) {
  const double stokes = (polyamide - air_density) * g * d * d / (18 * air_viscosity);
  double low = 0, high = stokes;
  for (int i = 0; i < 200; ++i) {
    const double v = 0.5 * (low + high), reynolds = d * v * air_density / air_viscosity;
    (v * (1 + 0.15 * std::pow(reynolds, 0.687)) < stokes ? low : high) = v;
  }
  return low;
}

TEST_P(Drag, TerminalSpeedAtFiniteReynoldsNumber) {
  for (const double d : {58e-6, 80e-6, 100e-6}) {
    auto s =
        simulation(grain(d, {FiniteReynoldsDrag{air_viscosity, air_density}, Buoyancy{air_density}}), precise(2e-3));
    s.run(1000);
    const double speed = -s.velocity(0).z(), stokes = (polyamide - air_density) * g * d * d / (18 * air_viscosity);
    const std::string name = std::to_string(static_cast<int>(std::lround(d * 1e6))) + " um";
    expect_answer(
        {"terminal speed, finite Reynolds number, " + name + " [m/s]", schiller_naumann_speed(d), speed, 1e-9},
        GetParam());
    note("Reynolds number there, " + name, d * speed * air_density / air_viscosity);
    note("Stokes' terminal speed / that speed, " + name, stokes / speed);
    if (d > 75e-6) {
      EXPECT_GT(d * speed * air_density / air_viscosity, 0.5);
    }
  }
}

TEST_P(Drag, QuadraticDragIsTheHyperbolicTangent) {
  const double d = 0.01, coefficient = 0.47;
  const double mass = polyamide * M_PI / 6 * d * d * d;
  const double per_speed = 0.5 * air_density * coefficient * M_PI * d * d / 4 / mass;
  const double terminal = std::sqrt(g / per_speed), end = 1.5;
  double error[2];
  for (int k = 0; k < 2; ++k) {
    const double h = k == 0 ? 2e-3 : 1e-3;
    auto s = simulation(grain(d, {QuadraticDrag{coefficient, air_density}}), precise(h));
    double v = 0;
    const int n = static_cast<int>(std::lround(end / h));
    s.run(n, [&](const Simulation&) { v = (v + h * g) / (1 + h * per_speed * v); });
    const double closed = terminal * std::tanh(g * end / terminal);
    expect_answer({"quadratic drag, speed after 1.5 s, h = " + std::to_string(h).substr(0, 5) + " [m/s]", closed,
                   -s.velocity(0).z(), 1e-12, v},
                  GetParam());
    error[k] = std::abs(-s.velocity(0).z() - closed) / closed;
    EXPECT_LT(error[k], 2e-3);
  }
  // Half explicit, half implicit in v^2: second order.
  expect_answer({"quadratic drag, error at h / at h/2", 4, error[0] / error[1], 0.05}, GetParam());
}

TEST_P(Drag, AirIsNotSmallOverTheFallOfTheExperiment) {
  const double fall = 0.04, h = 1e-4;
  double speed[2];
  for (int air = 0; air < 2; ++air) {
    std::vector<Effect> effects;
    if (air) effects.push_back(LinearDrag{air_viscosity});
    auto s = simulation(grain(58e-6, effects, {.position = {0, 0, fall}}), precise(h));
    while (s.position(0).z() > 0) s.step();
    speed[air] = -s.velocity(0).z();
  }
  expect_answer({"fall of 40 mm in a vacuum, final speed [m/s]", std::sqrt(2 * g * fall), speed[0], 2e-3}, GetParam());
  expect_answer(
      {"fall of 40 mm in air, final speed [m/s]", polyamide * g * 58e-6 * 58e-6 / (18 * air_viscosity), speed[1], 1e-6},
      GetParam());
}

}  // namespace
}  // namespace repose::test
