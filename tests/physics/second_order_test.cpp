/// Integration::second_order of DVI against continuous time: what symplectic Euler gives in proportion to the step is gone.
#include <cmath>

#include "core/error.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

constexpr double g = 9.81;

SolverOptions second_order(double step) {
  SolverOptions options = precise(step);
  options.integration = Integration::second_order;
  return options;
}

/// Height of a ball that is let go at `drop` above the floor and bounces with e, in continuous time.
double bouncing(double drop, double e, double t) {
  const double fall = std::sqrt(2 * drop / g);
  if (t < fall) return drop - 0.5 * g * t * t;
  double speed = e * g * fall, since = t - fall;
  for (; since > 2 * speed / g; speed *= e) since -= 2 * speed / g;
  return speed * since - 0.5 * g * since * since;
}

TEST(SecondOrder, AThrownBallIsOnItsParabola) {
  const Vec3 x(0.1, -0.2, 5), v(1, 2, 3);
  const double h = 5e-3;
  Simulation s("dvi", ModelBuilder().material("m").sphere("m", 0.02, {.position = x, .velocity = v}).build(), second_order(h));
  s.run(200);
  const Vec3 closed = x + v - 0.5 * Vec3(0, 0, g);
  for (int k = 0; k < 3; ++k)
    expect_answer({std::string("second order, free fall, 1 s, ") + "xyz"[k] + " [m]", closed[k], s.position(0)[k], 1e-12, NAN, closed.norm()});
}

TEST(SecondOrder, AnImpactIsWhereAndWhenItWas) {
  const double radius = 0.05, drop = 0.6, e = 0.8;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.restitution = e})
                          .floor("m")
                          .sphere("m", radius, {.position = {0, 0, radius + drop}})
                          .build();
  for (const double h : {1e-3, 4e-3}) {
    Simulation s("dvi", model, second_order(h));
    double worst = 0;
    // Six bounces; afterwards the next comes within a few steps.
    s.run(static_cast<int>(2.4 / h), [&](const Simulation& now) {
      worst = std::max(worst, std::abs(now.position(1).z() - radius - bouncing(drop, e, now.state().time)));
    });
    // A blow takes a thousandth of the step, from which the ball leaves with the speed after it: each sets it off by up to
    // (1 + e) v h / 1000, together (1 + e) / (1 - e) / 1000.
    expect_answer({"second order, bouncing ball, worst error in 2.4 s / (h sqrt(2 g drop))", 0, worst / (h * std::sqrt(2 * g * drop)),
                   1e-3 * (1 + e) / (1 - e), NAN, 1});
  }
}

/// Two equal balls that meet aslant and slide: v_n+ = -e v_n-, and the struck one takes m (1 + e) v_n / 2 along the normal and mu times that across it, at
/// whatever moment of a step they meet.
TEST(SecondOrder, ABlowIsTheSameAtAnyMomentOfAStep) {
  const double radius = 0.02, offset = 0.0134, e = 0.8, mu = 0.03, speed = 2, h = 2.5e-4;
  const double sine = offset / (2 * radius), cosine = std::sqrt(1 - sine * sine);
  const double along = 0.5 * (1 + e) * speed * cosine, across = mu * along;  // what the struck ball gains
  const Vec3 closed(along * cosine + across * sine, 0, -along * sine + across * cosine);
  double worst = 0;
  for (int k = 0; k < 200; ++k) {
    const Model model = ModelBuilder()
                            .material("m")
                            .law("m", "m", {.friction = mu, .restitution = e})
                            .gravity(Vec3::Zero())
                            .sphere("m", radius, {.position = {-0.06 - speed * h * k / 200, 0, offset}, .velocity = {speed, 0, 0}})
                            .sphere("m", radius, {})
                            .build();
    Simulation s("dvi", model, second_order(h));
    s.run(static_cast<int>(0.03 / h));
    worst = std::max(worst, (s.velocity(1) - closed).norm() / speed);
  }
  // The blow's own step, a thousandth, is gone into before the normal is taken.
  expect_answer({"second order, two balls that meet aslant, worst of 200 moments, error of the velocity / speed", 0, worst, 1e-5, NAN, 1});
}

