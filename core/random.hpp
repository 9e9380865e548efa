#pragma once
/// Random numbers that depend on the seed alone, not on the standard library's distributions.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "core/math.hpp"

namespace repose {

/// One stream of random numbers. Streams of the same seed with different numbers are independent of each other.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) : engine_(mixed(mixed(seed) + stream)) {}

  /// Uniform in the open interval (0, 1).
  double uniform() { return (static_cast<double>(engine_() >> 12) + 0.5) * 0x1p-52; }

  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }

  /// Uniform in 0 ... n-1, n > 0, without bias.
  std::uint64_t below(std::uint64_t n) {
    const std::uint64_t excess = (~n + 1) % n;  // 2^64 mod n
    std::uint64_t draw;
    do draw = engine_();
    while (draw < excess);
    return draw % n;
  }

  /// Uniform over all rotations (Shoemake 1992).
  Quat rotation() {
    const double u = uniform(), a = 2 * std::numbers::pi * uniform(), b = 2 * std::numbers::pi * uniform();
    const double p = std::sqrt(1 - u), q = std::sqrt(u);
    return Quat(q * std::cos(b), p * std::sin(a), p * std::cos(a), q * std::sin(b)).normalized();
  }

 private:
  // SplitMix64: spreads neighbouring seeds over all bits.
  static std::uint64_t mixed(std::uint64_t z) {
    z += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  std::mt19937_64 engine_;
};

}  // namespace repose
