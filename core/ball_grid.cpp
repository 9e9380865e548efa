#include "core/ball_grid.hpp"

#include <bit>
#include <cassert>
#include <cmath>

namespace repose {

BallGrid::BallGrid(double largest, std::size_t count) : largest_(largest), first_(std::bit_ceil(2 * count + 1), -1) {
  balls_.reserve(count);
}

// Balls of other cells that share the bucket are met too; the test of the distance is all that counts.
std::size_t BallGrid::bucket(std::size_t level, std::int64_t x, std::int64_t y, std::int64_t z) const {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15;
  h = (h ^ static_cast<std::uint64_t>(y)) * 0xbf58476d1ce4e5b9;
  h = (h ^ (h >> 29) ^ static_cast<std::uint64_t>(z)) * 0x94d049bb133111eb;
  h = (h ^ (h >> 31) ^ level) * 0x9e3779b97f4a7c15;
  return static_cast<std::size_t>(h >> 32) & (first_.size() - 1);
}

bool BallGrid::free(const Vec3& centre, double radius) const {
  for (std::size_t level = 0; level < used_.size(); ++level) {
    if (!used_[level]) continue;
    const double reach = std::ldexp(largest_, -static_cast<int>(level)), cell = 2 * reach, range = radius + reach;
    std::array<std::int64_t, 3> low, high;
    for (int i = 0; i < 3; ++i) {
      low[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::floor((centre[i] - range) / cell));
      high[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::floor((centre[i] + range) / cell));
    }
    for (std::int64_t z = low[2]; z <= high[2]; ++z)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t x = low[0]; x <= high[0]; ++x)
          for (std::int64_t b = first_[bucket(level, x, y, z)]; b >= 0; b = balls_[static_cast<std::size_t>(b)].next) {
            const Ball& ball = balls_[static_cast<std::size_t>(b)];
            const double sum = ball.radius + radius;
            if ((ball.centre - centre).squaredNorm() < sum * sum) return false;
          }
  }
  return true;
}

void BallGrid::add(const Vec3& centre, double radius) {
  assert(radius > 0 && radius <= largest_);
  const auto level = static_cast<std::size_t>(std::ilogb(largest_ / radius));
  const double cell = 2 * std::ldexp(largest_, -static_cast<int>(level));
  const auto index = [&](int i) { return static_cast<std::int64_t>(std::floor(centre[i] / cell)); };
  std::int64_t& head = first_[bucket(level, index(0), index(1), index(2))];
  balls_.push_back({centre, radius, head});
  head = static_cast<std::int64_t>(balls_.size()) - 1;
  if (used_.size() <= level) used_.resize(level + 1, false);
  used_[level] = true;
}

}  // namespace repose