/// A blow a moment after the end of a step is none of this step: taken at its beginning it would come (1 + e) u h too early.
TEST(SecondOrder, ABounceIsOnTimeAtAnyMomentOfAStep) {
  const double radius = 0.02, e = 0.8, h = 1e-3, speed = 0.55;
  double worst = 0;
  for (int k = 0; k < 400; ++k) {
    const double drop = 0.5 * g * std::pow(0.056 + h * k / 400, 2);
    Simulation s("dvi",
                 ModelBuilder().material("m").law("m", "m", {.restitution = e}).floor("m").sphere("m", radius, {.position = {0, 0, radius + drop}}).build(),
                 second_order(h));
    s.run(80);
    worst = std::max(worst, std::abs(s.position(1).z() - radius - bouncing(drop, e, s.state().time)));
  }
  // The blow's own step is a thousandth.
  expect_answer({"second order, ball that falls, worst of 400 moments, error of the place after a bounce / ((1 + e) u h)", 0, worst / ((1 + e) * speed * h), 1.5e-3, NAN, 1});
}

/// Without restitution nothing comes back, whatever slides meanwhile: a ball that rolls with top spin against a wall.
TEST(SecondOrder, ABlowWithoutRestitutionTakesAllOfTheSpeed) {
  const double radius = 0.02, h = 1e-3;
  double worst = 0;
  for (int k = 0; k < 50; ++k) {
    Simulation s("dvi",
                 ModelBuilder()
                     .material("m")
                     .law("m", "m", {.friction = 0.3})
                     .floor("m")
                     .floor("m", -Vec3::UnitX(), {0.05, 0, 0})
                     .sphere("m", radius, {.position = {-0.55 * h * k / 50, 0, radius}, .velocity = {0.55, 0, 0}, .angular_velocity = {0, 60, 0}})
                     .build(),
                 second_order(h));
    s.run(70);
    worst = std::max(worst, std::abs(s.velocity(2).x()));
  }
  expect_answer({"second order, ball against a wall with e = 0, worst of 50 moments, speed away from it [m/s]", 0, worst, 1e-4, NAN, 1});
}

/// What holds a ball back over a distance does so although it will fall on the floor again, and although it falls on it now: z + v t - 3 g t^2 / 2 under twice
/// its weight beside it.
TEST(SecondOrder, CohesionReachesOverAGap) {
  const double radius = 0.02, weight = 1000 * 4.0 / 3 * M_PI * std::pow(radius, 3) * g, h = 1e-4, t = 0.03;
  for (const auto& [gap, speed] : {std::pair(1e-3, 0.5), std::pair(8e-3, 0.3)}) {
    Simulation s("dvi",
                 ModelBuilder()
                     .material("m")
                     .law("m", "m", {.cohesion = 2 * weight, .cohesion_range = 0.012})
                     .floor("m")
                     .sphere("m", radius, {.position = {0, 0, radius + gap}, .velocity = {0, 0, speed}})
                     .build(),
                 second_order(h));
    s.run(static_cast<int>(std::lround(t / h)));
    expect_answer({"second order, ball held back by cohesion over a gap, height [m]", gap + speed * t - 1.5 * g * t * t, s.position(1).z() - radius, 5e-5, NAN, 1});
  }
}

TEST(SecondOrder, ABallThatNoLongerBouncesComesToRest) {
  const double radius = 0.05;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = 0.5, .restitution = 0.5})
                          .floor("m")
                          .sphere("m", radius, {.position = {0, 0, radius + 0.1}})
                          .build();
  Simulation s("dvi", model, second_order(1e-3));
  s.run(2000);
  EXPECT_NEAR(s.position(1).z(), radius, 1e-3 * radius);
  EXPECT_LT(s.velocity(1).norm(), 1e-12);
}

/// What a landing leaves of overlap stays as long as the block slides: it must be nothing that readings of a micrometre could see.
TEST(SecondOrder, ABlockThatIsPutDownSlidesOnTheFloor) {
  double worst = 0;
  for (const double down : {0.003, 0.01, 0.03, 0.1}) {
    const Vec3 half(0.05, 0.05, 0.02);
    const Model model = ModelBuilder().material("m").law("m", "m", {.friction = 0.3}).floor("m").box("m", half, {.position = {0, 0, half.z()}, .velocity = {1, 0, -down}}).build();
    Simulation s("dvi", model, second_order(1e-3));
    s.run(20);
    worst = std::max(worst, std::abs(s.position(1).z() - half.z()));
  }
  expect_answer({"second order, block put down on the floor, worst error of its height [m]", 0, worst, 1e-6, NAN, 1});
}

