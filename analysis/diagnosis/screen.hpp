#pragma once
/// Which effects could explain what is left: each effect's first-order gain, against the largest that noise alone would give.
///
/// About the nominal fit with residuals r, the change that an effect makes is a direction d. What start values and calibrated
/// constants can imitate is projected out of it (columns J): with Q an orthonormal basis of (I - P_J) d,
///   gain = |Q^T r|^2     [twice a log likelihood ratio]
/// Under the nominal model r is noise e ~ N(0, I), and the largest gain over all effects follows by drawing e.
#include <string>
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// Residuals and nuisance columns of all fitted runs, ready for projections.
class Nuisance {
 public:
  Nuisance(const Problem& problem, const Fit& fit);
  Eigen::Index size() const { return residual_.size(); }
  const Eigen::VectorXd& residual() const { return residual_; }
  const std::vector<Eigen::Index>& first() const { return first_; }  ///< of each run of the fit
  /// An orthonormal basis of the columns (of all runs, stacked) without what the nuisance can imitate. No columns where nothing is left.
  Eigen::MatrixXd left_of(const Eigen::MatrixXd& columns) const;
  Eigen::VectorXd left_of_vector(const Eigen::VectorXd& stacked) const;

 private:
  Eigen::MatrixXd without_own(const Eigen::MatrixXd& columns) const;
  Eigen::VectorXd residual_;
  std::vector<Eigen::Index> first_;
  std::vector<Eigen::MatrixXd> own_;  ///< orthonormal bases, one per run
  Eigen::MatrixXd shared_;            ///< orthonormal, stacked
};

struct Screened {
  Term term;
  double gain = 0;                     ///< at the best point of the profile, twice the log likelihood ratio
  std::vector<double> shared_start;    ///< the term's shared parameters there
  std::vector<std::vector<double>> own_start;  ///< of each run of the fit
  Eigen::MatrixXd basis;               ///< Q
};

/// The log-spaced profile of one effect: values of its first parameter from the lower to the upper bound (a vector: each
/// component both ways), the others at their first guess, each with a Gauss-Newton step of everything else.
Screened screen(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, const Term& term, int points);

/// Corrected p of the largest gain: share of `replicas` draws of noise whose largest gain over all bases reaches it, never below
/// 1 / (replicas + 1). `quantile99`: the gain that 1 % of the draws exceed.
struct NullDistribution {
  std::vector<double> largest;  ///< ascending
  double p(double gain) const;
  double quantile(double share) const;
};
NullDistribution largest_gains(const std::vector<Eigen::MatrixXd>& bases, Eigen::Index size, int replicas, std::uint64_t seed);

}  // namespace repose::diagnosis
