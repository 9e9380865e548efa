#include "core/population.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr double um = 1e-6;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

SizeDistribution powder() { return {NormalSize{58 * um, 15 * um}, 30 * um, 100 * um, false}; }

std::vector<double> sizes(const SizeDistribution& d, std::size_t n, std::uint64_t seed = 1) {
  std::vector<double> result;
  for (const GrainKind& g : draw_grains(d, {1}, false, n, seed)) result.push_back(g.size);
  return result;
}

double moment(const std::vector<double>& v, int power) {
  double sum = 0;
  for (double x : v) sum += std::pow(x, power);
  return sum / static_cast<double>(v.size());
}

double sd_of(const std::vector<double>& v) { return std::sqrt(moment(v, 2) - moment(v, 1) * moment(v, 1)); }

// Distribution functions for the test of Kolmogorov and Smirnov.
double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

template <class Cdf>
double largest_departure(std::vector<double> v, const Cdf& cdf) {
  std::sort(v.begin(), v.end());
  double most = 0;
  const double n = static_cast<double>(v.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double f = cdf(v[i]), k = static_cast<double>(i);
    most = std::max({most, std::abs(f - k / n), std::abs(f - (k + 1) / n)});
  }
  return most * std::sqrt(n);  // above 1.95 with probability 1e-3
}

TEST(Population, TruncatedNormalHasItsMoments) {
  // a, b: ends of the range in standard deviations; mean = m + s (phi(a) - phi(b))/Z and so on.
  const double m = 58, s = 15, a = (30 - m) / s, b = (100 - m) / s;
  const auto phi = [](double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); };
  const double z = normal_cdf(b) - normal_cdf(a), ratio = (phi(a) - phi(b)) / z;
  const double mean = m + s * ratio, variance = s * s * (1 + (a * phi(a) - b * phi(b)) / z - ratio * ratio);

  const std::size_t n = 1'000'000;
  const std::vector<double> d = sizes(powder(), n);
  EXPECT_NEAR(moment(d, 1) / um, mean, 4 * std::sqrt(variance / n));
  EXPECT_NEAR(sd_of(d) / um, std::sqrt(variance), 4 * std::sqrt(variance / (2.0 * n)));
  EXPECT_GE(*std::min_element(d.begin(), d.end()), 30 * um);
  EXPECT_LE(*std::max_element(d.begin(), d.end()), 100 * um);
  EXPECT_EQ(std::count(d.begin(), d.end(), 30 * um) + std::count(d.begin(), d.end(), 100 * um), 0);
  EXPECT_LT(largest_departure(d, [&](double x) { return (normal_cdf((x / um - m) / s) - normal_cdf(a)) / z; }), 1.95);
}

TEST(Population, MeanVolumeIsThatOfTheSample) {
  SizeDistribution lognormal{LogNormalSize{58 * um, 0.3}};
  // E d^3 of a lognormal law: median^3 exp(9 s^2 / 2).
  EXPECT_NEAR(mean_volume(lognormal) / (std::numbers::pi / 6 * std::pow(58 * um, 3) * std::exp(4.5 * 0.09)), 1, 1e-6);
  EXPECT_NEAR(mean_volume(powder()) / (std::numbers::pi / 6 * moment(sizes(powder(), 1'000'000), 3)), 1, 3e-3);
  EXPECT_DOUBLE_EQ(mean_volume({FixedSize{2}}), std::numbers::pi / 6 * 8);
  EXPECT_DOUBLE_EQ(mean_volume({TableSize{{1, 2}}}), std::numbers::pi / 6 * 4.5);
}

