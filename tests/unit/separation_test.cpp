#include "backends/dvi/separation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "backends/dvi/body_blocks.hpp"

namespace repose::dvi {
namespace {

constexpr double slop = 1e-3;

/// Balls of unit mass on a line, all that touch or nearly do, with the gaps given between neighbours.
struct Row {
  ConeProblem problem;
  std::vector<double> gap;
};

Row row_of(const std::vector<double>& gaps, bool held_at_the_left = false) {
  Row row;
  row.gap = gaps;
  const std::size_t balls = gaps.size() + 1;
  row.problem.dynamic_bodies = static_cast<std::int32_t>(balls);
  row.problem.velocity.assign(balls, Vec3::Zero());
  row.problem.inverse_mass.assign(balls, {});
  for (std::size_t i = held_at_the_left ? 1 : 0; i < balls; ++i) {
    row.problem.inverse_mass[i].mass = 1;
    row.problem.inverse_mass[i].inertia = {2.5, 0, 0, 2.5, 0, 2.5};
  }
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    ConeContact c;
    c.a = static_cast<std::int32_t>(i);
    c.b = static_cast<std::int32_t>(i + 1);
    c.normal = Vec3::UnitX();
    c.arm_a = Vec3::UnitX();
    c.arm_b = -Vec3::UnitX();
    c.arm = 0.5;
    row.problem.contacts.push_back(c);
  }
  return row;
}

double gap_after(const Row& row, const std::vector<Displacement>& moved, std::size_t i) {
  const ConeContact& c = row.problem.contacts[i];
  const Displacement &a = moved[static_cast<std::size_t>(c.a)], &b = moved[static_cast<std::size_t>(c.b)];
  return row.gap[i] + c.normal.dot(b.shift + b.turn.cross(c.arm_b) - a.shift - a.turn.cross(c.arm_a));
}

TEST(Separation, ShallowOverlapIsLeftAlone) {
  const Row row = row_of({-0.9 * slop * 0.5, 0.1});
  std::vector<Displacement> moved;
  EXPECT_EQ(push_apart(row.problem, row.gap, slop, 1, moved), 0);
  for (const Displacement& d : moved) EXPECT_TRUE(d.shift.isZero(0));
}

TEST(Separation, TwoBallsShareTheWay) {
  const Row row = row_of({-0.01});
  std::vector<Displacement> moved;
  push_apart(row.problem, row.gap, slop, 1, moved);
  const double way = 0.01 - 0.25 * slop;  // up to half the slop, of an arm of a half
  EXPECT_NEAR(moved[1].shift.x(), 0.5 * way, 1e-15);
  EXPECT_NEAR(moved[0].shift.x(), -0.5 * way, 1e-15);
}

TEST(Separation, ABodyWithoutInverseMassStays) {
  const Row row = row_of({-0.01, 0.3}, true);
  std::vector<Displacement> moved;
  push_apart(row.problem, row.gap, slop, 1, moved);
  EXPECT_TRUE(moved[0].shift.isZero(0));
  EXPECT_NEAR(moved[1].shift.x(), 0.01 - 0.25 * slop, 1e-15);
}

TEST(Separation, NeighboursGiveWayAndTheRestStays) {
  // Balls 0 to 3 touch in a row, one pair of them deep; 4 and 5 stand apart from them and touch each other.
  const Row row = row_of({0, -0.02, 0, 0.5, 0});
  std::vector<Displacement> moved;
  EXPECT_GT(push_apart(row.problem, row.gap, slop, 1, moved), 1);
  for (std::size_t i = 0; i < row.gap.size(); ++i) EXPECT_GE(gap_after(row, moved, i), -slop * 0.5) << "contact " << i;
  EXPECT_LT(moved[0].shift.x(), 0);
  EXPECT_GT(moved[3].shift.x(), 0);
  EXPECT_TRUE(moved[4].shift.isZero(0));
  EXPECT_TRUE(moved[5].shift.isZero(0));
}

/// The same law by sweeps over all contacts, the deep and the rest alike, until nothing moves.
std::vector<double> shifts_by_full_sweeps(const Row& row) {
  std::vector<double> x(row.gap.size() + 1, 0.0), multiplier(row.gap.size(), 0.0);
  for (int s = 0; s < 100000; ++s) {
    double most = 0;
    for (std::size_t i = 0; i < row.gap.size(); ++i) {
      const double target = -0.25 * slop, goal = row.gap[i] < -slop * 0.5 ? target : std::min(target, row.gap[i]);
      const double before = multiplier[i];
      multiplier[i] = std::max(0.0, before + (goal - (row.gap[i] + x[i + 1] - x[i])) / 2);
      const double d = multiplier[i] - before;
      x[i] -= d;
      x[i + 1] += d;
      most = std::max(most, std::abs(d));
    }
    if (most < 1e-12) break;
  }
  return x;
}

TEST(Separation, VisitsWhatFullSweepsWouldChange) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> gap(-3e-3, 12e-3);
  for (int scene = 0; scene < 50; ++scene) {
    std::vector<double> gaps(200);
    for (double& g : gaps) g = gap(random);
    const Row row = row_of(gaps);
    std::vector<Displacement> moved;
    EXPECT_LT(push_apart(row.problem, row.gap, slop, 1, moved), 60);
    const std::vector<double> wanted = shifts_by_full_sweeps(row);
    // A shallow contact keeps its gap up to slop, and both of its bodies may have moved by a tenth of that unnoticed.
    for (std::size_t i = 0; i < gaps.size(); ++i) EXPECT_GE(gap_after(row, moved, i), -1.2 * slop * 0.5) << "contact " << i;
    // What is unnoticed adds up through the few that touch in a row.
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(moved[i].shift.x(), wanted[i], slop * 0.5) << "ball " << i;
  }
}

TEST(Separation, BlocksOfBodiesGiveTheSameBitsAtAnyThreadCount) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> gap(-3e-3, 12e-3);
  std::vector<double> gaps(40000);
  for (double& g : gaps) g = gap(random);
  Row row = row_of(gaps);
  ASSERT_GT(BodyBlocks(row.problem.dynamic_bodies).count(), 1);
  std::vector<Displacement> moved, by_three;
  EXPECT_LT(push_apart(row.problem, row.gap, slop, 1, moved), 60);
  push_apart(row.problem, row.gap, slop, 3, by_three);
  const std::vector<double> wanted = shifts_by_full_sweeps(row);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    EXPECT_NEAR(moved[i].shift.x(), wanted[i], slop * 0.5) << "ball " << i;
    EXPECT_EQ(moved[i].shift, by_three[i].shift) << "ball " << i;
    EXPECT_EQ(moved[i].turn, by_three[i].turn) << "ball " << i;
  }
}

}  // namespace
}  // namespace repose::dvi
