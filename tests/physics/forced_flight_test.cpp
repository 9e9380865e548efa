/// Bodies that touch nothing but feel a fluid that turns their path, or a frame that shakes.
#include <cmath>
#include <complex>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class ForcedFlight : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(ForcedFlight);

constexpr double g = 9.81;

TEST_P(ForcedFlight, MagnusTurnsThePathOfASpinningBall) {
  // Without gravity, spin across the path: a circle. Its rate is W = lift (rho_f / rho) w.
  const double lift = 0.9, fluid = 1.2, density = 85, spin = 150, speed = 12, t = 1.5;
  const double rate = lift * fluid / density * spin;
  for (const double h : {2e-3, 1e-3}) {
    const Model model = ModelBuilder()
                            .material("m", density)
                            .gravity(Vec3::Zero())
                            .effect(Magnus{lift, fluid})
                            .sphere("m", 0.02, {.velocity = {speed, 0, 0}, .angular_velocity = {0, 0, spin}})
                            .build();
    auto s = simulation(model, precise(h));
    const int n = static_cast<int>(std::lround(t / h));
    s.run(n);
    const double angle = std::atan2(s.velocity(0).y(), s.velocity(0).x());
    const std::string step = ", h = " + std::to_string(h).substr(0, 5);
    const auto wrapped = [](double a) { return std::remainder(a, 2 * M_PI); };
    expect_answer({"Magnus, turn of the path after 1.5 s" + step + " [rad]", wrapped(rate * t), angle, 1e-11,
                   wrapped(n * std::atan(h * rate))},
                  GetParam());
    expect_answer({"Magnus, speed after 1.5 s" + step + " [m/s]", speed, s.velocity(0).norm(), 1e-11,
                   speed * std::pow(1 + h * h * rate * rate, 0.5 * n)},
                  GetParam());
    // x is the sum of all later velocities: a geometric series in the complex plane.
    const std::complex<double> q(1, h * rate);
    const std::complex<double> sum = h * speed * q * (std::pow(q, n) - 1.0) / (q - 1.0);
    const double radius = speed / rate;
    expect_answer({"Magnus, sideways shift after 1.5 s" + step + " [m]", radius * (1 - std::cos(rate * t)),
                   s.position(0).y(), 1e-11, sum.imag(), radius},
                  GetParam());
  }
}

TEST_P(ForcedFlight, MagnusLiftsABallAgainstGravity) {
  // Backspin such that lift and weight cancel: a straight path.
  const double fluid = 1.2, density = 85, speed = 10, lift = 0.5;
  const double spin = g / (lift * fluid / density * speed);
  const Model model = ModelBuilder()
                          .material("m", density)
                          .effect(Magnus{lift, fluid})
                          .sphere("m", 0.02, {.velocity = {speed, 0, 0}, .angular_velocity = {0, -spin, 0}})
                          .build();
  auto s = simulation(model, precise(1e-3));
  s.run(1000);
  expect_answer({"Magnus against gravity, height after 10 m [m]", 0, s.position(0).z(), 1e-11, 0, 1}, GetParam());
  expect_answer({"Magnus against gravity, distance after 1 s [m]", speed, s.position(0).x(), 1e-11}, GetParam());
}

TEST_P(ForcedFlight, APeriodicForceShakesEveryBodyAlike) {
  const double f = 3, phase = 0.7, omega = 2 * M_PI * f, t = 0.8;
  const Vec3 amplitude(2, 0, -5), v(0, 0.3, 4);
  for (const double h : {1e-3, 5e-4}) {
    const Model model = ModelBuilder()
                            .material("light", 100)
                            .material("heavy", 8000)
                            .effect(PeriodicForce{amplitude, f, phase})
                            .sphere("light", 0.02, {.velocity = v})
                            .box("heavy", {0.1, 0.1, 0.2}, {.position = {5, 0, 0}, .velocity = v})
                            .build();
    auto s = simulation(model, precise(h));
    const int n = static_cast<int>(std::lround(t / h));
    s.run(n);
    // Symplectic Euler: the sums of the sine over the steps, and of those sums.
    double velocity = 0, shift = 0;
    for (int k = 0; k < n; ++k) {
      velocity += h * std::sin(omega * k * h + phase);
      shift += h * velocity;
    }
    const double closed_velocity = (std::cos(phase) - std::cos(omega * t + phase)) / omega;
    const double closed_shift = (std::cos(phase) * t - (std::sin(omega * t + phase) - std::sin(phase)) / omega) / omega;
    const std::string step = ", h = " + std::to_string(h).substr(0, 6);
    for (int body = 0; body < 2; ++body) {
      const std::string who = body == 0 ? "light ball" : "heavy box";
      const double x = s.position(body).x() - (body == 0 ? 0 : 5);
      expect_answer({"periodic force, " + who + step + ", shift [m]", amplitude.x() * closed_shift, x, 1e-11,
                     amplitude.x() * shift},
                    GetParam());
      expect_answer(
          {"periodic force, " + who + step + ", vertical speed [m/s]", v.z() - g * t + amplitude.z() * closed_velocity,
           s.velocity(body).z(), 1e-11, v.z() - g * t + amplitude.z() * velocity},
          GetParam());
    }
  }
}

TEST_P(ForcedFlight, AnUprightShakeLiftsABallWhenItExceedsGravity) {
  // On a fixed floor: amplitude below g keeps the load positive, above it the ball leaves.
  for (const double share : {0.98, 1.1}) {
    const Model model = ModelBuilder()
                            .material("m")
                            .floor("m")
                            .effect(PeriodicForce{{0, 0, share * g}, 5, 0})
                            .sphere("m", 0.02, {.position = {0, 0, 0.02}})
                            .build();
    auto s = simulation(model, precise(1e-3));
    double height = 0;
    s.run(400, [&](const Simulation& now) { height = std::max(height, now.position(1).z() - 0.02); });
    if (share < 1) {
      expect_answer({"shake of 0.98 g: highest lift [m]", 0, height, 1e-12, 0, 1}, GetParam());
    } else {
      expect_that("shake of 1.1 g lifts the ball", height > 1e-6, GetParam());
    }
  }
}

}  // namespace
}  // namespace repose::test
