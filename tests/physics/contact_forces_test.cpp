/// Liquid bridges, and contacts that give way.
#include <algorithm>
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class ContactForces : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(ContactForces);

constexpr double g = 9.81, radius = 0.01;
const double mass = 1000 * 4.0 / 3.0 * M_PI * radius * radius * radius;

/// Balls in touch that hang under a plate, one under the other.
Model chain(int balls, const ContactEffect& effect) {
  ModelBuilder builder;
  builder.material("m").floor("m", -Vec3::UnitZ());
  for (int i = 0; i < balls; ++i) builder.sphere("m", radius, {.position = {0, 0, -radius - 2 * radius * i}});
  Model model = builder.build();
  model.contact_effects = {effect};
  return model;
}

TEST_P(ContactForces, ALiquidBridgeHoldsItsForceAndNoMore) {
  const int n = 3;
  for (const double share : {1.001, 0.999}) {
    const Model model = chain(n, LiquidBridge{share * n * mass * g, 1e-3});
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, precise(1e-3));
    s.run(300);
    if (share > 1) {
      expect_answer({"chain of 3 on liquid bridges of 1.001 times its weight: fall / R", 0,
                     std::abs(s.position(1).z() + radius) / radius, 1e-9, 0, 1},
                    GetParam());
      expect_answer({"the same: force at the top [N]", n * mass * g, -s.force_on(0).z(), 1e-9}, GetParam());
    } else {
      expect_that("chain of 3 on liquid bridges of 0.999 times its weight falls", s.position(1).z() < -1.5 * radius,
                  GetParam());
    }
  }
}

TEST_P(ContactForces, ALiquidBridgeFallsLinearlyAndRuptures) {
  const double force = 5 * mass * g, rupture = 2e-3, speed = 0.01, h = 1e-4;
  // A ball on the floor, fixed; a plate above it moves up slowly, and the work on it is the force times its way.
  Motion up;
  up.velocity = {0, 0, speed};
  Model model =
      ModelBuilder()
          .material("m")
          .gravity(Vec3::Zero())
          .wall("m", shape_of("plate", Box{{0.1, 0.1, 0.01}}), {{0, 0, -0.01}, Quat::Identity()})
          .wall("m", shape_of("plate", Box{{0.1, 0.1, 0.01}}), {{0, 0, 2 * radius + 0.01}, Quat::Identity()}, up)
          .sphere("m", radius, {.position = {0, 0, radius}})
          .mass(1e3)
          .build();
  model.contact_effects = {LiquidBridge{force, rupture}};
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, precise(h));
  double work = 0, worst = 0;
  s.run(static_cast<int>(std::lround(1.2 * rupture / (speed * h))), [&](const Simulation& now) {
    const double pull = -now.force_on(1, 2).z();
    const double gap = (now.state().time - h) * speed;  // at the start of the step; the ball is too heavy to move
    worst = std::max(worst, std::abs(pull - force * std::max(0.0, 1 - gap / rupture)) / force);
    work += pull * speed * h;
  });
  expect_answer({"liquid bridge: worst difference from force (1 - gap / rupture)", 0, worst, 1e-3, 0, 1}, GetParam());
  expect_answer({"liquid bridge: work of a slow pull [J]", 0.5 * force * rupture, work, 2e-3}, GetParam());
}

Model drop(const ContactCompliance& law, double speed, double gravity, double restitution = 0) {
  Model model = ModelBuilder()
                    .material("m")
                    .law("m", "m", {.restitution = restitution})
                    .gravity({0, 0, -gravity})
                    .floor("m")
                    .sphere("m", radius, {.position = {0, 0, radius}, .velocity = {0, 0, -speed}})
                    .build();
  model.contact_effects = {law};
  return model;
}

