#include "analysis/roughness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr double pi = std::numbers::pi;

HeightGrid surface(int nx, int ny, double cell, const std::function<double(double, double)>& height) {
  HeightGrid grid;
  grid.cell = cell;
  grid.nx = nx;
  grid.ny = ny;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec2 at = grid.middle(i, j);
      grid.height.push_back(static_cast<float>(height(at.x(), at.y())));
    }
  return grid;
}

TEST(Roughness, APlaneHasNone) {
  const HeightGrid tilted = surface(50, 30, 0.1, [](double x, double y) { return 7 + 0.3 * x - 0.2 * y; });
  const Plane plane = fit_plane(tilted);
  EXPECT_NEAR(plane.slope.x(), 0.3, 1e-6);
  EXPECT_NEAR(plane.slope.y(), -0.2, 1e-6);
  EXPECT_NEAR(plane.height, 7 + 0.3 * 2.5 - 0.2 * 1.5, 1e-6);
  const Roughness r = roughness(prepared_surface(tilted, {}));
  EXPECT_LT(r.Sz, 2e-6);  // of heights of 8, in single precision
}

// A bare plate: nothing varies, so that skewness and kurtosis, which divide by it, do not exist; all else is known exactly.
TEST(Roughness, OfABarePlateIsNoneAndHasNoShape) {
  const HeightGrid bare = surface(50, 30, 0.1, [](double, double) { return 0; });
  for (const RoughnessFilter& filter : {RoughnessFilter{}, RoughnessFilter{.s = 0.4, .l = 2}}) {
    const HeightGrid prepared = prepared_surface(bare, filter);
    const Roughness r = roughness(prepared);
    for (const double none : {r.Sa, r.Sq, r.Sp, r.Sv, r.Sz}) EXPECT_EQ(none, 0);
    EXPECT_FALSE(r.Ssk);
    EXPECT_FALSE(r.Sku);
    EXPECT_FALSE(autocorrelation_length(prepared));
    const std::optional<RoughnessError> error = block_bootstrap(bare, prepared, 0.5);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->mean, 0);
    EXPECT_EQ(error->Sa, 0);
    EXPECT_FALSE(error->Ssk);
  }
}

TEST(Roughness, ASineOnAPlane) {
  // Whole waves, sampled finely: Sa = 2A/pi, Sq = A/sqrt 2, Ssk = 0, Sku = 3/2; along y, so that the plane's slope is not touched.
  constexpr double amplitude = 3, wave = 20;
  const HeightGrid grid = surface(300, 400, 0.1, [](double, double y) { return 1 + amplitude * std::cos(2 * pi * y / wave); });
  const Roughness r = roughness(prepared_surface(grid, {}));
  EXPECT_NEAR(r.Sa, 2 * amplitude / pi, 1e-3);
  EXPECT_NEAR(r.Sq, amplitude / std::sqrt(2.0), 1e-4);
  EXPECT_NEAR(r.Sp, amplitude, 2e-3);
  EXPECT_NEAR(r.Sv, amplitude, 2e-3);
  EXPECT_EQ(r.Sz, r.Sp + r.Sv);
  EXPECT_NEAR(r.Ssk.value(), 0, 1e-5);
  EXPECT_NEAR(r.Sku.value(), 1.5, 1e-4);
}

TEST(Roughness, AnArrayOfHalfBallsOnAPlate) {
  // Radius R in squares of edge 2R, z = sqrt(R^2 - r^2) over the disc and 0 beside it. Over the square:
  //   <z> = pi R/6   <z^2> = pi R^2/8   <z^3> = pi R^3/10   <z^4> = pi R^4/12
  constexpr double R = 1;
  const HeightGrid grid = surface(1200, 1200, 0.01, [](double x, double y) {
    const double u = x - 2 * std::floor(x / 2) - 1, v = y - 2 * std::floor(y / 2) - 1, left = R * R - u * u - v * v;
    return left > 0 ? std::sqrt(left) : 0;
  });
  const double m = pi * R / 6, m2 = pi / 8, m3 = pi / 10, m4 = pi / 12;
  const double variance = m2 - m * m, third = m3 - 3 * m * m2 + 2 * m * m * m;
  const double fourth = m4 - 4 * m * m3 + 6 * m * m * m2 - 3 * m * m * m * m;
  const double edge = R * R - m * m;  // squared radius at which the ball passes the mean
  const Roughness r = roughness(prepared_surface(grid, {}));
  EXPECT_NEAR(r.Sq, std::sqrt(variance), 1e-3);
  EXPECT_NEAR(r.Sa, 2 * (2 * pi * (R * R * R - m * m * m) / 3 - m * pi * edge) / 4, 1e-3);
  EXPECT_NEAR(r.Ssk.value(), third / std::pow(variance, 1.5), 4e-3);
  EXPECT_NEAR(r.Sku.value(), fourth / (variance * variance), 6e-3);
  EXPECT_NEAR(r.Sp, R - m, 1e-3);
  EXPECT_NEAR(r.Sv, m, 1e-3);
}

