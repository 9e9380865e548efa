#include "backends/dvi/broad_phase.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace repose::dvi {
namespace {

using Pairs = std::set<std::pair<int, int>>;

Pairs found(const std::vector<Vec3>& x, const std::vector<double>& r) {
  BroadPhase broad;
  broad.build(x, r);
  Pairs pairs;
  for (std::size_t rank = 0; rank < x.size(); ++rank)
    broad.partners(rank, [&](std::int32_t j) {
      const int i = broad.order()[rank];
      const bool is_new = pairs.insert({std::min(i, j), std::max(i, j)}).second;
      EXPECT_TRUE(is_new) << "pair " << i << ", " << j << " came twice";
    });
  return pairs;
}

Pairs brute_force(const std::vector<Vec3>& x, const std::vector<double>& r) {
  Pairs pairs;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = i + 1; j < x.size(); ++j)
      if ((x[i] - x[j]).squaredNorm() < (r[i] + r[j]) * (r[i] + r[j])) pairs.insert({int(i), int(j)});
  return pairs;
}

TEST(BroadPhase, FindsEveryPairOnceForAnySizeRatio) {
  std::mt19937_64 random(3);
  for (const double ratio : {1.0, 3.0, 10.0, 1000.0}) {
    std::uniform_real_distribution<double> u(-1, 1), size(0, 1);
    std::vector<Vec3> x;
    std::vector<double> r;
    for (int i = 0; i < 1500; ++i) {
      x.push_back(Vec3(u(random), u(random), u(random)));
      r.push_back(0.08 * std::pow(ratio, -size(random)));
    }
    EXPECT_EQ(found(x, r), brute_force(x, r)) << "size ratio " << ratio;
  }
}

TEST(BroadPhase, CoincidentAndFarAwayBallsAreNoTrouble) {
  const std::vector<Vec3> x{{0, 0, 0}, {0, 0, 0}, {1e9, -1e9, 1e9}, {1e9, -1e9, 1e9}, {-1e18, 0, 0}};
  const std::vector<double> r(5, 1e-3);
  EXPECT_EQ(found(x, r), (Pairs{{0, 1}, {2, 3}}));
}

TEST(BroadPhase, NothingIsNoTrouble) {
  EXPECT_TRUE(found({}, {}).empty());
  EXPECT_TRUE(found({{1, 2, 3}}, {1}).empty());
}

TEST(BroadPhase, CandidatesGrowLinearly) {
  // Balls of two sizes, 10:1, at equal volume fraction: tests per ball must not depend on their number.
  const auto pairs_per_ball = [](int n) {
    std::mt19937_64 random(4);
    const double side = std::cbrt(n / 1000.0);
    std::uniform_real_distribution<double> u(0, side);
    std::vector<Vec3> x;
    std::vector<double> r;
    for (int i = 0; i < n; ++i) {
      x.push_back(Vec3(u(random), u(random), u(random)));
      r.push_back(i % 100 == 0 ? 0.1 : 0.01);
    }
    return static_cast<double>(found(x, r).size()) / n;
  };
  EXPECT_NEAR(pairs_per_ball(16000) / pairs_per_ball(2000), 1.0, 0.25);
}

}  // namespace
}  // namespace repose::dvi
