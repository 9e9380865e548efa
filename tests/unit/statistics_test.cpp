#include "analysis/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/error.hpp"

namespace repose {
namespace {

TEST(Summary, HandAnswer) {
  const std::vector<double> v{2, 4, 4, 4, 5, 5, 7, 9};
  const Summary s = summarise(v);
  EXPECT_EQ(s.n, 8u);
  EXPECT_DOUBLE_EQ(s.mean, 5);
  EXPECT_NEAR(s.sd, std::sqrt(32.0 / 7), 1e-14);
  EXPECT_NEAR(s.se, std::sqrt(32.0 / 7 / 8), 1e-14);
}

TEST(Summary, SmallSamples) {
  EXPECT_EQ(summarise({}).n, 0u);
  const std::vector<double> one{3};
  EXPECT_EQ(summarise(one).mean, 3);
  EXPECT_EQ(summarise(one).se, 0);
  const std::vector<double> bad{1, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THROW(summarise(bad), Error);
}

TEST(Line, ExactPoints) {
  const std::vector<double> x{1e6, 1e6 + 1, 1e6 + 2}, y{5, 3, 1};
  const Line line = fit_line(x, y);
  EXPECT_NEAR(line.slope, -2, 1e-12);
  EXPECT_NEAR(line.at(1e6), 5, 1e-6);
  EXPECT_NEAR(line.rms, 0, 1e-6);
}

TEST(Line, HandAnswer) {
  // y = 1/6 + x / 2 with residuals (-1, 2, -1) / 6.
  const std::vector<double> x{0, 1, 2}, y{0, 1, 1};
  const Line line = fit_line(x, y);
  EXPECT_NEAR(line.slope, 0.5, 1e-15);
  EXPECT_NEAR(line.intercept, 1.0 / 6, 1e-15);
  EXPECT_NEAR(line.rms, std::sqrt(1.0 / 18), 1e-15);
  EXPECT_NEAR(line.slope_se, std::sqrt(1.0 / 6 / 2), 1e-15);
  EXPECT_NEAR(line.intercept_se, std::sqrt(1.0 / 6 * (1.0 / 3 + 0.5)), 1e-15);
}

TEST(Line, KnownErrors) {
  const std::vector<double> x{0, 2}, y{1, 5}, sigma{1, 1};
  const Line line = fit_line(x, y, sigma);
  EXPECT_NEAR(line.slope, 2, 1e-15);
  EXPECT_NEAR(line.slope_se, std::sqrt(0.5), 1e-15);
  // A point with a huge error does not count.
  const std::vector<double> x3{0, 2, 1}, y3{1, 5, 100}, s3{1, 1, 1e9};
  EXPECT_NEAR(fit_line(x3, y3, s3).slope, 2, 1e-12);
}

TEST(Line, BadInput) {
  const std::vector<double> same{1, 1}, y{1, 2}, one{1}, zero{0, 1};
  EXPECT_THROW(fit_line(same, y), Error);
  EXPECT_THROW(fit_line(one, one), Error);
  EXPECT_THROW(fit_line(y, one), Error);
  EXPECT_THROW(fit_line(y, y, zero), Error);
}

TEST(StudentT, Tables) {
  EXPECT_NEAR(student_t_quantile(0.975, 1), std::tan(std::numbers::pi * 0.475), 1e-9);
  EXPECT_NEAR(student_t_quantile(0.975, 2), 0.95 * std::sqrt(2 / (1 - 0.95 * 0.95)), 1e-11);
  EXPECT_NEAR(student_t_quantile(0.975, 7), 2.3646242515927844, 1e-11);
  EXPECT_NEAR(student_t_quantile(0.95, 10), 1.8124611228107335, 1e-11);
  EXPECT_NEAR(student_t_quantile(0.975, 1000), 1.9623390808264078, 1e-9);
  EXPECT_NEAR(student_t_quantile(0.025, 7), -2.3646242515927844, 1e-11);
  EXPECT_NEAR(student_t_quantile(0.5, 3), 0, 1e-12);
  EXPECT_THROW(student_t_quantile(1, 3), Error);
  EXPECT_THROW(student_t_quantile(0.9, 0), Error);
}

}  // namespace
}  // namespace repose
