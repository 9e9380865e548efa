#include "analysis/diagnosis/turning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace repose::diagnosis {
namespace {

constexpr double rate = 0.9;  // rad from sample to sample: seven samples are a revolution

std::vector<Quat> turning_about(const Vec3& axis, int samples) {
  std::vector<Quat> list;
  const Quat first(0.5, 0.5, -0.5, 0.5);
  for (int i = 0; i < samples; ++i) list.push_back(Quat(Eigen::AngleAxisd(rate * i, axis.normalized())) * first);
  return list;
}

TEST(Turns, GrowBeyondARevolution) {
  const Vec3 axis(1, 2, 2);
  const auto turns = turns_of(turning_about(axis, 40));
  for (int i = 0; i < 40; ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(turns[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)], rate * i * axis[k] / 3, 1e-9);
}

TEST(Turns, DoNotSeeTheSignOfAQuaternion) {
  std::vector<Quat> list = turning_about(Vec3(0, 0, 1), 12);
  for (std::size_t i = 1; i < list.size(); i += 2) list[i].coeffs() *= -1;
  EXPECT_NEAR(turns_of(list)[2].back(), 11 * rate, 1e-9);
}

TEST(Turns, GoOnBehindAGap) {
  std::vector<Quat> list = turning_about(Vec3(0, 1, 0), 9);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  list[3] = list[4] = Quat(nan, nan, nan, nan);  // 2.7 rad, less than half a revolution
  const auto turns = turns_of(list);
  EXPECT_TRUE(std::isnan(turns[1][3]));
  EXPECT_NEAR(turns[1].back(), 8 * rate, 1e-9);
}

TEST(Turns, OfNothingAreNothing) { EXPECT_TRUE(turns_of({})[0].empty()); }

}  // namespace
}  // namespace repose::diagnosis
