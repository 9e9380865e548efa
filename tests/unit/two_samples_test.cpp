#include "analysis/two_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/error.hpp"

namespace repose {
namespace {

TEST(TwoSamples, StudentsDistribution) {
  EXPECT_NEAR(student_two_sided(1, 1), 0.5, 1e-12);                    // Cauchy
  EXPECT_NEAR(student_two_sided(2, 2), 1 - 2 / std::sqrt(6.0), 1e-12);  // 1 - t / sqrt(2 + t^2)
  EXPECT_NEAR(student_two_sided(-2, 2), student_two_sided(2, 2), 1e-15);
  EXPECT_NEAR(student_two_sided(1.959963984540054, 1e9), 0.05, 1e-8);
}

TEST(TwoSamples, PairedByHand) {
  // Differences 1, 2, 3: mean 2, sd 1, se 1/sqrt(3).
  const std::vector<double> a{11, 22, 33}, b{10, 20, 30};
  const MeanDifference d = paired_difference(a, b);
  EXPECT_DOUBLE_EQ(d.value, 2);
  EXPECT_NEAR(d.se, 1 / std::sqrt(3.0), 1e-15);
  EXPECT_EQ(d.dof, 2);
  EXPECT_NEAR(d.t, 2 * std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(d.p, 1 - d.t / std::sqrt(2 + d.t * d.t), 1e-12);
}

TEST(TwoSamples, WelchByHand) {
  // Variances 2 and 8 of two values each: se^2 = 1 + 4, dof = 25 / (1 + 16).
  const std::vector<double> a{0, 2}, b{8, 12};
  const MeanDifference d = welch_difference(a, b);
  EXPECT_DOUBLE_EQ(d.value, -9);
  EXPECT_NEAR(d.se, std::sqrt(5.0), 1e-14);
  EXPECT_NEAR(d.dof, 25.0 / 17, 1e-14);
}

TEST(TwoSamples, WithoutScatter) {
  const std::vector<double> a{1, 1, 1}, b{2, 2, 2};
  EXPECT_EQ(paired_difference(a, a).p, 1);
  EXPECT_EQ(paired_difference(a, b).p, 0);
  EXPECT_TRUE(std::isinf(paired_difference(a, b).t));
  EXPECT_EQ(welch_difference(a, a).p, 1);
}

TEST(TwoSamples, FalseAlarmsAreAsRareAsStated) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  int paired = 0, welch = 0;
  const int trials = 4000;
  for (int k = 0; k < trials; ++k) {
    std::vector<double> a, b;
    for (int i = 0; i < 5; ++i) {
      const double common = normal(random);
      a.push_back(common + normal(random));
      b.push_back(common + normal(random));
    }
    paired += paired_difference(a, b).p < 0.05;
    welch += welch_difference(a, b).p < 0.05;
  }
  // 5 % of 4000: 200, standard deviation 14.
  EXPECT_NEAR(paired, 200, 4 * 14);
  EXPECT_LT(welch, 200);  // pairs that resemble each other make Welch's test shy
}

TEST(TwoSamples, HolmByHand) {
  const std::vector<double> p{0.04, 0.01, 0.03, 0.9};
  const std::vector<double> h = holm(p);
  EXPECT_NEAR(h[1], 0.04, 1e-15);
  EXPECT_NEAR(h[2], 0.09, 1e-15);
  EXPECT_NEAR(h[0], 0.09, 1e-15);  // 2 * 0.04, but never below the one before
  EXPECT_NEAR(h[3], 0.9, 1e-15);
  EXPECT_TRUE(holm({}).empty());
}

TEST(TwoSamples, BadSamples) {
  const std::vector<double> one{1}, two{1, 2}, bad{1, std::nan("")};
  EXPECT_THROW(paired_difference(one, one), Error);
  EXPECT_THROW(paired_difference(one, two), Error);
  EXPECT_THROW(paired_difference(two, bad), Error);
  EXPECT_THROW(welch_difference(one, two), Error);
}

}  // namespace
}  // namespace repose
