/// Friction that depends on speed or direction, restitution that depends on speed.
#include <algorithm>
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class FrictionLaws : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(FrictionLaws);

constexpr double g = 9.81;

/// A flat block on the floor; gravity is tilted about y by `angle` instead of the floor, and turned about z by
/// `azimuth`.
Model block(const ContactEffect& effect, double friction, double angle, const Vec3& velocity = Vec3::Zero(),
            double azimuth = 0) {
  Model model =
      ModelBuilder()
          .material("m")
          .law("m", "m", {.friction = friction})
          .gravity(g * Vec3(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), -std::cos(angle)))
          .floor("m")
          .box("m", {0.1, 0.1, 0.01}, {.position = {0, 0, 0.01}, .velocity = velocity})
          .build();
  model.contact_effects = {effect};
  return model;
}

/// dv/dt = g (sin a - cos a (mu + slope ln(v / ref))) by Runge and Kutta's fourth order in fine steps.
double reference_speed_after(double t, double v, double angle, double mu, const RateDependentFriction& law) {
  const int n = 20000;
  const double h = t / n;
  const auto f = [&](double s) {
    return g * (std::sin(angle) - std::cos(angle) * (mu + law.slope * std::log(s / law.reference_speed)));
  };
  for (int i = 0; i < n; ++i) {
    const double a = f(v), b = f(v + 0.5 * h * a), c = f(v + 0.5 * h * b), d = f(v + h * c);
    v += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return v;
}

TEST_P(FrictionLaws, ASlidingBlockFollowsItsRateDependentFriction) {
  for (const double slope : {0.05, -0.05}) {
    const RateDependentFriction law{slope, 0.5};
    const double exact = reference_speed_after(0.3, 2, 0, 0.4, law);
    double error[2] = {0, 0};
    for (const int k : {0, 1}) {
      const double h = k == 0 ? 1e-3 : 5e-4;
      const Model model = block(law, 0.4, 0, {2, 0, 0});
      REPOSE_SKIP_UNSUPPORTED(model);
      auto s = simulation(model, precise(h));
      s.run(static_cast<int>(std::lround(0.3 / h)));
      // The discrete recursion: friction of the speed at the end of the step if it rises, at the start if it falls.
      double v = 2;
      for (int i = 0; i < static_cast<int>(std::lround(0.3 / h)); ++i) {
        double end = v;
        for (int newton = 0; slope > 0 && newton < 50; ++newton)
          end -= (end - v + h * g * (0.4 + slope * std::log(end / 0.5))) / (1 + h * g * slope / end);
        v = slope > 0 ? end : v - h * g * (0.4 + slope * std::log(v / 0.5));
      }
      const std::string name = "rate-dependent friction, slope " + std::to_string(slope).substr(0, 5) +
                               ", h = " + std::to_string(h).substr(0, 6) + ", speed [m/s]";
      expect_answer({name, exact, s.velocity(1).x(), 1e-10, v}, GetParam());
      error[k] = std::abs(s.velocity(1).x() - exact);
    }
    expect_answer({"rate-dependent friction, slope " + std::to_string(slope).substr(0, 5) + ", error at h / at h/2", 2,
                   error[0] / error[1], 0.05},
                  GetParam());
  }
}

TEST_P(FrictionLaws, CreepOnAnInclineIsSteadyAtAnyStep) {
  // v = ref exp((tan a - mu) / slope): where friction balances the slope, whatever the step.
  const RateDependentFriction law{0.05, 0.5};
  const double angle = 0.2, mu = 0.5, creep = 0.5 * std::exp((std::tan(angle) - mu) / 0.05);
  for (const double h : {1e-4, 1e-2}) {
    const Model model = block(law, mu, angle);
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, precise(h));
    s.run(h < 1e-3 ? 2000 : 20);
    expect_answer({"creep on an incline, h = " + std::to_string(h).substr(0, 6) + ", speed [m/s]", creep,
                   s.velocity(1).x(), 1e-8},
                  GetParam());
  }
}

