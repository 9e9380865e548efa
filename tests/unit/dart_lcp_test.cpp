/// DART's complementarity problem: bounds that hang on other unknowns, and the law of one contact.
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "backends/dart/boxed_lcp.hpp"
#include "backends/dart/lcp_solver.hpp"
#include "core/random.hpp"

namespace repose::dart {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(DartLcp, FrictionThatPressesBackIsTakenIntoAccount) {
  // One contact whose friction lifts: x_n + k x_t = 1 and x_t = mu x_n, so x_n = 1 / (1 + k mu). Bounds from the
  // problem without friction would give x_t = mu.
  const double k = 0.6, mu = 0.8;
  const std::vector<double> a{1, k, 0, 0, k, 1, 0, 0}, b{1, 5}, lo{0, -mu}, hi{infinity, mu};
  const std::vector<int> parent{-1, 0};
  const BoxedLcp problem{2, 4, a, b, lo, hi, parent};
  std::vector<double> x(2);
  const LcpReport report = solve(problem, 1e-13, 60, x);
  EXPECT_TRUE(report.converged);
  EXPECT_FALSE(report.swept);
  EXPECT_NEAR(x[0], 1 / (1 + k * mu), 1e-12);
  EXPECT_NEAR(x[1], mu / (1 + k * mu), 1e-12);
}

TEST(DartLcp, RandomProblemsAreSolved) {
  Random random(3, 0);
  for (int trial = 0; trial < 50; ++trial) {
    const int contacts = 4 + trial % 8, n = 3 * contacts, stride = ((n - 1) | 3) + 1;
    std::vector<double> jacobian(static_cast<std::size_t>(n * n)), a(static_cast<std::size_t>(n * stride)), b, lo, hi;
    for (double& entry : jacobian) entry = random.uniform(-1, 1);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        double sum = i == j ? 0.1 : 0.0;
        for (int l = 0; l < n; ++l)
          sum += jacobian[static_cast<std::size_t>(i * n + l)] * jacobian[static_cast<std::size_t>(j * n + l)];
        a[static_cast<std::size_t>(i * stride + j)] = sum;
      }
    std::vector<int> parent;
    for (int i = 0; i < n; ++i) {
      const bool normal = i % 3 == 0;
      b.push_back(random.uniform(-1, 1));
      lo.push_back(normal ? 0 : -0.3);
      hi.push_back(normal ? infinity : 0.3);
      parent.push_back(normal ? -1 : i - i % 3);
    }
    const BoxedLcp problem{n, stride, a, b, lo, hi, parent};
    std::vector<double> x(static_cast<std::size_t>(n));
    const LcpReport report = solve(problem, 1e-10, 60, x);
    EXPECT_TRUE(report.converged) << trial;
    EXPECT_EQ(report.residual, residual(problem, x));
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (parent[at] < 0)
        EXPECT_GE(x[at], 0);
      else
        EXPECT_LE(std::abs(x[at]), 0.3 * x[static_cast<std::size_t>(parent[at])] + 1e-9);
    }
  }
}

TEST(DartLcp, TheResidualSeesAWrongAnswer) {
  const std::vector<double> a{2, 0, 0, 0}, b{1}, lo{0}, hi{infinity};
  const std::vector<int> parent{-1};
  const BoxedLcp problem{1, 1, a, b, lo, hi, parent};
  EXPECT_EQ(residual(problem, std::vector<double>{0.5}), 0);
  EXPECT_EQ(residual(problem, std::vector<double>{0.0}), 1);
  EXPECT_NEAR(residual(problem, std::vector<double>{1.0}), 0.5, 1e-15);
}

/// One body of unit mass and inertia 0.4 that touches a fixed one from above, its centre `arm` over the contact.
dvi::ConeProblem one_contact(const Vec3& velocity, const Vec3& spin, double arm) {
  dvi::ConeProblem problem;
  problem.dynamic_bodies = 1;
  problem.inverse_mass = {{1, {2.5, 0, 0, 2.5, 0, 2.5}}, {}};
  problem.velocity = {velocity, Vec3::Zero()};
  problem.angular_velocity = {spin, Vec3::Zero()};
  dvi::ConeContact c;
  c.a = 1;
  c.b = 0;
  c.arm_b = {0, 0, -arm};
  problem.contacts = {c};
  return problem;
}

struct Solved {
  Vec3 velocity, spin, force, couple;
};
Solved solve_one(const dvi::ConeProblem& problem) {
  LcpSolver solver(1);
  std::vector<ContactImpulse> impulse;
  std::vector<Vec3> velocity, spin;
  EXPECT_TRUE(solver.solve(problem, 1e-12, 60, impulse, velocity, spin).converged);
  return {velocity[0], spin[0], impulse[0].force, impulse[0].couple};
}

TEST(DartLcp, SlidingFrictionOpposesTheSlipInAnyDirection) {
  for (const double angle : {0.0, 0.3, M_PI / 4, 2.0, 4.0}) {
    const Vec3 along(std::cos(angle), std::sin(angle), 0);
    dvi::ConeProblem problem = one_contact(3 * along - Vec3::UnitZ(), Vec3::Zero(), 0);
    problem.contacts[0].friction = 0.5;
    const Solved s = solve_one(problem);
    EXPECT_NEAR((s.force - (Vec3::UnitZ() - 0.5 * along)).norm(), 0, 1e-8) << angle;
    EXPECT_NEAR((s.velocity - 2.5 * along).norm(), 0, 1e-8) << angle;
  }
}

TEST(DartLcp, RollingAndSpinningMomentsAreBoundedByTheArm) {
  dvi::ConeProblem problem = one_contact(-Vec3::UnitZ(), {0, 4, 9}, 0);
  problem.contacts[0].arm = 0.5;
  problem.contacts[0].rolling = 0.2;
  problem.contacts[0].spinning = 0.1;
  const Solved s = solve_one(problem);
  EXPECT_NEAR((s.couple - Vec3(0, -0.1, -0.05)).norm(), 0, 1e-8);
  EXPECT_NEAR((s.spin - Vec3(0, 3.75, 8.875)).norm(), 0, 1e-8);
}

TEST(DartLcp, CohesionHoldsWhatItCanAndRubsAsIfItPressed) {
  dvi::ConeProblem problem = one_contact({0.3, 0, 0.4}, Vec3::Zero(), 0);
  problem.contacts[0].friction = 0.5;
  problem.contacts[0].cohesion = 1;
  Solved s = solve_one(problem);
  EXPECT_NEAR((s.force - Vec3(-0.3, 0, -0.4)).norm(), 0, 1e-8);  // 0.3 is not more than 0.5 * (1 - 0.4)
  problem.velocity[0] = {0.3, 0, 1.5};
  s = solve_one(problem);
  EXPECT_NEAR((s.force - Vec3(0, 0, -1)).norm(), 0, 1e-8);
  EXPECT_NEAR(s.velocity.z(), 0.5, 1e-8);
}

}  // namespace
}  // namespace repose::dart
