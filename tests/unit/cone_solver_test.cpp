#include "backends/dvi/cone_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "backends/dvi/cone.hpp"
#include "backends/dvi/colouring.hpp"
#include "backends/dvi/impact.hpp"

namespace repose::dvi {
namespace {

/// A heap-like random problem: spheres of unit size on a floor, in layers, pressed down.
ConeProblem random_bed(int side, int layers, unsigned seed, double friction, double rolling) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  ConeProblem problem;
  std::vector<Vec3> x;
  for (int k = 0; k < layers; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) x.push_back(Vec3(2.0 * i + (k % 2), 2.0 * j + (k % 2), 1 + 1.5 * k));
  problem.dynamic_bodies = static_cast<std::int32_t>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double mass = std::exp(0.7 * u(random));
    const double inverse = 2.5 / mass;
    problem.inverse_mass.push_back({1 / mass, {inverse, 0, 0, inverse, 0, inverse}});
    problem.velocity.push_back(Vec3(0.2 * u(random), 0.2 * u(random), -1 + 0.2 * u(random)));
    problem.angular_velocity.push_back(0.2 * Vec3(u(random), u(random), u(random)));
  }
  problem.inverse_mass.push_back({});
  problem.velocity.push_back(Vec3::Zero());
  problem.angular_velocity.push_back(Vec3::Zero());
  const auto add = [&](std::size_t a, std::size_t b, const Vec3& n, const Vec3& arm_a, const Vec3& arm_b) {
    ConeContact c;
    c.a = static_cast<std::int32_t>(a);
    c.b = static_cast<std::int32_t>(b);
    c.normal = n;
    c.arm_a = arm_a;
    c.arm_b = arm_b;
    c.friction = friction;
    c.rolling = c.spinning = rolling;
    c.arm = 0.5;
    c.bias = 0.05 * std::abs(u(random));
    problem.contacts.push_back(c);
  };
  const std::size_t floor = x.size();
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i].z() < 1.1) add(i, floor, -Vec3::UnitZ(), -Vec3::UnitZ(), Vec3(x[i].x(), x[i].y(), 0));
    for (std::size_t j = i + 1; j < x.size(); ++j) {
      const Vec3 d = x[j] - x[i];
      if (d.norm() < 2.2) add(i, j, d.normalized(), 0.5 * d, -0.5 * d);
    }
  }
  return problem;
}

struct Solution {
  SolveReport report;
  std::vector<Impulse> impulse;
  std::vector<Vec3> velocity, angular;
};

Solution solved(const ConeProblem& problem, SolverOptions options) {
  Solution s;
  s.impulse.assign(problem.contacts.size(), Impulse{});
  SolverRoom room;
  s.report = solve(problem, options, s.impulse, s.velocity, s.angular, room);
  return s;
}

/// The natural map of the exact law, contact by contact in plain scalars: the oracle of residual().
double scalar_residual(const ConeProblem& problem, const Solution& s) {
  double error = 0, size = 0;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const ConeContact& c = problem.contacts[i];
    Impulse u = relative_velocity(c, s.velocity, s.angular);
    u[0] += c.bias + c.friction * std::hypot(u[1], u[2]) + c.rolling * std::hypot(u[3], u[4]) + c.spinning * std::abs(u[5]);
    const auto inverse = [&](std::int32_t body, const Vec3& arm) {
      const InverseMass& m = problem.inverse_mass[static_cast<std::size_t>(body)];
      const Vec3 t = arm.cross(c.normal);
      Mat3 inertia;
      inertia << m.inertia[0], m.inertia[1], m.inertia[2], m.inertia[1], m.inertia[3], m.inertia[4], m.inertia[2],
          m.inertia[4], m.inertia[5];
      return m.mass + t.dot(inertia * t);
    };
    const double w = inverse(c.a, c.arm_a) + inverse(c.b, c.arm_b);
    Impulse g = s.impulse[i];
    for (std::size_t k = 0; k < 6; ++k) g[k] -= u[k] / w;
    g[0] += c.cohesion;
    project_on_cone(g[0], g[1], g[2], g[3], g[4], g[5], c.friction, c.rolling, c.spinning);
    g[0] -= c.cohesion;
    for (std::size_t k = 0; k < 6; ++k) {
      error += w * std::pow(g[k] - s.impulse[i][k], 2);
      size += w * std::pow(s.impulse[i][k], 2);
    }
  }
  return std::sqrt(error / size);
}