TEST_P(ContactForces, ACompliantContactSagsByItsWeightAtAnyStep) {
  const double k = mass * g / (0.01 * radius);
  for (const double h : {1e-4, 1e-3, 1e-1}) {
    const Model model = drop({k, 0.5 * std::sqrt(k * mass)}, 0, g);
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, precise(h));
    s.run(std::max(200, static_cast<int>(0.4 / h)));
    expect_answer({"compliant contact, h = " + std::to_string(h).substr(0, 6) + ", sag / R", 0.01,
                   (radius - s.position(1).z()) / radius, 1e-9},
                  GetParam());
  }
}

TEST_P(ContactForces, ACompliantContactReboundsLikeItsOscillator) {
  const double k = 1000, omega = std::sqrt(k / mass), speed = 0.1;
  for (const double zeta : {0.0, 0.1, 0.4}) {
    // A contact cannot pull: it ends when spring and damper balance (Schwager & Poschel 2007).
    const double root = std::sqrt(1 - zeta * zeta);
    const double phase = M_PI - std::atan2(2 * zeta * root, 1 - 2 * zeta * zeta);
    const double e = std::exp(-zeta / root * phase), time = phase / (omega * root);
    double error[2] = {0, 0};
    for (const int i : {0, 1}) {
      const double h = (i == 0 ? 0.01 : 0.005) / omega;
      const Model model = drop({k, 2 * zeta * std::sqrt(k * mass)}, speed, 0, 0.3);
      REPOSE_SKIP_UNSUPPORTED(model);
      auto s = simulation(model, precise(h));
      int touching = 0;
      s.run(static_cast<int>(std::lround(1.5 * M_PI / (omega * h))), [&](const Simulation& now) {
        if (now.force_on(1).z() > 0) ++touching;
      });
      const std::string name = "compliant impact, zeta = " + std::to_string(zeta).substr(0, 3) +
                               ", h omega = " + std::to_string(h * omega).substr(0, 5);
      expect_answer({name + ": restitution", e, s.velocity(1).z() / speed, 0.01}, GetParam());
      expect_answer({name + ": duration / (pi sqrt(m/k))", time * omega / M_PI, touching * h * omega / M_PI, 0.01},
                    GetParam());
      error[i] = std::abs(s.velocity(1).z() / speed - e);
    }
    EXPECT_LE(error[1], 0.6 * error[0] + 1e-6) << "zeta = " << zeta;
  }
}

TEST_P(ContactForces, AStiffContactThatTheStepCannotResolveIsRigid) {
  const Model model = drop({1e9, 0}, 0.5, 0, 0.6);
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, precise(1e-3));
  s.run(5);
  expect_answer({"contact too stiff for the step: restitution of the pair", 0.6, s.velocity(1).z() / 0.5, 1e-9},
                GetParam());
}

TEST_P(ContactForces, APileOfSoftGrainsComesToRest) {
  Model model = pile({.count = 60,
                      .kinds = {"sphere", "twin"},
                      .law = {.friction = 0.5, .rolling_friction = 0.05, .spinning_friction = 0.05}});
  const double m = model.bodies.back().mass, r = model.bodies.back().radius;
  model.contact_effects = {ContactCompliance{2e3 * m * g / r, 2 * std::sqrt(2e3 * m * m * g / r)}};
  REPOSE_SKIP_UNSUPPORTED(model);
  for (const double h : {1e-3, 5e-3}) {
    auto s = simulation(model, usual(h, 1e-6));
    s.run(static_cast<int>(3 / h));
    double fastest = 0;
    // The floor has no friction: what glides there never stops, but nothing rises or sinks.
    for (const Vec3& v : s.state().velocity) fastest = std::max(fastest, std::abs(v.z()));
    expect_answer({"60 soft grains at rest, h = " + std::to_string(h).substr(0, 5) + ": fastest rise or fall / sqrt(g R)", 0,
                   fastest / std::sqrt(g * r), 1e-3, 0, 1},
                  GetParam());
  }
}

}  // namespace
}  // namespace repose::test
