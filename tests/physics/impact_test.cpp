/// Restitution: one bounce, many bounces, rows of balls, and the guard that no impact gains energy.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/random.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/energy.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Impact : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Impact);

TEST_P(Impact, SpeedIsRestoredWhateverTheGap) {
  const double h = 1e-3, v = 2, radius = 0.05;
  for (const double e : {0.0, 0.3, 0.8, 1.0}) {
    double worst = 0;
    for (const double share : {0.0, 1e-6, 0.25, 0.5, 0.999}) {
      const Model model = ModelBuilder()
                              .material("m")
                              .law("m", "m", {.friction = 0.5, .restitution = e})
                              .gravity(Vec3::Zero())
                              .floor("m")
                              .sphere("m", radius, {.position = {0, 0, radius + share * v * h}, .velocity = {0, 0, -v}})
                              .build();
      auto s = simulation(model, precise(h));
      s.run(2);
      worst = std::max(worst, std::abs(s.velocity(1).z() - e * v));
    }
    expect_answer({"impact, e = " + std::to_string(e).substr(0, 3) + ", worst |v+ - e v-| / v over five gaps", 0,
                   worst / v, 1e-12, 0, 1},
                  GetParam());
  }
}

TEST_P(Impact, HeadOnBetweenTwoGrains) {
  const double e = 0.6, h = 1e-4;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.restitution = e})
                          .gravity(Vec3::Zero())
                          .sphere("m", 0.01, {.position = {0, 0, 0}, .velocity = {1, 0, 0}})
                          .sphere("m", 0.02, {.position = {0.03004, 0, 0}})
                          .build();
  auto s = simulation(model, precise(h));
  s.run(3);
  // Masses 1 and 8.
  expect_answer({"two grains, masses 1:8, e = 0.6, v1", (1 - 8 * e) / 9, s.velocity(0).x(), 1e-12}, GetParam());
  expect_answer({"two grains, masses 1:8, e = 0.6, v2", (1 + e) / 9, s.velocity(1).x(), 1e-12}, GetParam());
}

TEST_P(Impact, BounceHeightsFallGeometrically) {
  const double e = 0.8, h = 1e-4, radius = 0.05, drop = 1, g = 9.81;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.restitution = e})
                          .floor("m")
                          .sphere("m", radius, {.position = {0, 0, radius + drop}})
                          .build();
  auto s = simulation(model, precise(h));
  // The law of backends/dvi/impact.hpp for one coordinate.
  double x = drop, v = 0, worst = 0;
  std::vector<double> heights{drop};
  double top = 0;
  s.run(25000, [&](const Simulation& now) {
    const double free = v - h * g, before = v;
    v = x + h * free <= 0 ? -e * before : free;
    x += h * v;
    worst = std::max(worst, std::abs(now.position(1).z() - radius - x));
    top = std::max(top, now.position(1).z() - radius);
    if (before <= 0 && v > 0) top = 0;
    if (before > 0 && v <= 0) heights.push_back(top);
  });
  expect_answer({"bouncing ball, worst distance from the discrete law in 2.5 s [m]", 0, worst, 1e-9, 0, 1}, GetParam());
  ASSERT_GE(heights.size(), 5u);
  for (std::size_t n = 1; n < 5; ++n)
    expect_answer({"bounce " + std::to_string(n) + ", height / drop", std::pow(e, 2.0 * static_cast<double>(n)),
                   heights[n] / drop, 2e-3},
                  GetParam());
}

/// Balls in a row, the first one moving at 1 m/s, e = 1, without gravity.
std::vector<double> row_after(const std::string& backend, int balls, double gap, double first_gap, int steps) {
  const double radius = 0.05, h = 1e-3;
  ModelBuilder builder;
  builder.material("m").law("m", "m", {.restitution = 1}).gravity(Vec3::Zero());
  double x = 0;
  for (int i = 0; i < balls; ++i) {
    builder.sphere("m", radius, {.position = {x, 0, 0}, .velocity = {i == 0 ? 1.0 : 0.0, 0, 0}});
    x += 2 * radius + (i == 0 ? first_gap : gap);
  }
  Simulation s(backend, builder.build(), precise(h));
  s.run(steps);
  std::vector<double> speeds;
  for (int i = 0; i < balls; ++i) speeds.push_back(s.velocity(i).x());
  return speeds;
}

