#pragma once
/// Small samples: mean, scatter, straight lines, and the quantile that turns a standard error into an interval.
#include <cstddef>
#include <span>

namespace repose {

/// Mean and scatter of a sample; the unit is that of the values.
struct Summary {
  std::size_t n = 0;
  double mean = 0;
  double sd = 0;  ///< with n - 1 in the denominator; 0 if n < 2
  double se = 0;  ///< sd / sqrt(n): of the mean, if the values are independent
};

/// Throws Error if a value is not finite. An empty sample gives n = 0.
Summary summarise(std::span<const double> values);

/// y = intercept + slope x by least squares.
struct Line {
  std::size_t n = 0;
  double slope = 0, intercept = 0;
  double slope_se = 0;      ///< see fit_line
  double intercept_se = 0;  ///< of the value at x = 0
  double rms = 0;           ///< root mean square residual, unit of y
  double at(double x) const { return intercept + slope * x; }
};

/// Ordinary least squares. The errors come from the scatter about the line (n - 2 degrees of freedom; 0 if n = 2).
/// Needs at least two different x; throws Error otherwise, or if a value is not finite.
Line fit_line(std::span<const double> x, std::span<const double> y);

/// Least squares with known standard deviations `sigma` > 0 of y: the errors come from these, not from the scatter.
Line fit_line(std::span<const double> x, std::span<const double> y, std::span<const double> sigma);

/// The t with P(T <= t) = `probability` for Student's distribution with `dof` >= 1 degrees of freedom.
/// `probability` in (0, 1).
double student_t_quantile(double probability, int dof);

}  // namespace repose