class EverySolver : public testing::TestWithParam<SolverKind> {};

TEST_P(EverySolver, MeetsItsToleranceByAnIndependentResidual) {
  for (const double rolling : {0.0, 0.1})
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const ConeProblem problem = random_bed(5, 4, seed, 0.5, rolling);
      SolverOptions options;
      // The impulses of such a bed are not unique, and all methods converge sublinearly below about 1e-4.
      options.tolerance = 1e-4;
      options.max_iterations = 20000;
      options.kind = GetParam();
      const Solution s = solved(problem, options);
      EXPECT_TRUE(s.report.converged) << "residual " << s.report.residual;
      EXPECT_NEAR(scalar_residual(problem, s), s.report.residual, 1e-9);
      double work = 0;
      for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
        const ConeContact& c = problem.contacts[i];
        const Impulse free = relative_velocity(c, problem.velocity, problem.angular_velocity);
        const Impulse after = relative_velocity(c, s.velocity, s.angular);
        for (std::size_t k = 0; k < 6; ++k) work += 0.5 * s.impulse[i][k] * (free[k] + after[k]);
      }
      EXPECT_LT(work, 0);
    }
}

TEST_P(EverySolver, AgreesInVelocitiesWithGaussSeidelAtTightTolerance) {
  // Low friction keeps the problem close to a convex one, whose velocities are unique.
  const ConeProblem problem = random_bed(4, 3, 7, 0.1, 0.02);
  SolverOptions options;
  options.tolerance = 1e-9;
  options.max_iterations = 50000;
  const Solution reference = solved(problem, options);
  options.kind = GetParam();
  const Solution other = solved(problem, options);
  ASSERT_TRUE(reference.report.converged);
  ASSERT_TRUE(other.report.converged) << other.report.residual;
  for (std::size_t i = 0; i < reference.velocity.size(); ++i)
    EXPECT_LE((reference.velocity[i] - other.velocity[i]).norm(), 1e-5);
}

TEST_P(EverySolver, RelaxedLawIsTheConvexProgrammesOptimum) {
  const ConeProblem problem = random_bed(4, 3, 5, 0.4, 0.1);
  SolverOptions options;
  options.law = ContactLaw::relaxed;
  options.tolerance = 1e-7;
  options.max_iterations = 50000;
  options.kind = GetParam();
  const Solution s = solved(problem, options);
  ASSERT_TRUE(s.report.converged) << s.report.residual;
  // Optimality of the dual: u + bias in the dual cone, and g . (u + bias) = 0.
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const ConeContact& c = problem.contacts[i];
    Impulse u = relative_velocity(c, s.velocity, s.angular);
    u[0] += c.bias;
    const double slip = c.friction * std::hypot(u[1], u[2]) + c.rolling * std::hypot(u[3], u[4]) + c.spinning * std::abs(u[5]);
    EXPECT_GE(u[0], slip - 1e-4);
    double product = 0;
    for (std::size_t k = 0; k < 6; ++k) product += u[k] * s.impulse[i][k];
    EXPECT_NEAR(product, 0, 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver,
                         testing::Values(SolverKind::gauss_seidel, SolverKind::apgd, SolverKind::barzilai_borwein),
                         [](const auto& solver) {
                           return solver.param == SolverKind::gauss_seidel ? "GaussSeidel"
                                  : solver.param == SolverKind::apgd       ? "Apgd"
                                                                         : "BarzilaiBorwein";
                         });

TEST(ConeSolver, TwoThreadsGiveTheSameBits) {
  const ConeProblem problem = random_bed(14, 6, 11, 0.5, 0.1);
  ASSERT_GT(problem.contacts.size(), 2000u);
  for (const SolverKind kind : {SolverKind::gauss_seidel, SolverKind::apgd, SolverKind::barzilai_borwein}) {
    SolverOptions options;
    options.max_iterations = 60;
    options.kind = kind;
    const Solution one = solved(problem, options);
    options.threads = 2;
    const Solution two = solved(problem, options);
    EXPECT_EQ(one.impulse, two.impulse);
    EXPECT_EQ(one.report.residual, two.report.residual);
  }
}

TEST(ConeSolver, SinglePrecisionAgreesWithDouble) {
  // Above 2,000 contacts single precision is used unless the tolerance is below its reach.
  const ConeProblem problem = random_bed(14, 6, 12, 0.1, 0.02);
  SolverOptions options;
  options.tolerance = 2e-5;
  options.max_iterations = 20000;
  const Solution single = solved(problem, options);
  options.tolerance = 9e-6;
  const Solution twice = solved(problem, options);
  ASSERT_TRUE(single.report.converged) << single.report.residual;
  ASSERT_TRUE(twice.report.converged);
  EXPECT_LT(scalar_residual(problem, single), 3e-5);
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < single.velocity.size(); ++i) {
    difference += (single.velocity[i] - twice.velocity[i]).squaredNorm();
    size += (twice.velocity[i] - problem.velocity[i]).squaredNorm();
  }
  // Both are within their tolerance of a solution, times the condition of the problem (about a hundred).
  EXPECT_LT(std::sqrt(difference / size), 3e-3);
}