TEST_P(Impact, RowWithGapsPassesTheImpulseOn) {
  for (const int balls : {3, 5}) {
    const std::vector<double> v = row_after(GetParam(), balls, 1.5e-3, 1.5e-3, 30);
    for (int i = 0; i < balls; ++i)
      expect_answer({"row of " + std::to_string(balls) + " balls with gaps of 1.5 v h, v" + std::to_string(i + 1),
                     i + 1 < balls ? 0.0 : 1.0, v[static_cast<std::size_t>(i)], 1e-12, i + 1 < balls ? 0.0 : 1.0, 1},
                    GetParam());
  }
}

TEST_P(Impact, TouchingRowBouncesAtTheSameTime) {
  const std::vector<double> v = row_after(GetParam(), 3, 0, 0.5e-3, 3);
  const double wanted[] = {-1.0 / 3, 2.0 / 3, 2.0 / 3};
  for (std::size_t i = 0; i < 3; ++i)
    expect_answer({"three balls, two of them touching, v" + std::to_string(i + 1), wanted[i], v[i], 1e-11}, GetParam());
}

/// What Newton's law of restitution with Coulomb friction gives for one plane contact.
struct NewtonImpact {
  double gain = 0;  ///< of energy
  int solutions = 0;
};

/// `nn`, `nt`, `tt`: the 2 x 2 matrix of the contact (normal, sliding); `un`, `ut`: relative velocity before.
NewtonImpact newton_impact(double nn, double nt, double tt, double un, double ut, double e, double mu) {
  NewtonImpact result;
  const double rn = -(1 + e) * un;
  const auto add = [&](double gn, double gt) {
    result.gain = 0.5 * (gn * (2 * un + nn * gn + nt * gt) + gt * (2 * ut + nt * gn + tt * gt));
    ++result.solutions;
  };
  // Sticking: W g = (rn, -ut).
  const double det = nn * tt - nt * nt, gn = (rn * tt + ut * nt) / det, gt = (-ut * nn - rn * nt) / det;
  if (std::abs(gt) <= mu * gn) add(gn, gt);
  for (const double side : {-1.0, 1.0}) {
    const double n = rn / (nn - side * mu * nt), after = ut + nt * n - side * mu * tt * n;
    if (n > 0 && side * after > 0) add(n, -side * mu * n);
  }
  return result;
}

struct RodImpact {
  double before = 0, after = 0;  ///< kinetic energy
  NewtonImpact newton;
};

/// A rod (capsule) that hits a rough floor with one end, turning. nullopt: it does not approach.
std::optional<RodImpact> rod_impact(const std::string& backend, Random& random) {
  const double radius = 0.02, length = 0.4, h = 1e-9;
  const double e = random.uniform(0.2, 1), mu = random.uniform(0, 1.5), angle = random.uniform(0.1, 1.4);
  const Quat pose = turn(-angle, Vec3::UnitY());
  const Start start{.position = {0, 0, radius},
                    .velocity = {random.uniform(-2, 2), 0, -1},
                    .angular_velocity = {0, random.uniform(-3, 3), 0},
                    .orientation = pose};
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = mu, .restitution = e})
                          .gravity(Vec3::Zero())
                          .floor("m")
                          .body("m", shape_of("rod", RoundCone{radius, radius, length}), start)
                          .build();
  Simulation s(backend, model, precise(h));
  const Body& body = model.bodies[1];
  const Vec3 arm = pose * Vec3(-0.5 * length, 0, 0) - radius * Vec3::UnitZ(), u = s.velocity(1) + s.spin(1).cross(arm);
  if (u.z() >= -0.05) return std::nullopt;
  const double across = body.inertia.maxCoeff();
  RodImpact impact;
  impact.before = kinetic_energy(s);
  impact.newton = newton_impact(1 / body.mass + arm.x() * arm.x() / across, -arm.x() * arm.z() / across,
                                1 / body.mass + arm.z() * arm.z() / across, u.z(), u.x(), e, mu);
  s.run(2);
  impact.after = kinetic_energy(s);
  return impact;
}

