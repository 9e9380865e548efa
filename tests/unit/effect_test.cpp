#include "core/effect.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/model_builder.hpp"

namespace repose {
namespace {

using test::ModelBuilder;
using test::Start;

constexpr double pi = std::numbers::pi;
constexpr double g = 9.81;
constexpr double air_viscosity = 1.8e-5, air_density = 1.2;
constexpr double pa12 = 1020;           // density of the grain's solid [kg/m^3]
constexpr double radius = 0.5 * 58e-6;  // of the mean grain [m]

Model one_grain(const Effect& effect, const Start& start = {}, double grain_radius = radius) {
  return ModelBuilder().material("pa12", pa12).sphere("pa12", grain_radius, start).effect(effect).build();
}

BodyLoads loads_of(const Model& model) {
  BodyLoads loads;
  evaluate_loads(model, model.initial, loads);
  return loads;
}

/// One step of free flight as effect.hpp prescribes it, for the only body of the model.
void advance(const Model& model, Snapshot& state, double h) {
  BodyLoads loads;
  evaluate_loads(model, state, loads);
  const Body& body = model.bodies[0];
  state.velocity[0] = (body.mass * state.velocity[0] + h * loads.force[0]) / (body.mass + h * loads.linear_damping[0]);
  state.angular_velocity[0] =
      body.inertia.x() * state.angular_velocity[0] / (body.inertia.x() + h * loads.angular_damping[0]);
  state.position[0] += h * state.velocity[0];
  state.time += h;
}

/// Falls until the speed no longer changes.
double terminal_speed(const Model& model, double h) {
  Snapshot state = model.initial;
  double last = -1;
  for (int k = 0; k < 100000 && std::abs(state.velocity[0].z() - last) > 1e-15 * std::abs(last); ++k) {
    last = state.velocity[0].z();
    advance(model, state, h);
  }
  return -state.velocity[0].z();
}

TEST(Effect, NamesAreTheSceneKeys) {
  EXPECT_EQ(effect_name(GravityTilt{}), "gravity_tilt");
  EXPECT_EQ(effect_name(UniformForce{}), "uniform_force");
  EXPECT_EQ(effect_name(LinearDrag{}), "linear_drag");
  EXPECT_EQ(effect_name(QuadraticDrag{}), "quadratic_drag");
  EXPECT_EQ(effect_name(FiniteReynoldsDrag{}), "finite_reynolds_drag");
  EXPECT_EQ(effect_name(Buoyancy{}), "buoyancy");
  EXPECT_EQ(effect_name(Magnus{}), "magnus");
  EXPECT_EQ(effect_name(PeriodicForce{}), "periodic_force");
}

TEST(Effect, WithoutEffectsThereIsGravityAlone) {
  const Model model = ModelBuilder().material("pa12", pa12).sphere("pa12", radius).build();
  const BodyLoads loads = loads_of(model);
  EXPECT_EQ(loads.force[0], model.bodies[0].mass * Vec3(0, 0, -g));
  EXPECT_EQ(loads.torque[0], Vec3::Zero());
  EXPECT_EQ(loads.linear_damping[0], 0);
  EXPECT_EQ(loads.angular_damping[0], 0);
}

TEST(Effect, BodiesThatDoNotMoveFreelyCarryNoLoad) {
  const Model model = ModelBuilder()
                          .material("pa12", pa12)
                          .floor("pa12")
                          .sphere("pa12", radius, {.velocity = {1, 2, 3}})
                          .effect(UniformForce{{1, 1, 1}})
                          .effect(LinearDrag{air_viscosity})
                          .effect(Buoyancy{air_density})
                          .build();
  const BodyLoads loads = loads_of(model);
  ASSERT_EQ(loads.force.size(), 2u);
  EXPECT_EQ(loads.force[0], Vec3::Zero());
  EXPECT_EQ(loads.linear_damping[0], 0);
  EXPECT_EQ(loads.angular_damping[0], 0);
  EXPECT_NE(loads.force[1], Vec3::Zero());
  EXPECT_GT(loads.linear_damping[1], 0);
}

TEST(Effect, GravityTiltTurnsAboutXThenY) {
  const double a = 20 * pi / 180, b = 35 * pi / 180;
  const std::vector<Effect> about_x{GravityTilt{20, 0}}, about_y{GravityTilt{0, 35}}, both{GravityTilt{20, 35}};
  const Vec3 down(0, 0, -g);
  EXPECT_TRUE(tilted_gravity(down, about_x).isApprox(g * Vec3(0, std::sin(a), -std::cos(a)), 1e-15));
  EXPECT_TRUE(tilted_gravity(down, about_y).isApprox(g * Vec3(-std::sin(b), 0, -std::cos(b)), 1e-15));
  // Ry(b) Rx(a) (0, 0, -g): x first.
  const Vec3 expected = g * Vec3(-std::cos(a) * std::sin(b), std::sin(a), -std::cos(a) * std::cos(b));
  EXPECT_TRUE(tilted_gravity(down, both).isApprox(expected, 1e-15));
  EXPECT_EQ(tilted_gravity(down, std::vector<Effect>{GravityTilt{}}), down);

  const Model model = one_grain(GravityTilt{20, 35});
  EXPECT_TRUE(loads_of(model).force[0].isApprox(model.bodies[0].mass * expected, 1e-15));
}

TEST(Effect, TiltedFallIsTheParabolaOfTheTiltedGravity) {
  const Model model = one_grain(GravityTilt{0, 30}, {.velocity = {0.1, 0.2, 0.3}}, 0.01);
  Snapshot state = model.initial;
  const double h = 1e-3;
  const int n = 500;
  for (int k = 0; k < n; ++k) advance(model, state, h);
  const Vec3 gravity = tilted_gravity(model.gravity, model.effects);
  const Vec3 expected = n * h * Vec3(0.1, 0.2, 0.3) + 0.5 * n * (n + 1) * h * h * gravity;  // exact discrete sum
  EXPECT_LT((state.position[0] - expected).norm(), 1e-13);
}

TEST(Effect, UniformForceActsOnEveryBodyAlike) {
  const Vec3 force(1e-9, -2e-9, 3e-9);
  const Model model = ModelBuilder()
                          .material("pa12", pa12)
                          .sphere("pa12", radius)
                          .sphere("pa12", 2 * radius, {.position = {1, 0, 0}})
                          .gravity(Vec3::Zero())
                          .effect(UniformForce{force})
                          .build();
  const BodyLoads loads = loads_of(model);
  EXPECT_EQ(loads.force[0], force);
  EXPECT_EQ(loads.force[1], force);
}

TEST(Effect, RelaxationTimeOfTheMeanGrainInAirIsTenMilliseconds) {
  const Model model = one_grain(LinearDrag{air_viscosity});
  const double tau = model.bodies[0].mass / loads_of(model).linear_damping[0];
  EXPECT_NEAR(tau, 2 * pa12 * radius * radius / (9 * air_viscosity), 1e-16);
  EXPECT_NEAR(tau, 10.5e-3, 0.1e-3);
}

TEST(Effect, StokesTransientIsTheImplicitRecursionAtAnyStep) {
  const Model model =
      one_grain(LinearDrag{air_viscosity}, {.velocity = {0.4, 0, 0.2}, .angular_velocity = {0, 100, 0}});
  const double tau = 2 * pa12 * radius * radius / (9 * air_viscosity);
  const double tau_turn = pa12 * radius * radius / (15 * air_viscosity);  // (2/5 m R^2) / (8 pi eta R^3)
  for (const double h : {0.01 * tau, tau, 10 * tau}) {
    Snapshot state = model.initial;
    Vec3 v = state.velocity[0];
    double w = 100;
    for (int n = 0; n < 60; ++n) {
      v = (v + h * Vec3(0, 0, -g)) / (1 + h / tau);
      w = w / (1 + h / tau_turn);
      advance(model, state, h);
      ASSERT_LT((state.velocity[0] - v).norm(), 1e-14 * (0.5 + v.norm())) << n;
      ASSERT_NEAR(state.angular_velocity[0].y(), w, 1e-13 * 100) << n;
    }
    // The same recursion summed: v_n = v_t + (v_0 - v_t) / (1 + h/tau)^n.
    const double decay = std::pow(1 + h / tau, -60);
    EXPECT_NEAR(state.velocity[0].z(), -g * tau + (0.2 + g * tau) * decay, 1e-14);
    EXPECT_NEAR(state.velocity[0].x(), 0.4 * decay, 1e-14);
  }
}

TEST(Effect, TerminalSpeedInAirWithBuoyancy) {
  const double expected = (pa12 - air_density) * g * 4 * radius * radius / (18 * air_viscosity);
  Model model = one_grain(LinearDrag{air_viscosity});
  model.effects.push_back(Buoyancy{air_density});
  EXPECT_NEAR(terminal_speed(model, 0.02), expected, 1e-12 * expected);
  EXPECT_NEAR(expected, 0.10, 0.005);
}

TEST(Effect, BuoyancyFollowsTheTiltedGravity) {
  Model model = one_grain(GravityTilt{25, -10});
  const double fluid = 0.5 * pa12;
  model.effects.push_back(Buoyancy{fluid});
  const Vec3 gravity = tilted_gravity(model.gravity, model.effects);
  const double volume = 4.0 / 3 * pi * radius * radius * radius;
  EXPECT_TRUE(loads_of(model).force[0].isApprox(0.5 * pa12 * volume * gravity, 1e-14));
}

TEST(Effect, QuadraticDragFollowsItsRecursionAndItsClosedForm) {
  const double ball = 0.02, density = 1020, c = 0.47;
  const Model model = one_grain(QuadraticDrag{c, air_density}, {}, ball);
  const double k = 0.5 * air_density * c * pi * ball * ball / (density * 4.0 / 3 * pi * ball * ball * ball);  // [1/m]
  const double terminal = std::sqrt(g / k);
  const double h = 1e-4;
  Snapshot state = model.initial;
  double v = 0;
  for (int n = 0; n < 30000; ++n) {
    v = (v - h * g) / (1 + h * k * std::abs(v));
    advance(model, state, h);
  }
  EXPECT_NEAR(state.velocity[0].z(), v, 1e-10);
  // The recursion is of first order in h; v = -v_t tanh(g t / v_t) is its limit.
  EXPECT_NEAR(v, -terminal * std::tanh(g * 3.0 / terminal), 2 * h * g);
  EXPECT_NEAR(terminal_speed(model, 0.05), terminal, 1e-9 * terminal);
  EXPECT_EQ(loads_of(model).angular_damping[0], 0);
}

TEST(Effect, FiniteReynoldsDragIsSchillerNaumann) {
  for (const double speed : {0.0, 1e-4, 0.1, 0.9}) {
    const Model model =
        one_grain(FiniteReynoldsDrag{air_viscosity, air_density}, {.velocity = {0, 0.6 * speed, -0.8 * speed}});
    const double re = 2 * radius * speed * air_density / air_viscosity;
    const double expected = 6 * pi * air_viscosity * radius * (1 + 0.15 * std::pow(re, 0.687));
    const BodyLoads loads = loads_of(model);
    EXPECT_NEAR(loads.linear_damping[0], expected, 1e-14 * expected);
    const double turning = 8 * pi * air_viscosity * radius * radius * radius;
    EXPECT_NEAR(loads.angular_damping[0], turning, 1e-14 * turning);
  }
}

TEST(Effect, StokesOverstatesTheTerminalSpeedOfLargeGrains) {
  const double large = 50e-6;  // radius of a 100 um grain: Re about 2
  const double stokes = terminal_speed(one_grain(LinearDrag{air_viscosity}, {}, large), 0.1);
  const double finite = terminal_speed(one_grain(FiniteReynoldsDrag{air_viscosity, air_density}, {}, large), 0.1);
  // The root of m g = 6 pi eta R v (1 + 0.15 Re^0.687), by bisection.
  double low = 0, high = stokes;
  for (int k = 0; k < 200; ++k) {
    const double v = 0.5 * (low + high);
    const double re = 2 * large * v * air_density / air_viscosity;
    (v * (1 + 0.15 * std::pow(re, 0.687)) < stokes ? low : high) = v;
  }
  EXPECT_NEAR(finite, low, 1e-9 * low);
  EXPECT_LT(finite, 0.85 * stokes);
}

TEST(Effect, MagnusPushesAcrossSpinAndPath) {
  const Start start{.velocity = {3, 0, 0}, .angular_velocity = {0, 20, 5}};
  const Model model = one_grain(Magnus{0.75, air_density}, start);
  const BodyLoads loads = loads_of(model);
  const double k = 0.75 * air_density * 4.0 / 3 * pi * radius * radius * radius;
  const Vec3 lift = loads.force[0] - model.bodies[0].mass * Vec3(0, 0, -g);
  EXPECT_TRUE(lift.isApprox(k * Vec3(0, 15, -60), 1e-12)) << lift.transpose() / k;
  EXPECT_EQ(loads.torque[0], Vec3::Zero());
}

TEST(Effect, PeriodicForceFollowsTheClock) {
  Model model = one_grain(PeriodicForce{{1, 2, 3}, 4, 0.5});
  model.gravity = Vec3::Zero();
  model.initial.time = 0.3;
  const double mass = model.bodies[0].mass;
  EXPECT_TRUE(loads_of(model).force[0].isApprox(mass * std::sin(2 * pi * 4 * 0.3 + 0.5) * Vec3(1, 2, 3), 1e-14));
}

TEST(Effect, FroudeSimilarLoadsHaveTheSameBits) {
  const Model big = ModelBuilder()
                        .material("pa12", pa12)
                        .sphere("pa12", 0.37, {.velocity = {0.3, -0.7, 1.1}, .angular_velocity = {3, 1, 2}})
                        .effect(GravityTilt{10, 20})
                        .effect(UniformForce{{1, 2, 3}})
                        .effect(LinearDrag{0.7})
                        .effect(QuadraticDrag{0.47, 1.2})
                        .effect(FiniteReynoldsDrag{0.3, 1.1})
                        .effect(Buoyancy{1.2})
                        .effect(Magnus{0.7, 1.2})
                        .effect(PeriodicForce{{1, -2, 3}, 4, 0.5})
                        .build();
  const double length = std::ldexp(1.0, -14), time = std::ldexp(1.0, -7);
  const BodyLoads a = loads_of(big), b = loads_of(froude_scaled(big, length));
  const double cube = length * length * length;
  EXPECT_EQ(cube * a.force[0], b.force[0]);
  EXPECT_EQ(cube / time * a.linear_damping[0], b.linear_damping[0]);
  EXPECT_EQ(cube * length * length / time * a.angular_damping[0], b.angular_damping[0]);
}

}  // namespace
}  // namespace repose
