#include "backends/dvi/cone.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace repose::dvi {
namespace {

using Point = std::array<double, 6>;  // p, t1, t2, r1, r2, s
struct Cone {
  double mu, rho, sigma;
};

Point projected(Point x, const Cone& k) {
  project_on_cone(x[0], x[1], x[2], x[3], x[4], x[5], k.mu, k.rho, k.sigma);
  return x;
}

double distance(const Point& a, const Point& b) {
  double s = 0;
  for (std::size_t i = 0; i < 6; ++i) s += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(s);
}

/// Slow oracle: golden section on the one variable, without derivatives.
Point oracle(const Point& x, const Cone& k) {
  const double t = std::hypot(x[1], x[2]), r = std::hypot(x[3], x[4]), s = std::abs(x[5]);
  const auto f = [&](double p) {
    const auto part = [&](double d, double mu) { return std::pow(std::max(0.0, d - mu * p), 2); };
    return std::pow(p - x[0], 2) + part(t, k.mu) + part(r, k.rho) + part(s, k.sigma);
  };
  double low = 0, high = std::abs(x[0]) + k.mu * t + k.rho * r + k.sigma * s + 1;
  for (int i = 0; i < 200; ++i) {
    const double a = low + 0.381966011250105 * (high - low), b = high - 0.381966011250105 * (high - low);
    (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
  }
  const double p = 0.5 * (low + high);
  const auto cut = [&](double d, double mu) { return d > mu * p ? mu * p / d : 1.0; };
  return {p, x[1] * cut(t, k.mu), x[2] * cut(t, k.mu), x[3] * cut(r, k.rho), x[4] * cut(r, k.rho), x[5] * cut(s, k.sigma)};
}

TEST(Cone, ProjectionIsTheNearestPoint) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> u(-1, 1), scale(-3, 3);
  for (int i = 0; i < 20000; ++i) {
    Point x;
    const double size = std::pow(10.0, scale(random));
    for (double& c : x) c = size * u(random);
    const Cone k{std::abs(u(random)) * 1.5, std::abs(u(random)) * 0.5, i % 3 == 0 ? 0.0 : std::abs(u(random))};
    const Point fast = projected(x, k), slow = oracle(x, k);
    // The oracle's golden section finds the minimiser to the root of rounding.
    EXPECT_LE(distance(fast, slow), 1e-7 * size) << i;
    EXPECT_LE(distance(x, fast), distance(x, slow) * (1 + 1e-12)) << i;
  }
}

TEST(Cone, ProjectionLeavesTheConeAlone) {
  const Cone k{0.5, 0.1, 0.05};
  const Point inside{1, 0.3, 0.4 - 1e-12, 0.06, -0.08 + 1e-12, -0.05};
  EXPECT_LE(distance(projected(inside, k), inside), 1e-15);
}

TEST(Cone, ProjectionOfThePolarConeIsTheApex) {
  // |.| <= mu etc. with p = -(mu |t| + rho |r| + sigma |s|) is the edge of the polar cone.
  const Cone k{0.5, 0.1, 0.05};
  const Point x{-(0.5 * 5 + 0.1 * 10 + 0.05 * 2) - 1e-9, 3, 4, 6, -8, 2};
  EXPECT_LE(distance(projected(x, k), Point{}), 1e-15);
}

TEST(Cone, WithoutRotationIsTheClosedFormOfASecondOrderCone) {
  const double mu = 0.6, p = 0.2, t = 1.0;
  const Point x = projected({p, t, 0, 0, 0, 0}, {mu, 0, 0});
  const double expected = (p + mu * t) / (1 + mu * mu);
  EXPECT_NEAR(x[0], expected, 1e-15);
  EXPECT_NEAR(x[1], mu * expected, 1e-15);
}

TEST(Cone, LanesAgreeWithScalars) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(-1, 1);
  Lanes<double> x[6], mu{}, rho{}, sigma{};
  constexpr int lanes = lane_count<double>;
  Point points[lanes];
  Cone cones[lanes];
  for (int l = 0; l < lanes; ++l) {
    cones[l] = {std::abs(u(random)), std::abs(u(random)), std::abs(u(random))};
    mu[l] = cones[l].mu;
    rho[l] = cones[l].rho;
    sigma[l] = cones[l].sigma;
    for (std::size_t k = 0; k < 6; ++k) x[k][l] = points[l][k] = u(random);
  }
  project_on_cone(x[0], x[1], x[2], x[3], x[4], x[5], mu, rho, sigma);
  for (int l = 0; l < lanes; ++l) {
    const Point expected = projected(points[l], cones[l]);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(x[k][l], expected[k], 1e-14);
  }
}

}  // namespace
}  // namespace repose::dvi
