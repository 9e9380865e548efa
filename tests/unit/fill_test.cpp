#include "core/fill.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/ball_grid.hpp"
#include "core/error.hpp"
#include "core/random.hpp"

namespace repose {
namespace {

FillRegion box(const Vec3& lower, const Vec3& upper, bool grow = false) {
  FillRegion region;
  region.lower = lower, region.upper = upper, region.grow = grow;
  return region;
}

FillRegion frustum(const Vec3& base, double bottom, double top, double height, bool grow = false) {
  FillRegion region;
  region.kind = FillRegion::Kind::frustum;
  region.base = base, region.radius_bottom = bottom, region.radius_top = top, region.height = height,
  region.grow = grow;
  return region;
}

// Radii between `largest` and a tenth of it, every size with the same share of the volume.
std::vector<double> mixed_radii(std::size_t count, double largest, std::uint64_t seed) {
  Random random(seed, 7);
  std::vector<double> radii;
  for (std::size_t i = 0; i < count; ++i) radii.push_back(largest / std::cbrt(random.uniform(1, 1000)));
  radii.push_back(largest);
  radii.push_back(0.1 * largest);
  return radii;
}

double volume(const std::vector<double>& radii) {
  double sum = 0;
  for (double r : radii) sum += 4 * std::numbers::pi / 3 * r * r * r;
  return sum;
}

// Least distance between any two surfaces, by looking at all pairs, relative to the smaller radius.
double least_gap(const std::vector<Placement>& balls, const std::vector<double>& radii) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < balls.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      least = std::min(
          least, ((balls[i].position - balls[j].position).norm() - radii[i] - radii[j]) / std::min(radii[i], radii[j]));
  return least;
}

// How far the ball stays inside a frustum and the cylinder on top of it, by sampling the ball's outline in the plane of
// the axis; relative to its radius. A widening or straight frustum only.
double clearance(const FillRegion& f, const Vec3& centre, double r) {
  const Vec3 p = centre - f.base;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 720; ++i) {
    const double angle = std::numbers::pi * i / 360, rho = std::hypot(p.x(), p.y()) + r * std::cos(angle),
                 z = p.z() + r * std::sin(angle);
    const double wall = f.radius_bottom + (f.radius_top - f.radius_bottom) * std::min(1.0, z / f.height);
    least = std::min({least, wall - rho, z, f.grow ? 1e300 : f.height - z});
  }
  return least / r;
}

TEST(Fill, BoxHoldsTenToOneMixWithoutOverlap) {
  const std::vector<double> radii = mixed_radii(3000, 50e-6, 1);
  const double width = std::cbrt(volume(radii) / 0.25);
  const FillRegion region = box({1, 2, 3}, Vec3(1, 2, 3) + Vec3::Constant(width));
  const auto balls = place_balls(region, radii, 1);
  ASSERT_EQ(balls.size(), radii.size());
  // The region lies far from the origin: positions there are rounded to 1e-10 of a small ball.
  EXPECT_GE(least_gap(balls, radii), -1e-9);
  for (std::size_t i = 0; i < balls.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(balls[i].position[k] - radii[i], region.lower[k] - 1e-9 * radii[i]);
      EXPECT_LE(balls[i].position[k] + radii[i], region.upper[k] + 1e-9 * radii[i]);
    }
}

TEST(Fill, EqualBallsFillAQuarterAndMore) {
  const std::vector<double> radii(2000, 1.0);
  const double width = std::cbrt(volume(radii) / 0.29);
  const auto balls = place_balls(box(Vec3::Zero(), Vec3::Constant(width)), radii, 2);
  EXPECT_GE(least_gap(balls, radii), 0);
}

