#pragma once
/// Draws sizes from a SizeDistribution by the inverse of its cumulative number distribution.
#include <vector>

#include "core/population.hpp"
#include "core/random.hpp"

namespace repose {

/// A continuous law is tabulated on 16384 cells with a density that is linear within each (relative error of a moment
/// below 1e-6); a table of sizes or a fixed size is exact. One draw costs one random number and a bisection, however
/// narrow the range. Throws Error for parameters that are not positive and finite, for lower > upper, and for a range
/// that holds less than 0.1 % of the law.
class SizeSampler {
 public:
  explicit SizeSampler(const SizeDistribution& distribution);

  double draw(Random& random) const;  ///< [m]
  double mean_cube() const;           ///< mean of d^3 by number [m^3]

 private:
  void tabulate(const SizeDistribution& distribution);

  double lower_ = 0, upper_ = 0;  // of a continuous law [m]
  bool discrete_ = false;
  bool logarithmic_ = false;  // nodes_ are ln(d / unit_), else d / unit_
  double unit_ = 1;           // [m]; makes everything below dimensionless
  std::vector<double> nodes_;
  std::vector<double> density_;     // continuous: at the nodes, with respect to the nodes' variable
  std::vector<double> cumulative_;  // up to and including node i; ends at 1
};

}  // namespace repose