TEST_P(FrictionLaws, AnisotropicBlockRestsUpToItsOwnAngles) {
  // Along the direction up to tan a = mu, across it up to ratio mu.
  const double mu = 0.4, ratio = 0.5;
  for (const double azimuth : {0.0, M_PI / 2}) {
    const double limit = std::atan(azimuth == 0 ? mu : ratio * mu);
    for (const double share : {0.99, 1.01}) {
      const Model model = block(AnisotropicFriction{ratio, 30}, mu, share * limit, Vec3::Zero(), azimuth + M_PI / 6);
      REPOSE_SKIP_UNSUPPORTED(model);
      auto s = simulation(model, precise(1e-3));
      s.run(200);
      const double a = g * (std::sin(share * limit) - std::cos(share * limit) * std::tan(limit));
      expect_answer({std::string("anisotropic friction, ") + (azimuth == 0 ? "along" : "across") + " at " +
                         std::to_string(share).substr(0, 4) + " of the limit, speed [m/s]",
                     std::max(0.0, 0.2 * a), s.velocity(1).norm(), 1e-9, std::max(0.0, 0.2 * a), g * 0.2},
                    GetParam());
    }
  }
}

TEST_P(FrictionLaws, AnisotropicBlockSlidesAtItsOwnAngle) {
  // From rest the path is straight at the angle b to the direction at which driving force, friction and path fit:
  // g (sin a cos c, sin a sin c) - g cos a mu (cos b, r^2 sin b) / |(cos b, r sin b)|  is parallel to (cos b, sin b).
  const double mu = 0.3, r = 0.4, angle = 0.5, c = 0.9;
  const auto force = [&](double b) {
    const double n = std::hypot(std::cos(b), r * std::sin(b));
    return Vec2(g * std::sin(angle) * std::cos(c) - g * std::cos(angle) * mu * std::cos(b) / n,
                g * std::sin(angle) * std::sin(c) - g * std::cos(angle) * mu * r * r * std::sin(b) / n);
  };
  double low = c, high = M_PI / 2;
  for (int i = 0; i < 200; ++i) {
    const double b = 0.5 * (low + high);
    const Vec2 f = force(b);
    (f.x() * std::sin(b) - f.y() * std::cos(b) < 0 ? low : high) = b;
  }
  for (const double direction_deg : {0.0, 65.0}) {
    const double turn_by = direction_deg * M_PI / 180;
    const Model model = block(AnisotropicFriction{r, direction_deg}, mu, angle, Vec3::Zero(), c + turn_by);
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, precise(1e-3));
    s.run(300);
    const std::string name = "anisotropic friction along " + std::to_string(direction_deg).substr(0, 2) + " deg, ";
    expect_answer(
        {name + "angle of the path [rad]", low + turn_by, std::atan2(s.velocity(1).y(), s.velocity(1).x()), 1e-9},
        GetParam());
    expect_answer({name + "speed after 0.3 s [m/s]", 0.3 * force(low).norm(), s.velocity(1).norm(), 1e-9}, GetParam());
  }
}

TEST_P(FrictionLaws, FastImpactsBounceLess) {
  const RateDependentRestitution law{0.25, 0.5};
  for (const double speed : {0.05, 0.5, 4.0}) {
    Model model = ModelBuilder()
                      .material("m")
                      .law("m", "m", {.restitution = 0.7})
                      .gravity(Vec3::Zero())
                      .floor("m")
                      .sphere("m", 0.05, {.position = {0, 0, 0.0501}, .velocity = {0, 0, -speed}})
                      .build();
    model.contact_effects = {law};
    REPOSE_SKIP_UNSUPPORTED(model);
    auto s = simulation(model, precise(1e-3));
    s.run(20);
    const double e = std::min(1.0, 0.7 * std::pow(speed / 0.5, -0.25));
    expect_answer({"rate-dependent restitution at " + std::to_string(speed).substr(0, 4) + " m/s, e", e,
                   s.velocity(1).z() / speed, 1e-12},
                  GetParam());
  }
}

}  // namespace
}  // namespace repose::test