TEST(Roughness, HolesAreLeftOut) {
  HeightGrid grid = surface(60, 60, 1, [](double x, double y) { return 0.1 * x + (std::fmod(y, 2) < 1 ? 1 : -1); });
  for (int k = 0; k < 60; k += 7)
    for (int m = 0; m < 60; m += 5) grid.height[grid.index(k, m)] = HeightGrid::hole;
  const Roughness r = roughness(prepared_surface(grid, {}));
  EXPECT_NEAR(r.Sa, 1, 0.05);
  EXPECT_NEAR(r.Sq, 1, 0.05);
  grid.height.assign(grid.height.size(), HeightGrid::hole);
  EXPECT_THROW(prepared_surface(grid, {}), Error);
  EXPECT_THROW(roughness(grid), Error);
}

// ISO 16610-61: a wave keeps exp(-pi (alpha lambda / wave)^2) of its height, half of it at the nesting index.
TEST(GaussianFilter, KeepsOfAWaveWhatTheStandardSays) {
  constexpr double lambda = 25;
  const auto kept = [&](double wave) {
    const HeightGrid grid = surface(400, 3, 1, [&](double x, double) { return std::cos(2 * pi * (x - 200.5) / wave); });
    return gaussian_mean(grid, lambda).at(200, 1) / grid.at(200, 1);
  };
  const double alpha = std::sqrt(std::numbers::ln2 / pi);
  for (const double wave : {12.5, 25.0, 40.0, 100.0})
    EXPECT_NEAR(kept(wave), std::exp(-pi * std::pow(alpha * lambda / wave, 2)), 1e-5) << wave;
  EXPECT_NEAR(kept(25), 0.5, 1e-5);
}

TEST(GaussianFilter, SAndLTogetherPassABand) {
  const auto left = [](double wave) {
    const HeightGrid grid = surface(600, 12, 1, [&](double x, double) { return std::cos(2 * pi * x / wave); });
    const HeightGrid band = prepared_surface(grid, {.s = 8, .l = 120});
    double largest = 0;
    for (int i = 200; i < 400; ++i) largest = std::max<double>(largest, band.at(i, 6));
    return largest;
  };
  EXPECT_LT(left(3), 0.02);
  EXPECT_GT(left(30), 0.85);
  EXPECT_LT(left(550), 0.1);
}

// A filter shorter than the grid can tell is none: an L filter would leave nothing, an S filter everything.
TEST(GaussianFilter, RefusesWhatTheGridCannotHold) {
  const HeightGrid grid = surface(40, 40, 0.5, [](double x, double y) { return x * y; });
  for (const double nonsense : {-1.0, 0.0, 0.1, 0.5, 1.4}) EXPECT_THROW(gaussian_mean(grid, nonsense), Error) << nonsense;
  EXPECT_THROW(gaussian_mean(grid, std::nan("")), Error);
  EXPECT_NO_THROW(gaussian_mean(grid, 1.5));
  EXPECT_THROW(prepared_surface(grid, {.s = 1}), Error);
  EXPECT_THROW(prepared_surface(grid, {.s = 0, .l = 1}), Error);
}

TEST(Sal, EndsAtTheCostThatIsGiven) {
  // Falls to a fifth at eight cells: found only if so far is searched.
  const HeightGrid grid = surface(120, 90, 1, [](double x, double) { return std::cos(2 * pi * x / 40); });
  EXPECT_TRUE(autocorrelation_length(grid));
  constexpr double cells = 120 * 90;
  EXPECT_FALSE(autocorrelation_length(grid, cells * pi / 2 * 5 * 5));
  EXPECT_TRUE(autocorrelation_length(grid, cells * pi / 2 * 12 * 12));
  // A step across the middle: still correlated at half the shorter side.
  EXPECT_FALSE(autocorrelation_length(surface(400, 20, 1, [](double x, double) { return x < 200 ? 0 : 1; })));
}

TEST(Sal, OfASineIsWhereItsCosineHasFallenToAFifth) {
  constexpr double wave = 40;
  const HeightGrid grid = surface(400, 100, 1, [](double x, double) { return std::cos(2 * pi * x / wave); });
  const std::optional<double> found = autocorrelation_length(grid);
  ASSERT_TRUE(found);
  // A window of W = 390 lags holds no whole number of waves: the correlation is off by up to 1/(k W), k = 2 pi/wave, and the lag
  // where it crosses by that over k; the line between two lags adds k/8.
  constexpr double k = 2 * pi / wave;
  EXPECT_NEAR(*found, std::acos(0.2) / k, 1 / (k * k * 390) + k / 8);
  EXPECT_FALSE(autocorrelation_length(surface(30, 30, 1, [](double, double) { return 2; })));
}

