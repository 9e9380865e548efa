#include "backends/dvi/broad_phase.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace repose::dvi {
namespace {

using Pairs = std::set<std::pair<int, int>>;

Pairs found(const std::vector<Vec3>& x, const std::vector<double>& r, const PeriodicCell& cell = {}) {
  BroadPhase broad;
  broad.build(x, r, cell);
  Pairs pairs;
  for (std::size_t rank = 0; rank < x.size(); ++rank)
    broad.partners(rank, [&](std::size_t other) {
      EXPECT_GT(other, rank);
      const int i = broad.order()[rank], j = broad.order()[other];
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

TEST(BroadPhase, FindsThePairsOfNearestImagesInPeriodicCells) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(-1, 1), size(0, 1);
  int across = 0;
  for (int scene = 0; scene < 60; ++scene) {
    PeriodicCell cell;
    for (int k = 0; k < 2; ++k) {
      if (scene % 3 == 2 - k) continue;  // both, y alone, x alone
      cell.lower[k] = u(random) - 1;
      cell.upper[k] = cell.lower[k] + (scene % 4 == 0 ? 0.3 : 1.7);
    }
    std::vector<Vec3> x;
    std::vector<double> r;
    const double ratio = scene % 2 ? 1 : 30;
    for (int i = 0; i < 250; ++i) {
      // Some stand outside the cell, as bodies do within a step.
      x.push_back(Vec3(2 * u(random), 2 * u(random), u(random)));
      // In one scene balls as wide as the period: every cell of a ring is then looked at, once.
      r.push_back((scene == 8 ? 0.2 : 0.05) * std::pow(ratio, -size(random)));
    }
    // Two balls stand at most 4 apart.
    const auto images = [&](int k) { return cell.along(k) ? 1 + static_cast<int>(4 / cell.length(k)) : 0; };
    Pairs wanted;
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t j = i + 1; j < x.size(); ++j) {
        bool near = false;
        for (int a = -images(0); a <= images(0); ++a)
          for (int b = -images(1); b <= images(1); ++b) {
            const Vec3 shift(a * cell.length(0), b * cell.length(1), 0);
            near = near || (x[i] - x[j] + shift).squaredNorm() < (r[i] + r[j]) * (r[i] + r[j]);
          }
        if (near) wanted.insert({int(i), int(j)});
        across += near && (x[i] - x[j]).norm() > r[i] + r[j];
      }
    EXPECT_EQ(found(x, r, cell), wanted) << "scene " << scene;
  }
  EXPECT_GT(across, 500);
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