TEST(Fill, FrustumKeepsClearOfItsSlopingWall) {
  const std::vector<double> radii = mixed_radii(3000, 50e-6, 3);
  for (double ratio : {0.0, 0.3, 1.0}) {
    // A frustum twice as high as its top is wide, filled to 22 %.
    const double top = std::cbrt(volume(radii) / 0.22 / (4 * std::numbers::pi * (ratio * ratio + ratio + 1) / 3));
    const FillRegion region = frustum({0.01, -0.02, 0.03}, ratio * top, top, 4 * top);
    const auto balls = place_balls(region, radii, 3);
    EXPECT_GE(least_gap(balls, radii), -1e-10);
    double least = 1;
    for (std::size_t i = 0; i < balls.size(); ++i)
      least = std::min(least, clearance(region, balls[i].position, radii[i]));
    EXPECT_GE(least, -1e-9);
    EXPECT_LT(least, 0.1);  // the room along the wall is used
  }
}

TEST(Fill, NarrowingFrustum) {
  const std::vector<double> radii(200, 1.0);
  const FillRegion region = frustum(Vec3::Zero(), 14, 6, 20);
  const double slant = std::hypot(8.0, 20.0);
  for (const Placement& ball : place_balls(region, radii, 4)) {
    const Vec3& p = ball.position;
    // Distance from the line through (14, 0) and (6, 20) in the plane of the axis.
    EXPECT_GE((20 * (14 - std::hypot(p.x(), p.y())) - 8 * p.z()) / slant, 1 - 1e-12);
    EXPECT_GE(p.z(), 1);
    EXPECT_LE(p.z(), 19);
  }
}

TEST(Fill, GrowsUpwardOnly) {
  const std::vector<double> radii = mixed_radii(2000, 1.0, 5);
  const FillRegion small_box = box({0, 0, 0}, {8, 8, 0.5}, true), funnel = frustum(Vec3::Zero(), 1, 5, 4, true);
  for (const FillRegion& region : {small_box, funnel}) {
    const auto balls = place_balls(region, radii, 5);
    EXPECT_GE(least_gap(balls, radii), 0);
    double top = 0;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const Vec3& p = balls[i].position;
      top = std::max(top, p.z() + radii[i]);
      if (region.kind == FillRegion::Kind::box) {
        EXPECT_GE(p.minCoeff(), radii[i]);
        EXPECT_LE(std::max(p.x(), p.y()), 8 - radii[i]);
      } else {
        EXPECT_GE(clearance(region, p, radii[i]), -1e-9);
      }
    }
    const double room =
        region.kind == FillRegion::Kind::box ? 64 * top : std::numbers::pi * (4 * 31 / 3.0 + (top - 4) * 25);
    EXPECT_GT(volume(radii) / room, 0.2);
  }
  // Hardly wider than the balls, much too low: still a column of them.
  const std::vector<double> column(40, 1.0);
  const auto balls = place_balls(box({0, 0, 0}, {2.1, 2.1, 1}, true), column, 6);
  EXPECT_GE(least_gap(balls, column), 0);
}

TEST(Fill, LeavesARegionWithRoomAsItIs) {
  const std::vector<double> radii(100, 1.0);
  for (const Placement& ball : place_balls(box({0, 0, 0}, {30, 30, 30}, true), radii, 7))
    EXPECT_LE(ball.position.z(), 29);
}

TEST(Fill, SeedDeterminesEverythingAndScaleChangesNothing) {
  const std::vector<double> radii = mixed_radii(500, 1.0, 8);
  std::vector<double> small;
  for (double r : radii) small.push_back(0x1p-14 * r);
  const auto a = place_balls(box({0, 0, 0}, {12, 12, 1}, true), radii, 9),
             b = place_balls(box({0, 0, 0}, {12, 12, 1}, true), radii, 9),
             c = place_balls(box({0, 0, 0}, 0x1p-14 * Vec3(12, 12, 1), true), small, 9);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].position, b[i].position);
    EXPECT_EQ(a[i].orientation.coeffs(), b[i].orientation.coeffs());
    EXPECT_EQ(Vec3(a[i].position * 0x1p-14), c[i].position);
  }
  EXPECT_NE(a[0].position, place_balls(box({0, 0, 0}, {12, 12, 1}, true), radii, 10)[0].position);
}

