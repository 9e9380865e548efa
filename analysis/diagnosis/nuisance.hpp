#pragma once
/// What start values and calibrated constants can imitate, projected out.
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// Residuals and nuisance columns of all fitted runs, stacked, ready for projections.
class Nuisance {
 public:
  Nuisance(const Problem& problem, const Fit& fit);
  Eigen::Index size() const { return residual_.size(); }
  const Eigen::VectorXd& residual() const { return residual_; }
  const std::vector<Eigen::Index>& first() const { return first_; }  ///< of each run of the fit, and the end
  Eigen::Index size(std::size_t run) const { return first_[run + 1] - first_[run]; }
  /// An orthonormal basis of the columns without what the nuisance can imitate. No columns where nothing is left; fewer where one does what others do.
  Eigen::MatrixXd left_of(const Eigen::MatrixXd& columns) const;
  Eigen::VectorXd left_of_vector(const Eigen::VectorXd& stacked) const;

 private:
  Eigen::MatrixXd without_own(const Eigen::MatrixXd& columns) const;
  Eigen::VectorXd residual_;
  std::vector<Eigen::Index> first_;
  std::vector<Eigen::MatrixXd> own_;  ///< orthonormal bases, one per run
  Eigen::MatrixXd shared_;            ///< orthonormal, stacked
};

}  // namespace repose::diagnosis
