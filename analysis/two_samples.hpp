#pragma once
/// Do two small samples have the same mean? Paired and Welch's t test, and Holm's correction for many questions.
#include <span>
#include <vector>

namespace repose {

/// The difference of two means, a - b.
struct MeanDifference {
  double value = 0;   ///< mean(a) - mean(b), unit of the samples
  double se = 0;      ///< its standard error
  double dof = 0;     ///< degrees of freedom of the error, may be broken; 0 if there is no error
  double t = 0;       ///< value / se; 0 if both are 0, infinite with its sign if only se is
  double p = 1;       ///< two-sided, of Student's distribution; 0 if t is infinite

  /// One-sided: how likely so large a difference is, or a larger one, if a is not greater than b.
  double p_greater() const { return value > 0 ? p / 2 : 1 - p / 2; }
};

/// a_i and b_i belong together (the same grains): se = sd(a_i - b_i) / sqrt(n), dof = n - 1. Throws Error unless both have the
/// same length n >= 2 and are finite.
MeanDifference paired_difference(std::span<const double> a, std::span<const double> b);

/// Independent samples of unlike scatter (Welch 1947): se^2 = s_a^2/n_a + s_b^2/n_b, dof after Satterthwaite. Throws Error
/// unless both have at least two values and all are finite.
MeanDifference welch_difference(std::span<const double> a, std::span<const double> b);

/// P(|T| >= |t|) of Student's distribution; `dof` > 0.
double student_two_sided(double t, double dof);

/// p values corrected for how many they are (Holm 1979): rejecting those below alpha is wrong once or more in at most a
/// share alpha of all families, whatever depends on what. In the order given; each at most 1.
std::vector<double> holm(std::span<const double> p);

}  // namespace repose