TEST_P(Impact, NoImpactOfARodGainsEnergy) {
  // Kane and Levinson's example: Newton's law gains energy where the end slides one way and leaves the other.
  Random random(11, 0);
  int impacts = 0, gaining = 0, compared = 0;
  double most = 0, worst = -1, off = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const auto rod = rod_impact(GetParam(), random);
    if (!rod) continue;
    ++impacts;
    const double gain = rod->newton.gain / rod->before, change = rod->after / rod->before - 1;
    gaining += gain > 1e-6;
    most = std::max(most, gain);
    worst = std::max(worst, change);
    if (gain > -1e-6 || rod->newton.solutions != 1) continue;
    ++compared;
    off = std::max(off, std::abs(change - gain));
  }
  note("rods on a rough floor: impacts", impacts);
  note("of them, Newton's law gains energy in", gaining);
  note("largest gain of Newton's law / energy before", most);
  EXPECT_GT(gaining, 10);
  expect_answer({"largest gain here / energy before", 0, std::max(worst, 0.0), 1e-12, 0, 1}, GetParam());
  note("of them, Newton's law is unique and loses energy in", compared);
  EXPECT_GT(compared, 500);
  expect_answer({"largest difference from it there / energy before", 0, off, 1e-11, 0, 1}, GetParam());
}

TEST_P(Impact, ContactsNeverDoPositiveWork) {
  // A heap of grains thrown together, with friction of every kind and restitution.
  for (const double e : {0.0, 0.5, 1.0}) {
    const PairLaw law{.friction = 0.6, .rolling_friction = 0.05, .spinning_friction = 0.05, .restitution = e};
    Random random(5, 0);
    ModelBuilder builder;
    builder.material("m").law("m", "m", law).floor("m");
    const Shape twin = make_shape("twin", {Part{Sphere{0.009}, {{-0.005, 0, 0}, Quat::Identity()}},
                                           Part{Sphere{0.009}, {{0.005, 0, 0}, Quat::Identity()}}});
    for (int i = 0; i < 60; ++i) {
      const Vec3 at(0.03 * (i % 4) - 0.05, 0.03 * (i / 4 % 4) - 0.05, 0.02 + 0.03 * (i / 16));
      const Start start{
          .position = at,
          .velocity = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), -1) - 10 * Vec3(at.x(), at.y(), 0),
          .orientation = random.rotation()};
      if (i % 3 == 0) {
        builder.body("m", twin, start);
      } else {
        builder.sphere("m", 0.012, start);
      }
    }
    const Model model = builder.build();
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, usual(1e-3, 1e-6));
    const double scale = kinetic_energy(s);
    double worst = -1, total = 0;
    int contacts = 0;
    s.run(600, [&](const Simulation& now) {
      worst = std::max(worst, now.report().contact_work / scale);
      total += now.report().contact_work;
      contacts = std::max(contacts, now.report().contacts);
    });
    const std::string name = "random pile, e = " + std::to_string(e).substr(0, 3);
    note(name + ", most contacts", contacts);
    note(name + ", work of all contacts / first energy", total / scale);
    expect_answer({name + ", largest work of one step / first energy", 0, std::max(worst, 0.0), 1e-6, 0, 1},
                  GetParam());
  }
}

/// A ball that met a wall without rebound slides down it, spinning, and nothing presses it on: what is left of the contact problem is rounding, and the
/// solver must not take it for an error and fall back on a law that throws sliding contacts apart.
TEST(ImpactOfDvi, NothingPushesWhatSlidesWithoutPressure) {
  for (const Integration integration : {Integration::symplectic_euler, Integration::second_order}) {
    double worst = 0, converged = 1;
    for (int k = 0; k < 100; ++k) {
      SolverOptions options = usual(1e-3);
      options.integration = integration;
      Simulation s("dvi",
                   ModelBuilder()
                       .material("m")
                       .law("m", "m", {.friction = 0.6})
                       .floor("m", -Vec3::UnitX(), {0.1, 0, 0})
                       .sphere("m", 0.02, {.position = {0.05 - 1e-5 * k, 0, 0}, .velocity = {1, 0.13, 0.07}, .angular_velocity = {30, 100, 20}})
                       .build(),
                   options);
      s.run(100, [&](const Simulation& now) { converged = now.report().converged ? converged : 0; });
      worst = std::max(worst, std::abs(s.velocity(1).x()));
    }
    const std::string name = integration == Integration::second_order ? "second order" : "symplectic Euler";
    expect_answer({name + ", spinning ball that slides down a wall, worst of 100, speed away from it [m/s]", 0, worst, 1e-6, NAN, 1});
    EXPECT_EQ(converged, 1) << name;
  }
}

}  // namespace
}  // namespace repose::test
