#pragma once
/// Do two sets of random packings have the same mean? Scatter between seeds, Hotelling's T^2, and the chance to tell apart.
/// A sample is a matrix: one row per replicate, one column per summary.
#include <span>
#include <vector>

#include <Eigen/Core>

namespace repose::diagnosis {

/// S = sum_k sum_i (x_ki - mean_k)(x_ki - mean_k)^T / dof,   dof = sum_k (n_k - 1): one scatter about means of their own.
struct Scatter {
  Eigen::MatrixXd covariance;
  int dof = 0;
};
/// Samples of fewer than two rows add nothing. Rows with NaN are left out.
Scatter pooled_scatter(std::span<const Eigen::MatrixXd> samples);

/// As above with the correlations shrunk towards zero (Schaefer & Strimmer 2005): R* = (1 - lambda) R off the diagonal,
///   lambda = sum Var(r_ij) / sum r_ij^2  over i != j, within [0, 1];   variances stay.
Scatter shrunken_scatter(std::span<const Eigen::MatrixXd> samples);

struct MeanTest {
  double statistic = 0;        ///< T^2
  double p = 1;
  int dimensions = 0;          ///< 0: nothing could be tested
  double dof = 0;              ///< of the denominator
};

/// Hotelling's two-sample test of equal means, normal rows of one covariance:
///   T^2 = delta^T [S (1/n_a + 1/n_b) + M/n_a]^-1 delta,   F = T^2 (nu - d + 1) / (nu d) ~ F(d, nu - d + 1),  nu = n_a + n_b - 2.
/// `extra` M: known variances of the measurement of each row of `a`, not yet in its scatter (zeros: exact test; else approximate).
/// `spent`: parameters that were fitted to `a`; each takes one dimension from d. p = 1 with no dimensions, or too few rows.
MeanTest same_mean(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const Eigen::VectorXd& extra, int spent = 0);

/// Fisher's combination of independent p values: -2 sum ln p ~ chi^2 of twice as many degrees of freedom. 1 if there are none.
double combined_p(std::span<const double> p);

/// ln N(x; 0, C). -infinity if C is not positive definite.
double log_normal_density(const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance);

/// delta^T S^-1 delta.
double squared_distance(const Eigen::VectorXd& delta, const Eigen::MatrixXd& covariance);

/// Chance that n replicates tell two models this far apart at 1 %:  P(N(0, 1) > 2.58 - sqrt(n D^2)).
double chance_to_part(double squared_distance, double n);

/// Rows without NaN.
Eigen::MatrixXd complete_rows(const Eigen::MatrixXd& rows);

}  // namespace repose::diagnosis
