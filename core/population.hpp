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
  double lower = 0;      ///< [m]; draws outside [lower, upper] are rejected and drawn again (truncated, never clipped)
  double upper = 1e300;  ///< [m]
  bool by_volume = false;  ///< the law is that of the volume, not of the number: number density = law(d) / d^3
};

struct GrainKind {
  int shape = 0;    ///< index into the list of shapes of the mix
  double size = 0;  ///< [m]
};

/// Draws `count` grains. `shares` (one per shape, >= 0, sum > 0) are shares by number, or by mass if `by_mass`: then the
/// shares by number are found from the mean volume, which is the same for all shapes, so both agree in expectation and
/// the mass shares of the sample are met by drawing each shape's share of the total volume.
std::vector<GrainKind> draw_grains(const SizeDistribution& size, const std::vector<double>& shares, bool by_mass,
                                   std::size_t count, std::uint64_t seed);

}  // namespace repose