TEST(Fill, OrientationsAreUniform) {
  const std::vector<double> radii(20'000, 0.01);
  Vec3 mean = Vec3::Zero();
  Mat3 square = Mat3::Zero();
  for (const Placement& ball : place_balls(box({0, 0, 0}, {2, 2, 2}), radii, 11)) {
    EXPECT_NEAR(ball.orientation.norm(), 1, 1e-14);
    const Vec3 axis = ball.orientation * Vec3::UnitX();
    mean += axis / 20'000;
    square += axis * axis.transpose() / 20'000;
  }
  EXPECT_LT(mean.norm(), 0.02);
  EXPECT_LT((square - Mat3::Identity() / 3).cwiseAbs().maxCoeff(), 0.015);
}

TEST(Fill, RefusesWhatDoesNotFit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> one{1.0}, many(100, 1.0), bad{nan}, none{0.0};
  EXPECT_THROW(place_balls(box({0, 0, 0}, {5, 5, 5}), many, 1), Error);
  EXPECT_THROW(place_balls(box({0, 0, 0}, {1.9, 5, 5}, true), one, 1), Error);
  EXPECT_THROW(place_balls(box({0, 0, 0}, {5, 5, 1.9}), one, 1), Error);
  EXPECT_THROW(place_balls(box({0, 0, 0}, {5, 5, -1}, true), one, 1), Error);
  EXPECT_THROW(place_balls(box({0, 0, nan}, {5, 5, 5}), one, 1), Error);
  EXPECT_THROW(place_balls(box({0, 0, 0}, {5, 5, 5}), bad, 1), Error);
  EXPECT_THROW(place_balls(box({0, 0, 0}, {5, 5, 5}), none, 1), Error);
  EXPECT_THROW(place_balls(frustum({0, 0, 0}, 0, 0.9, 5, true), one, 1), Error);
  EXPECT_THROW(place_balls(frustum({0, 0, 0}, 0, 2, 2), one, 1), Error);
  EXPECT_THROW(place_balls(frustum({0, 0, 0}, -1, 2, 2), one, 1), Error);
  EXPECT_THROW(place_balls(frustum({0, 0, 0}, 1, 2, 0), one, 1), Error);
  EXPECT_TRUE(place_balls(box({0, 0, 0}, {5, 5, 5}), {}, 1).empty());
  EXPECT_EQ(place_balls(box({0, 0, 0}, {2.001, 2.001, 2.001}), one, 1).size(), 1u);
  EXPECT_EQ(place_balls(box({0, 0, 0}, {5, 5, 1.9}, true), one, 1).size(), 1u);

  // Too dense for random places, though not for a lattice: the message states the missing height.
  try {
    const std::vector<double> dense(4000, 1.0);
    place_balls(box({0, 0, 0}, {30, 30, volume(dense) / 0.45 / 900}), dense, 1);
    ADD_FAILURE() << "a fraction of 0.45 was reached";
  } catch (const Error& error) {
    EXPECT_NE(error.problem().find("of 4000 grains fit"), std::string::npos) << error.what();
    EXPECT_NE(error.remedy().find("33.1 m higher"), std::string::npos) << error.what();
  }
}

TEST(BallGrid, FindsEveryOverlap) {
  Random random(12, 0);
  BallGrid grid(1.0, 500);
  std::vector<std::pair<Vec3, double>> balls;
  for (int i = 0; i < 1500; ++i) {
    const Vec3 p(random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-8, 8));
    const double r = std::pow(10, random.uniform(-2, 0));
    const bool free =
        std::none_of(balls.begin(), balls.end(), [&](const auto& b) { return (b.first - p).norm() < b.second + r; });
    ASSERT_EQ(grid.free(p, r), free);
    if (free) grid.add(p, r), balls.emplace_back(p, r);
  }
  EXPECT_GT(balls.size(), 400u);
}

}  // namespace
}  // namespace repose