TEST(ConeSolver, MomentumIsKeptByEveryPair) {
  ConeProblem problem = random_bed(4, 4, 3, 0.6, 0.2);
  std::erase_if(problem.contacts, [&](const ConeContact& c) { return c.b >= problem.dynamic_bodies; });
  SolverOptions options;
  const Solution s = solved(problem, options);
  Vec3 change = Vec3::Zero();
  double size = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(problem.dynamic_bodies); ++i) {
    const Vec3 d = (s.velocity[i] - problem.velocity[i]) / problem.inverse_mass[i].mass;
    change += d;
    size += d.norm();
  }
  EXPECT_LE(change.norm(), 1e-14 * size);
}

TEST(ConeSolver, NoContactsNoWork) {
  ConeProblem problem = random_bed(2, 1, 1, 0.5, 0.1);
  problem.contacts.clear();
  const Solution s = solved(problem, {});
  EXPECT_TRUE(s.report.converged);
  EXPECT_EQ(s.velocity[0], problem.velocity[0]);
}

/// Every contact has one colour, and no two of a colour share a dynamic body.
void expect_colours_part(const ConeProblem& problem, const Colouring& colouring) {
  std::vector<int> seen(problem.contacts.size());
  std::vector<int> used(problem.velocity.size(), -1);  // last colour of a body
  for (int k = 0; k < colouring.colours(); ++k)
    for (std::int32_t at = colouring.start[std::size_t(k)]; at < colouring.start[std::size_t(k) + 1]; ++at) {
      const std::int32_t contact = colouring.order[std::size_t(at)];
      ++seen[std::size_t(contact)];
      for (const std::int32_t body : {problem.contacts[std::size_t(contact)].a, problem.contacts[std::size_t(contact)].b}) {
        if (body >= problem.dynamic_bodies) continue;
        EXPECT_NE(used[std::size_t(body)], k);
        used[std::size_t(body)] = k;
      }
    }
  for (int times : seen) EXPECT_EQ(times, 1);
}

TEST(Colouring, NoTwoContactsOfAColourShareADynamicBody) {
  ConeProblem problem = random_bed(6, 4, 2, 0.5, 0.1);
  // One body under very many: more colours than one word of bits.
  for (int i = 0; i < 130; ++i) {
    ConeContact c = problem.contacts[0];
    c.a = 0;
    c.b = static_cast<std::int32_t>(i % (problem.dynamic_bodies - 1)) + 1;
    problem.contacts.push_back(c);
  }
  expect_colours_part(problem, colour_contacts(problem, 2));
}

