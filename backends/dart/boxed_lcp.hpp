#pragma once
/// The linear complementarity problem of one island of touching bodies, with bounds that hang on other unknowns.
///
///   A x = b + w,   lo <= x <= hi,   w_i >= 0 where x_i = lo_i,  w_i <= 0 where x_i = hi_i,  else w_i = 0
///
/// where a row i with parent k = parent[i] >= 0 (friction) has the bounds lo_i x_k, hi_i x_k of its own normal row k.
///
/// Solved by DART's Dantzig pivoting, which is direct but knows constant bounds only: on its own it takes them from the
/// problem without friction. So it is repeated with the bounds of the last pass until the problem as stated holds; when
/// pivoting breaks down or the passes do not settle, DART's projected Gauss-Seidel goes on from the best point so far.
/// How time grows with the number of rows: README.md.
#include <span>

namespace repose::dart {

struct BoxedLcp {
  int rows = 0;
  int stride = 0;             ///< distance of two rows of A
  std::span<const double> a;  ///< symmetric, positive diagonal
  std::span<const double> b, lo, hi;
  std::span<const int> parent;  ///< -1: bounds are as they stand
};

struct LcpReport {
  int passes = 0;         ///< pivoting passes, or ten sweeps of Gauss-Seidel each
  double residual = 0;    ///< largest violation of the problem as stated, as a velocity, over the largest A_ii |x_i|
  bool converged = true;  ///< residual <= tolerance
  bool swept = false;     ///< Gauss-Seidel had to be used
};

/// max_i A_ii |x_i - clamp(x_i - w_i / A_ii)| / max_i A_ii |x_i|; 0 if both are zero.
double residual(const BoxedLcp& problem, std::span<const double> x);

/// Out: x, the best point found.
LcpReport solve(const BoxedLcp& problem, double tolerance, int max_passes, std::span<double> x);

}  // namespace repose::dart
