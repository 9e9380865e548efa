#include "analysis/diagnosis/nuisance.hpp"

#include <algorithm>

#include <Eigen/Dense>

namespace repose::diagnosis {
namespace {

// Share of a direction that must be left, of what the nuisance imitates and of what the other columns of a probe do (a ball that rolls is slowed by its weight as by
// a force from the front). Below it what is left is the error of derivatives by differences: a fit that has not quite arrived would look like a force that
// nobody can tell from its start, and the noise of the recording, which turns with an orientation, would be its own witness.
constexpr double negligible = 1e-2;
constexpr double rounding = 1e-9;

/// Orthonormal basis of the columns; those of which others leave no more than the share `least` are dropped.
Eigen::MatrixXd basis_of(const Eigen::MatrixXd& columns, double least) {
  if (columns.cols() == 0) return columns;
  Eigen::MatrixXd scaled = columns;
  for (Eigen::Index i = 0; i < scaled.cols(); ++i)
    if (const double size = scaled.col(i).norm(); size > 0) scaled.col(i) /= size;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  qr.setThreshold(least);
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
}

}  // namespace

Nuisance::Nuisance(const Problem& problem, const Fit& fit) {
  Eigen::Index total = 0;
  std::vector<RunJacobian> jacobians;
  for (std::size_t i = 0; i < fit.runs.size(); ++i) {
    first_.push_back(total);
    total += fit.residual[i].size();
    jacobians.push_back(jacobian(problem, fit, fit.runs[i]));
  }
  first_.push_back(total);
  residual_.resize(total);
  Eigen::MatrixXd shared(total, static_cast<Eigen::Index>(fit.layout.shared.size()));
  for (std::size_t i = 0; i < fit.runs.size(); ++i) {
    residual_.segment(first_[i], fit.residual[i].size()) = fit.residual[i];
    own_.push_back(basis_of(jacobians[i].own, rounding));
    shared.middleRows(first_[i], fit.residual[i].size()) = jacobians[i].shared;
  }
  shared_ = basis_of(without_own(shared), rounding);
}

Eigen::MatrixXd Nuisance::without_own(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd left = columns;
  for (std::size_t i = 0; i < own_.size(); ++i) {
    auto block = left.middleRows(first_[i], first_[i + 1] - first_[i]);
    if (own_[i].cols() > 0) block -= own_[i] * (own_[i].transpose() * block).eval();
  }
  return left;
}

Eigen::MatrixXd Nuisance::left_of(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd left = without_own(columns);
  if (shared_.cols() > 0) left -= shared_ * (shared_.transpose() * left).eval();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < left.cols(); ++i)
    if (left.col(i).norm() > std::max(negligible * columns.col(i).norm(), 1e-9)) kept.push_back(i);
  Eigen::MatrixXd result(left.rows(), static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = left.col(kept[i]);
  return basis_of(result, negligible);
}

Eigen::VectorXd Nuisance::left_of_vector(const Eigen::VectorXd& stacked) const {
  Eigen::MatrixXd left = without_own(stacked);
  if (shared_.cols() > 0) left -= shared_ * (shared_.transpose() * left).eval();
  return left.col(0);
}

}  // namespace repose::diagnosis