/// A line of balls that touch, on a floor, all pressed to the left as well.
ConeProblem long_row(std::int32_t balls) {
  ConeProblem problem;
  problem.dynamic_bodies = balls;
  problem.velocity.assign(static_cast<std::size_t>(balls) + 1, Vec3::Zero());
  problem.angular_velocity.assign(static_cast<std::size_t>(balls) + 1, Vec3::Zero());
  problem.inverse_mass.assign(static_cast<std::size_t>(balls) + 1, {});
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> push(-1, 1);
  for (std::int32_t i = 0; i < balls; ++i) {
    const auto at = static_cast<std::size_t>(i);
    problem.inverse_mass[at].mass = 1;
    problem.inverse_mass[at].inertia = {2.5, 0, 0, 2.5, 0, 2.5};
    problem.velocity[at] = {push(random), 0.3 * push(random), -1};
    ConeContact c;
    c.a = i;
    c.b = balls;  // the floor
    c.normal = -Vec3::UnitZ();
    c.arm_a = -Vec3::UnitZ();
    c.friction = 0.5;
    c.rolling = 0.1;
    problem.contacts.push_back(c);
    if (i + 1 == balls) break;
    c.b = i + 1;
    c.normal = Vec3::UnitX();
    c.arm_a = Vec3::UnitX();
    c.arm_b = -Vec3::UnitX();
    problem.contacts.push_back(c);
  }
  return problem;
}

TEST(Colouring, IsTheSameAtAnyThreadCountWhereBodiesMakeBlocks) {
  ConeProblem problem = long_row(40000);
  // Very many contacts of one body within a block, and of one with all others.
  for (int i = 1; i <= 130; ++i)
    for (const std::int32_t distance : {1, 250}) {
      ConeContact c = problem.contacts[0];
      c.a = 3000;
      c.b = 3000 + i * distance;
      problem.contacts.push_back(c);
    }
  const Colouring one = colour_contacts(problem, 1), three = colour_contacts(problem, 3);
  EXPECT_GT(one.blocks(), 10);
  EXPECT_GT(one.colours(), 130);
  EXPECT_EQ(one.order, three.order);
  EXPECT_EQ(one.start, three.start);
  EXPECT_EQ(one.block, three.block);
  expect_colours_part(problem, one);
}

TEST(Colouring, BlocksShareNoDynamicBody) {
  const ConeProblem problem = long_row(40000);
  const Colouring colouring = colour_contacts(problem, 3);
  ASSERT_GT(colouring.blocks(), 1);
  std::vector<int> block_of_body(static_cast<std::size_t>(problem.dynamic_bodies), -1);
  for (int block = 0; block < colouring.blocks(); ++block)
    for (std::int32_t at = colouring.start[std::size_t(colouring.block[std::size_t(block)])];
         at < colouring.start[std::size_t(colouring.block[std::size_t(block) + 1])]; ++at) {
      const ConeContact& c = problem.contacts[std::size_t(colouring.order[std::size_t(at)])];
      for (const std::int32_t body : {c.a, c.b}) {
        if (body >= problem.dynamic_bodies) continue;
        int& of = block_of_body[std::size_t(body)];
        EXPECT_TRUE(of == -1 || of == block) << "body " << body;
        of = block;
      }
    }
  // In a row, all contacts but those at the ends of blocks are within one.
  const auto first_between = static_cast<std::size_t>(colouring.start[std::size_t(colouring.block.back())]);
  EXPECT_EQ(problem.contacts.size() - first_between, static_cast<std::size_t>(colouring.blocks() - 1));
}

TEST(ConeSolver, BlocksGiveTheSameBitsAtAnyThreadCountAndSolve) {
  const ConeProblem problem = long_row(40000);
  SolverOptions options;
  options.tolerance = 1e-4;
  options.max_iterations = 3000;
  options.threads = 1;
  const Solution one = solved(problem, options);
  options.threads = 3;
  const Solution three = solved(problem, options);
  ASSERT_TRUE(one.report.converged) << one.report.residual;
  EXPECT_LT(scalar_residual(problem, one), 3e-4);
  for (std::size_t i = 0; i < one.velocity.size(); ++i) EXPECT_EQ(one.velocity[i], three.velocity[i]) << "body " << i;
  for (std::size_t i = 0; i < one.impulse.size(); ++i) EXPECT_EQ(one.impulse[i], three.impulse[i]) << "contact " << i;
}

}  // namespace
}  // namespace repose::dvi
