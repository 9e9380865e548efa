/// Bodies that touch nothing: the integrator alone, against its exact discrete sums.
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Flight : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Flight);

constexpr double g = 9.81;

/// n steps of symplectic Euler under a constant acceleration.
Vec3 euler_arc(const Vec3& x, const Vec3& v, const Vec3& a, double h, int n) {
  return x + n * h * v + 0.5 * h * h * n * (n + 1.0) * a;
}
Vec3 arc(const Vec3& x, const Vec3& v, const Vec3& a, double t) { return x + t * v + 0.5 * t * t * a; }

void expect_arc(const std::string& what, const Simulation& s, const Vec3& x, const Vec3& v, const Vec3& a, double h,
                int n, const std::string& backend) {
  const Vec3 discrete = euler_arc(x, v, a, h, n), closed = arc(x, v, a, n * h);
  const double scale = closed.norm();
  for (int k = 0; k < 3; ++k)
    expect_answer({what + ", " + "xyz"[k] + " [m]", closed[k], s.position(0)[k], 1e-12, discrete[k], scale}, backend);
}

TEST_P(Flight, FreeFallIsTheDiscreteSum) {
  const Vec3 x(0.1, -0.2, 5), v(1, 2, 3);
  const double h = 1e-3;
  const int n = 1000;
  auto s =
      simulation(ModelBuilder().material("m").sphere("m", 0.02, {.position = x, .velocity = v}).build(), precise(h));
  s.run(n);
  expect_arc("free fall, 1 s", s, x, v, Vec3(0, 0, -g), h, n, GetParam());
  expect_answer({"free fall, speed after 1 s [m/s]", v.z() - g, s.velocity(0).z(), 1e-12}, GetParam());
}

TEST_P(Flight, UniformForceAcceleratesByMass) {
  const double h = 1e-3, radius = 0.02;
  const Vec3 force(0.01, 0.02, 0.05), x(0, 0, 5), v(0.5, 0, 0);
  const Model model = ModelBuilder()
                          .material("m")
                          .effect(UniformForce{force})
                          .sphere("m", radius, {.position = x, .velocity = v})
                          .build();
  auto s = simulation(model, precise(h));
  s.run(500);
  const double mass = 1000 * 4.0 / 3.0 * M_PI * std::pow(radius, 3);
  expect_arc("uniform force, 0.5 s", s, x, v, Vec3(0, 0, -g) + force / mass, h, 500, GetParam());
}

TEST_P(Flight, TiltTurnsGravity) {
  const double h = 1e-3, ax = 3 * M_PI / 180, ay = -5 * M_PI / 180;
  const Vec3 x(0, 0, 5), v = Vec3::Zero();
  const Model model =
      ModelBuilder().material("m").effect(GravityTilt{3, -5}).sphere("m", 0.02, {.position = x}).build();
  auto s = simulation(model, precise(h));
  s.run(500);
  // Rx(ax) (0, 0, -g) = g (0, sin ax, -cos ax), then turned about y.
  const Vec3 a(-g * std::cos(ax) * std::sin(ay), g * std::sin(ax), -g * std::cos(ax) * std::cos(ay));
  expect_arc("tilted gravity, 0.5 s", s, x, v, a, h, 500, GetParam());
}

TEST_P(Flight, BuoyancyLightens) {
  const double h = 1e-3, fluid = 250;
  const Vec3 x(0, 0, 5), v(0, 1, 0);
  const Model model = ModelBuilder()
                          .material("m")
                          .effect(Buoyancy{fluid})
                          .box("m", {0.01, 0.02, 0.03}, {.position = x, .velocity = v})
                          .build();
  auto s = simulation(model, precise(h));
  s.run(500);
  expect_arc("buoyancy, 0.5 s", s, x, v, Vec3(0, 0, -g * (1 - fluid / 1000)), h, 500, GetParam());
}

TEST_P(Flight, SteadySpinTurnsByTheWholeAngle) {
  const double h = 1e-3, rate = 7;
  const Model model =
      ModelBuilder().material("m").gravity(Vec3::Zero()).sphere("m", 0.1, {.angular_velocity = {0, 0, rate}}).build();
  auto s = simulation(model, precise(h));
  s.run(400);
  const Quat q = s.state().orientation[0];
  expect_answer({"steady spin, angle after 0.4 s [rad]", rate * 0.4, 2 * std::atan2(q.vec().norm(), q.w()), 1e-12},
                GetParam());
}

struct Tumble {
  Vec3 momentum_error;
  double energy_error = 0;
  double momentum = 0;
};

Tumble tumble(const std::string& backend, double h) {
  const Vec3 half(0.1, 0.2, 0.3), rate(0.3, 8, 0.5);  // about the middle axis: it turns over
  const Model model =
      ModelBuilder().material("m").gravity(Vec3::Zero()).box("m", half, {.angular_velocity = rate}).build();
  Simulation s(backend, model, precise(h));
  const auto spin = [&](double& energy) {
    const Mat3 r = s.state().orientation[0].toRotationMatrix();
    const Vec3 w = r.transpose() * s.spin(0);
    energy = 0.5 * w.dot(model.bodies[0].inertia.cwiseProduct(w));
    return Vec3(r * model.bodies[0].inertia.cwiseProduct(w));
  };
  double before = 0, after = 0, worst = 0;
  const Vec3 momentum = spin(before);
  Vec3 error = Vec3::Zero();
  s.run(static_cast<int>(std::lround(2 / h)), [&](const Simulation&) {
    error = error.cwiseMax((spin(after) - momentum).cwiseAbs());
    worst = std::max(worst, std::abs(after - before) / before);
  });
  return {error, worst, momentum.norm()};
}

TEST_P(Flight, TumblingBodyKeepsAngularMomentumAndEnergyToFirstOrder) {
  const Tumble coarse = tumble(GetParam(), 1e-3), fine = tumble(GetParam(), 5e-4);
  // A few roundings per step, 2000 steps.
  expect_answer({"tumbling box, largest change of angular momentum / L", 0,
                 coarse.momentum_error.norm() / coarse.momentum, 2000 * 1e-15, 0, 1},
                GetParam());
  note("tumbling box, largest energy error, h = 1e-3", coarse.energy_error);
  expect_answer({"tumbling box, energy error at h / at h/2", 2, coarse.energy_error / fine.energy_error, 0.1},
                GetParam());
  EXPECT_LT(coarse.energy_error, 0.05);
}

}  // namespace
}  // namespace repose::test
