/// Spheres on a level plane: from sliding to rolling, and what rolling and spinning friction do.
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Rolling : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Rolling);

constexpr double g = 9.81, h = 1e-3, radius = 0.1;

Model sphere(const PairLaw& law, const Vec3& velocity, const Vec3& spin) {
  return ModelBuilder()
      .material("ball")
      .material("plane")
      .law("ball", "plane", law)
      .floor("plane")
      .sphere("ball", radius, {.position = {0, 0, radius}, .velocity = velocity, .angular_velocity = spin})
      .build();
}

TEST_P(Rolling, SlidingSphereEndsRollingAtFiveSevenths) {
  const double mu = 0.3, v0 = 2, until = 2 * v0 / (7 * mu * g);
  auto s = simulation(sphere({.friction = mu}, {v0, 0, 0}, Vec3::Zero()), precise(h));
  int slipping = 0;
  double worst = 0;
  s.run(400, [&](const Simulation& now) {
    const double slip = now.velocity(1).x() - radius * now.spin(1).y();
    if (slip > 1e-9 * v0) {
      ++slipping;
      worst = std::max(worst, std::abs(now.velocity(1).x() - (v0 - mu * g * h * slipping)));
    }
  });
  expect_answer({"sliding sphere, worst speed error while it slips / v0", 0, worst / v0, 1e-11, 0, 1}, GetParam());
  // The last step of slip is the last whole one before 2 v0 / (7 mu g).
  expect_answer({"sliding sphere, slips for [s]", until, slipping * h, 1e-12, h * std::floor(until / h)}, GetParam());
  expect_answer({"sliding sphere, final v / v0", 5.0 / 7, s.velocity(1).x() / v0, 1e-11}, GetParam());
  expect_answer({"sliding sphere, final R omega / v0", 5.0 / 7, radius * s.spin(1).y() / v0, 1e-11}, GetParam());
}

TEST_P(Rolling, RollingFrictionSlowsAndThenHolds) {
  const double arm = 0.02 * radius, v0 = 0.5, a = 5.0 / 7 * g * arm / radius;
  for (const bool as_length : {false, true}) {
    PairLaw law{.friction = 0.5};
    (as_length ? law.rolling_friction_length : law.rolling_friction) = as_length ? arm : 0.02;
    const Model model = sphere(law, {v0, 0, 0}, {0, v0 / radius, 0});
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, precise(h));
    s.run(1000);
    const std::string name = as_length ? ", arm in metres" : ", arm = rho R*";
    expect_answer({"rolling resistance, deceleration" + name + " [m/s^2]", a, v0 - s.velocity(1).x(), 1e-11},
                  GetParam());
    expect_answer({"rolling resistance, R omega / v" + name, 1, radius * s.spin(1).y() / s.velocity(1).x(), 1e-11},
                  GetParam());
    s.run(static_cast<int>(v0 / a / h) - 1000 + 10);
    expect_answer(
        {"rolling resistance, speed after it has stopped / v0" + name, 0, s.velocity(1).norm() / v0, 1e-11, 0, 1},
        GetParam());
  }
}

TEST_P(Rolling, SpinningFrictionSlowsAndThenHolds) {
  const double sigma = 0.01, arm = sigma * radius, w0 = 8, a = 2.5 * arm * g / (radius * radius);
  const Model model = sphere({.friction = 0.5, .spinning_friction = sigma}, Vec3::Zero(), {0, 0, w0});
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, precise(h));
  s.run(1000);
  expect_answer({"spinning resistance, deceleration [rad/s^2]", a, w0 - s.spin(1).z(), 1e-11}, GetParam());
  expect_answer({"spinning resistance, speed of the centre / R w0", 0, s.velocity(1).norm() / (radius * w0), 1e-11, 0, 1},
                GetParam());
  s.run(static_cast<int>(w0 / a / h) - 1000 + 10);
  expect_answer({"spinning resistance, spin after it has stopped / w0", 0, s.spin(1).norm() / w0, 1e-11, 0, 1},
                GetParam());
}

TEST_P(Rolling, WithoutSpinningFrictionASpherePivotsForEver) {
  const Model model = sphere({.friction = 0.5, .rolling_friction = 0.1}, Vec3::Zero(), {0, 0, 5});
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, precise(h));
  s.run(500);
  expect_answer({"spin without spinning friction after 0.5 s [rad/s]", 5, s.spin(1).z(), 1e-12}, GetParam());
}

}  // namespace
}  // namespace repose::test
