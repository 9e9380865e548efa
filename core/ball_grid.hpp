#pragma once
/// Balls in a hashed hierarchy of grids: finds overlaps in constant time for any ratio of sizes.
#include <array>
#include <cstdint>
#include <vector>

#include "core/math.hpp"

namespace repose {

/// A ball of radius in (L/2^(k+1), L/2^k], L the largest radius, is kept at level k, in the one cell of size 2 L/2^k
/// that holds its centre. A query visits, at each level in use, the cells that a centre of an overlapping ball can lie
/// in: at most 27, fewer for a ball smaller than the level.
class BallGrid {
 public:
  /// `largest`: no ball that is added is larger [m]; `count`: how many there will be, about.
  BallGrid(double largest, std::size_t count);

  /// True if a ball here would overlap none.
  bool free(const Vec3& centre, double radius) const;

  void add(const Vec3& centre, double radius);

 private:
  struct Ball {
    Vec3 centre;
    double radius;
    std::int64_t next;  // of the same bucket, -1: none
  };

  std::size_t bucket(std::size_t level, std::int64_t x, std::int64_t y, std::int64_t z) const;

  double largest_;
  std::vector<std::int64_t> first_;  // by bucket; a power of two
  std::vector<Ball> balls_;
  std::vector<bool> used_;  // by level
};

}  // namespace repose