TEST(SecondOrder, ASlidingBlockStopsWhereItShould) {
  const double mu = 0.3, speed = 1.2, h = 1e-3;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = mu})
                          .floor("m")
                          .box("m", {0.1, 0.1, 0.02}, {.position = {0, 0, 0.02}, .velocity = {speed, 0, 0}})
                          .build();
  Simulation s("dvi", model, second_order(h));
  s.run(200);
  expect_answer({"second order, sliding block, 0.2 s, x [m]", speed * 0.2 - 0.5 * mu * g * 0.04, s.position(1).x(), 1e-8});
  s.run(400);
  expect_answer({"second order, sliding block, stopping distance [m]", speed * speed / (2 * mu * g), s.position(1).x(), 1e-5});
}

/// Where a sliding block that crosses an incline is after 0.8 s: x down the slope. Runge-Kutta of v' = (g sin a, 0) - mu g cos a v/|v|.
Vec3 crossing_exactly(double mu, double slope, Vec3 v, double duration) {
  const auto acceleration = [&](const Vec3& u) { return Vec3(Vec3(g * std::sin(slope), 0, 0) - mu * g * std::cos(slope) * u.normalized()); };
  Vec3 x = Vec3::Zero();
  constexpr int n = 20000;
  const double h = duration / n;
  for (int i = 0; i < n; ++i) {
    const Vec3 a1 = acceleration(v), a2 = acceleration(v + 0.5 * h * a1), a3 = acceleration(v + 0.5 * h * a2), a4 = acceleration(v + h * a3);
    x += h * (v + h / 6 * (a1 + a2 + a3));
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return x;
}

TEST(SecondOrder, ABlockWhoseSlipTurnsIsWhereItShould) {
  const double mu = 0.3, slope = 0.35;
  const Vec3 speed(0.02, -0.6, 0);
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = mu})
                          .gravity(g * Vec3(std::sin(slope), 0, -std::cos(slope)))
                          .floor("m")
                          .box("m", {0.05, 0.05, 0.02}, {.position = {0, 0, 0.02}, .velocity = speed})
                          .build();
  const Vec3 exact = crossing_exactly(mu, slope, speed, 0.8);
  const auto error = [&](double h) {
    Simulation s("dvi", model, second_order(h));
    s.run(static_cast<int>(std::lround(0.8 / h)));
    return (s.position(1) - Vec3(0, 0, 0.02) - exact).norm();
  };
  const double coarse = error(4e-3), fine = error(1e-3);
  print_row("second order, block that crosses an incline, error at 1 ms [m]", 0, fine, 0, 0);
  EXPECT_LT(fine, 1e-6);
  EXPECT_GT(coarse / fine, 10);  // 16 in theory
}

/// A ball that is thrown along an incline with a spin of its own: it slides, its slip turns, and it rolls.
Vec3 spinning_ball(double h, double rolling) {
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = 0.2, .rolling_friction = rolling})
                          .gravity(g * Vec3(0.15, 0, -0.98))
                          .floor("m")
                          .sphere("m", 0.02, {.position = {0, 0, 0.02}, .velocity = {0.1, 0.8, 0}, .angular_velocity = {30, 20, 5}})
                          .build();
  Simulation s("dvi", model, second_order(h));
  s.run(static_cast<int>(std::lround(0.6 / h)));
  return s.position(1);
}

TEST(SecondOrder, ABallThatSlidesAndRollsOnAnInclineConvergesFaster) {
  for (const double rolling : {0.0, 0.05}) {
    const Vec3 exact = spinning_ball(1e-4, rolling);
    const double coarse = (spinning_ball(2e-3, rolling) - exact).norm(), fine = (spinning_ball(5e-4, rolling) - exact).norm();
    print_row("second order, ball with spin on an incline, error at 0.5 ms [m]", 0, fine, 0, 0);
    EXPECT_LT(fine, 2e-5) << rolling;
    EXPECT_GT(coarse / fine, 6) << rolling;
  }
}

