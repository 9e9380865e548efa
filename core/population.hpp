#pragma once
/// Populations of grains: which shapes, which sizes, how many. The same seed gives the same grains on every backend.
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/grain_shape.hpp"

namespace repose {

/// Size = diameter of the sphere of equal volume [m].
struct NormalSize {
  double mean = 0, sd = 0;  ///< [m], of the distribution before truncation
};
struct LogNormalSize {
  double median = 0;   ///< [m]
  double log_sd = 0;   ///< standard deviation of ln(size) [1]
};
struct FixedSize {
  double value = 0;  ///< [m]
};
/// Measured sizes, drawn with replacement.
struct TableSize {
  std::vector<double> values;  ///< [m]
};

struct SizeDistribution {
  std::variant<FixedSize, NormalSize, LogNormalSize, TableSize> law = FixedSize{};
  double lower = 0;      ///< [m]; the law is truncated to [lower, upper], never clipped; a range that holds less than
                         ///< 0.1 % of it is an Error
  double upper = 1e300;  ///< [m]
  bool by_volume = false;  ///< the law is that of the volume, not of the number: number density = law(d) / d^3
};

/// Mean volume of a grain [m^3], by number. Throws Error for an impossible distribution.
double mean_volume(const SizeDistribution& size);

struct GrainKind {
  int shape = 0;    ///< index into the list of shapes of the mix
  double size = 0;  ///< [m]
};

/// Draws `count` grains. `shares` (one per shape, >= 0, sum > 0) are shares by number, met to within one grain, or by mass
/// if `by_mass`, met to within the volume of one grain. Sizes have the same law for all shapes, so both agree in
/// expectation. The order is random. Throws Error for impossible sizes or shares, and for more than 1e8 grains.
std::vector<GrainKind> draw_grains(const SizeDistribution& size, const std::vector<double>& shares, bool by_mass,
                                   std::size_t count, std::uint64_t seed);

}  // namespace repose