TEST(Population, LogNormalByNumberAndByVolume) {
  const double s = 0.25;
  SizeDistribution d{LogNormalSize{1, s}};
  EXPECT_LT(largest_departure(sizes(d, 200'000), [&](double x) { return normal_cdf(std::log(x) / s); }), 1.95);
  // Weighted by d^-3 the law stays lognormal with median exp(-3 s^2).
  d.by_volume = true;
  EXPECT_LT(largest_departure(sizes(d, 200'000), [&](double x) { return normal_cdf(std::log(x) / s + 3 * s); }), 1.95);
}

TEST(Population, NormalByVolumeWeighsBackToNormal) {
  SizeDistribution d = powder();
  d.by_volume = true;
  std::vector<double> v = sizes(d, 1'000'000);
  // The sample weighted by volume has the moments of the truncated normal law.
  const double mean = moment(v, 4) / moment(v, 3), square = moment(v, 5) / moment(v, 3);
  const std::vector<double> plain = sizes(powder(), 1'000'000, 2);
  EXPECT_NEAR(mean / moment(plain, 1), 1, 2e-3);
  EXPECT_NEAR(std::sqrt(square - mean * mean) / sd_of(plain), 1, 5e-3);
  EXPECT_LT(moment(v, 1), 0.85 * moment(plain, 1));
  EXPECT_GE(*std::min_element(v.begin(), v.end()), 30 * um);

  // A sharp law in a wide range, and a wide law down to tiny grains, are resolved as well.
  const SizeDistribution sharp{NormalSize{1, 1e-5}, 0.1, 10, true};
  const std::vector<double> narrow = sizes(sharp, 100'000);
  EXPECT_NEAR(moment(narrow, 1), 1, 2e-7);
  EXPECT_NEAR(sd_of(narrow), 1e-5, 2e-7);
  const SizeDistribution tiny{NormalSize{1, 0.3}, 1e-4, 2, true};
  // Nearly all grains are the smallest ones, where the law is flat: P(d < x) = 1 - (lower/x)^2.
  EXPECT_LT(largest_departure(sizes(tiny, 10'000), [](double x) { return 1 - 1e-8 / (x * x); }), 1.95);
}

TEST(Population, TableIsDrawnWithReplacement) {
  const SizeDistribution d{TableSize{{1, 2, 3, 50}}, 0.5, 10, false};
  const std::vector<double> v = sizes(d, 30'000);
  for (double size : {1.0, 2.0, 3.0}) EXPECT_NEAR(static_cast<double>(std::count(v.begin(), v.end(), size)), 1e4, 400);
  const SizeDistribution by_volume{TableSize{{1, 2}}, 0.5, 10, true};
  const std::vector<double> w = sizes(by_volume, 90'000);
  EXPECT_NEAR(static_cast<double>(std::count(w.begin(), w.end(), 2.0)), 1e4, 400);
}

TEST(Population, SharesByNumberAreMetToWithinOneGrain) {
  const std::vector<double> shares{1, 2.5, 0, 0.25, 3};
  for (std::size_t n : {0u, 1u, 7u, 1000u, 12345u}) {
    const auto grains = draw_grains(powder(), shares, false, n, 3);
    ASSERT_EQ(grains.size(), n);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const auto count = std::count_if(grains.begin(), grains.end(),
                                       [&](const GrainKind& g) { return g.shape == static_cast<int>(i); });
      EXPECT_LT(std::abs(static_cast<double>(count) - shares[i] / 6.75 * static_cast<double>(n)), 1);
      EXPECT_TRUE(count == 0 || shares[i] > 0);
    }
  }
}

TEST(Population, SharesByMassAreMetToWithinOneGrain) {
  const std::vector<double> shares{1, 3, 0};
  const auto grains = draw_grains(powder(), shares, true, 10'000, 4);
  std::vector<double> volume(3), count(3), size(3);
  double total = 0;
  for (const GrainKind& g : grains) {
    const double v = std::pow(g.size, 3);
    total += v;
    volume[static_cast<std::size_t>(g.shape)] += v;
    count[static_cast<std::size_t>(g.shape)] += 1;
    size[static_cast<std::size_t>(g.shape)] += g.size;
  }
  EXPECT_NEAR(volume[0], 0.25 * total, std::pow(100 * um, 3));
  EXPECT_EQ(count[2], 0);
  // Sizes have one law: shares by number agree in expectation, and so do the mean sizes.
  EXPECT_NEAR(count[0], 2500, 200);
  EXPECT_NEAR(size[0] / count[0], size[1] / count[1], 5 * 14 * um / std::sqrt(2500.0));
}

TEST(Population, OrderIsRandom) {
  for (bool by_mass : {false, true}) {
    const auto grains = draw_grains(powder(), {1, 1}, by_mass, 10'000, 5);
    const auto first_half =
        std::count_if(grains.begin(), grains.begin() + 5000, [](const GrainKind& g) { return g.shape == 0; });
    EXPECT_NEAR(static_cast<double>(first_half), 2500, 200) << by_mass;
  }
}

TEST(Population, SeedDeterminesEverything) {
  for (bool by_mass : {false, true}) {
    const auto a = draw_grains(powder(), {1, 2}, by_mass, 1000, 42),
               b = draw_grains(powder(), {1, 2}, by_mass, 1000, 42),
               c = draw_grains(powder(), {1, 2}, by_mass, 1000, 43);
    std::size_t same = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i].size, b[i].size);
      EXPECT_EQ(a[i].shape, b[i].shape);
      same += a[i].size == c[i].size;
    }
    EXPECT_LT(same, 5u);
  }
}

TEST(Population, RefusesWhatCannotBeDrawn) {
  const std::vector<SizeDistribution> bad{
      {FixedSize{0}},
      {FixedSize{-1}},
      {FixedSize{nan}},
      {FixedSize{5}, 1, 2},
      {NormalSize{nan, 1}},
      {NormalSize{-1, 1}},
      {NormalSize{1, -1}},
      {NormalSize{1, 0.1}, 2, 1},
      {NormalSize{1, 0.1}, nan, 2},
      {NormalSize{1, 0.1}, 2, 3},          // ten standard deviations away
      {NormalSize{1, 0.1}, 1, 1.0000001},  // next to nothing of the law
      {NormalSize{1, 0.3}, 0, 2, true},    // by volume down to no size at all
      {LogNormalSize{0, 0.1}},
      {LogNormalSize{1, -0.1}},
      {LogNormalSize{1, 0.1}, 5, 6},
      {TableSize{}},
      {TableSize{{1, -2}}},
      {TableSize{{1, 2}}, 5, 6},
  };
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_THROW(draw_grains(bad[i], {1}, false, 10, 1), Error) << i;
    EXPECT_THROW(mean_volume(bad[i]), Error) << i;
  }
  const SizeDistribution good{FixedSize{1}};
  for (const std::vector<double>& shares : std::vector<std::vector<double>>{{}, {0, 0}, {1, -1}, {nan}})
    EXPECT_THROW(draw_grains(good, shares, false, 10, 1), Error);
  EXPECT_THROW(draw_grains(good, {1}, false, 1'000'000'000, 1), Error);
}

}  // namespace
}  // namespace repose