/// A box that tumbles about its middle axis: the unstable one, where every error shows.
Vec3 tip_of_tumbling_box(double h, Integration integration) {
  SolverOptions options = precise(h);
  options.integration = integration;
  Simulation s("dvi", ModelBuilder().material("m").gravity(Vec3::Zero()).box("m", {0.03, 0.05, 0.08}, {.angular_velocity = {0.3, 9, 0.2}}).build(),
               options);
  s.run(static_cast<int>(std::lround(1 / h)));
  return s.state().orientation[0] * Vec3(0, 0, 1);
}

TEST(SecondOrder, TumblingConvergesWithTheSquareOfTheStep) {
  const Vec3 exact = tip_of_tumbling_box(2e-5, Integration::second_order);
  const double coarse = (tip_of_tumbling_box(2e-3, Integration::second_order) - exact).norm();
  const double fine = (tip_of_tumbling_box(1e-3, Integration::second_order) - exact).norm();
  const double euler = (tip_of_tumbling_box(1e-3, Integration::symplectic_euler) - exact).norm();
  expect_answer({"second order, tumbling box, error at 2 h / error at h", 4, coarse / fine, 0.2});
  EXPECT_LT(fine, 0.05 * euler);
}

/// A cube that falls on an edge, tips over and comes to lie.
Vec3 thrown_cube(double h, Integration integration) {
  SolverOptions options = usual(h, 1e-8);
  options.integration = integration;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = 0.2, .restitution = 0.3})
                          .floor("m")
                          .box("m", {0.05, 0.05, 0.05},
                               {.position = {0, 0, 0.2}, .velocity = {0.4, 0.1, 0}, .angular_velocity = {0, 3, 0.5}, .orientation = turn(0.4, {0.3, 1, 0.2})})
                          .build();
  Simulation s("dvi", model, options);
  s.run(static_cast<int>(std::lround(0.3 / h)));
  return s.position(1);
}

TEST(SecondOrder, AThrownCubeConvergesFaster) {
  const Vec3 exact = thrown_cube(1e-5, Integration::second_order);
  const double ours = (thrown_cube(1e-3, Integration::second_order) - exact).norm();
  const double euler = (thrown_cube(1e-3, Integration::symplectic_euler) - exact).norm();
  print_row("second order, thrown cube, 0.3 s, error of symplectic Euler / ours", 0, euler / ours, 0, 0);
  EXPECT_LT(ours, 0.2 * euler);
}

TEST(SecondOrder, DampingActsOnTheMeanSpin) {
  const double h = 0.02, rate = 3;  // 1/s: 8 pi eta R^3 / I
  const double radius = 0.02, inertia = 0.4 * 1000 * 4.0 / 3.0 * M_PI * std::pow(radius, 5);
  const Model model = ModelBuilder()
                          .material("m")
                          .gravity(Vec3::Zero())
                          .effect(LinearDrag{rate * inertia / (8 * M_PI * std::pow(radius, 3))})
                          .sphere("m", radius, {.angular_velocity = {0, 0, 30}})
                          .build();
  Simulation s("dvi", model, second_order(h));
  s.run(50);
  const double left = (1 - rate * h / 2) / (1 + rate * h / 2);
  expect_answer({"second order, linear drag, spin after 1 s [rad/s]", 30 * std::exp(-rate), s.state().angular_velocity[0].z(), 1e-12, 30 * std::pow(left, 50)});
}

TEST(SecondOrder, DampingActsOnTheMeanVelocity) {
  const double h = 0.02, rate = 3;  // 1/s
  const double mass = 1000 * 4.0 / 3.0 * M_PI * std::pow(0.02, 3);
  const Model model = ModelBuilder().material("m").gravity(Vec3::Zero()).effect(LinearDrag{rate * mass / (6 * M_PI * 0.02)}).sphere("m", 0.02, {.velocity = {2, 0, 0}}).build();
  Simulation s("dvi", model, second_order(h));
  s.run(50);
  const double left = (1 - rate * h / 2) / (1 + rate * h / 2);
  expect_answer({"second order, linear drag, speed after 1 s [m/s]", 2 * std::exp(-rate), s.velocity(0).x(), 1e-12, 2 * std::pow(left, 50)});
}

TEST(SecondOrder, OtherBackendsRefuseIt) {
  const Model model = ModelBuilder().material("m").sphere("m", 0.1).build();
  for (const Backend& backend : backends()) {
    if (backend.has_second_order) continue;
    EXPECT_THROW(backend.make(model, second_order(1e-3)), Error) << backend.name;
  }
}

}  // namespace
}  // namespace repose::test