// Another implementation on the same heights: surfalize 0.19.2 (F. Schell, MIT licence), Surface.level(), all parameters.
TEST(Roughness, AgreesWithAnIndependentImplementation) {
  const HeightGrid grid = surface(256, 192, 0.5, [](double x, double y) {
    return std::exp(0.8 * std::sin(0.21 * x + 0.5) * std::cos(0.17 * y)) + 0.3 * std::sin(0.9 * x + 0.4 * y) + 0.01 * x - 0.02 * y;
  });
  const HeightGrid prepared = prepared_surface(grid, {});
  const Roughness r = roughness(prepared);
  EXPECT_NEAR(r.Sa, 0.4014131, 2e-6);
  EXPECT_NEAR(r.Sq, 0.4961152, 2e-6);
  EXPECT_NEAR(r.Sp, 1.43633, 2e-6);
  EXPECT_NEAR(r.Sv, 0.9377439, 2e-6);
  EXPECT_NEAR(r.Sz, 2.374074, 2e-6);
  EXPECT_NEAR(r.Ssk.value(), 0.5195411, 1e-5);
  EXPECT_NEAR(r.Sku.value(), 2.725642, 1e-5);
  // It takes the surface for periodic when it correlates, we do not: equal to a few per cent.
  EXPECT_NEAR(autocorrelation_length(prepared).value(), 5.377531, 0.16);
}

TEST(BlockBootstrap, ErrorOfTheMeanOfIndependentCells) {
  // Cells of +-1 by a hash: the mean of n of them scatters by 1/sqrt n.
  const HeightGrid grid = surface(200, 200, 1, [](double x, double y) {
    const unsigned h = (static_cast<unsigned>(x) * 73856093U) ^ (static_cast<unsigned>(y) * 19349663U);
    return (h * 2654435761U) >> 31 ? 1 : -1;
  });
  const std::optional<RoughnessError> error = block_bootstrap(grid, grid, 5);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->blocks, 1600);
  EXPECT_NEAR(error->mean, 1.0 / 200, 0.25 / 200);
  EXPECT_FALSE(block_bootstrap(grid, grid, 100));
}

// The error that is told from one surface against the scatter of many, of lopsided heights that correlate over a few cells.
TEST(BlockBootstrap, ErrorsAreTheScatterOfManySurfaces) {
  constexpr int surfaces = 300, edge = 64;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, 1);
  const auto one = [&] {
    std::vector<double> noise;
    for (int k = 0; k < (edge + 1) * (edge + 1); ++k) noise.push_back(normal(random));
    return surface(edge, edge, 1, [&](double x, double y) {
      const auto at = [&](int i, int j) { return noise[static_cast<std::size_t>(j * (edge + 1) + i)]; };
      const int i = static_cast<int>(x), j = static_cast<int>(y);
      return std::exp(0.2 * (at(i, j) + at(i + 1, j) + at(i, j + 1) + at(i + 1, j + 1)));
    });
  };
  constexpr const char* names[] = {"mean", "Sa", "Sq", "Ssk", "Sku"};
  double sum[5] = {}, squares[5] = {}, told[5] = {};
  for (int k = 0; k < surfaces; ++k) {
    const HeightGrid grid = one();
    const Roughness r = roughness(grid);
    const std::optional<RoughnessError> e = block_bootstrap(grid, grid, 8);
    ASSERT_TRUE(e);
    const double values[] = {height_figures(grid).mean, r.Sa, r.Sq, r.Ssk.value(), r.Sku.value()};
    const double errors[] = {e->mean, e->Sa, e->Sq, e->Ssk.value(), e->Sku.value()};
    for (int q = 0; q < 5; ++q) {
      sum[q] += values[q];
      squares[q] += values[q] * values[q];
      told[q] += errors[q] * errors[q] / surfaces;
    }
  }
  for (int q = 0; q < 5; ++q) {
    const double scatter = std::sqrt((squares[q] - sum[q] * sum[q] / surfaces) / (surfaces - 1));
    // 64 blocks: the bootstrap falls short by their number and by what correlates across their borders.
    EXPECT_NEAR(std::sqrt(told[q]), scatter, 0.2 * scatter) << names[q];
  }
}

TEST(HeightFigures, QuantilesAreLinearBetweenOrderStatistics) {
  std::vector<double> heights;
  for (int k = 1000; k >= 0; --k) heights.push_back(k);
  heights.push_back(std::numeric_limits<double>::quiet_NaN());
  const HeightFigures f = height_figures(heights);
  EXPECT_EQ(f.n, 1001U);
  EXPECT_DOUBLE_EQ(f.mean, 500);
  EXPECT_DOUBLE_EQ(f.min, 0);
  EXPECT_DOUBLE_EQ(f.max, 1000);
  for (std::size_t k = 0; k < told_shares.size(); ++k) EXPECT_NEAR(f.quantile[k], 1000 * told_shares[k], 1e-9);
  EXPECT_NEAR(f.sd, std::sqrt(1001.0 * 1002 / 12), 1e-9);
}

}  // namespace
}  // namespace repose
