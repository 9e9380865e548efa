#include "analysis/diagnosis/bulk_emulator.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"

namespace repose::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double beta_variance = 25;                 // of the mean, in units of the values' variance
constexpr double usual_length = 0.5, length_spread = 1;  // log-normal priors
constexpr double usual_tau = 1, tau_spread = 1.5;

double matern(double r) {
  const double q = std::sqrt(5.0) * r;
  return (1 + q + q * q / 3) * std::exp(-q);
}

/// r^2 of each group, then of all axes; one group: of all alone. `squares`: ((u - u') / l)^2 of each axis.
VectorXd squared_radii(const VectorXd& squares, const std::vector<int>& groups) {
  const int count = groups.empty() ? 1 : *std::max_element(groups.begin(), groups.end()) + 1;
  if (count == 1) return VectorXd::Constant(1, squares.sum());
  VectorXd radii = VectorXd::Zero(count + 1);
  for (Index k = 0; k < squares.size(); ++k) radii[groups[static_cast<std::size_t>(k)]] += squares[k];
  radii[count] = squares.sum();
  return radii;
}

/// k(u, u') / tau^2.
double similarity(const VectorXd& squares, const std::vector<int>& groups) {
  return squared_radii(squares, groups).unaryExpr([](double r2) { return matern(std::sqrt(r2)); }).mean();
}

/// d similarity / d ln l_k = (5/3) (1 + q) e^-q squares_k, summed over the radii that hold the axis.
VectorXd slopes(const VectorXd& squares, const std::vector<int>& groups) {
  const VectorXd each = squared_radii(squares, groups).unaryExpr([](double r2) {
    const double q = std::sqrt(5 * r2);
    return 5.0 / 3 * (1 + q) * std::exp(-q);
  });
  VectorXd result(squares.size());
  for (Index k = 0; k < squares.size(); ++k) {
    const double of_group = each.size() > 1 ? each[groups[static_cast<std::size_t>(k)]] : 0;
    result[k] = (of_group + each[each.size() - 1]) * squares[k] / static_cast<double>(each.size());
  }
  return result;
}

/// Minus the log of likelihood times priors, and its gradient, in (ln l_1, ..., ln l_d, ln tau).
class Posterior final : public ceres::FirstOrderFunction {
 public:
  Posterior(const MatrixXd& points, const VectorXd& values, const VectorXd& noise, const std::vector<int>& groups)
      : points_(points), values_(values), noise_(noise), groups_(groups) {}
  int NumParameters() const override { return static_cast<int>(points_.cols()) + 1; }

  bool Evaluate(const double* const x, double* cost, double* gradient) const override {
    const Index n = points_.rows(), d = points_.cols();
    const double tau2 = std::exp(2 * x[d]);
    MatrixXd smooth(n, n);
    std::vector<MatrixXd> slope(static_cast<std::size_t>(d), MatrixXd::Zero(n, n));
    const VectorXd inverse = (-Eigen::Map<const VectorXd>(x, d)).array().exp();
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        const VectorXd squares = (points_.row(i) - points_.row(j)).transpose().cwiseProduct(inverse).cwiseAbs2();
        smooth(i, j) = tau2 * similarity(squares, groups_);
        if (gradient == nullptr) continue;
        const VectorXd by_length = slopes(squares, groups_);
        for (Index k = 0; k < d; ++k) slope[static_cast<std::size_t>(k)](i, j) = tau2 * by_length[k];
      }
    MatrixXd all = smooth;
    all.array() += beta_variance;
    all.diagonal() += noise_;
    const Eigen::LLT<MatrixXd> factor(all);
    if (factor.info() != Eigen::Success) return false;
    const VectorXd alpha = factor.solve(values_);
    *cost = 0.5 * values_.dot(alpha) + factor.matrixLLT().diagonal().array().log().sum();
    for (Index k = 0; k < d; ++k) *cost += 0.5 * std::pow((x[k] - std::log(usual_length)) / length_spread, 2);
    *cost += 0.5 * std::pow((x[d] - std::log(usual_tau)) / tau_spread, 2);
    if (gradient == nullptr) return std::isfinite(*cost);
    const MatrixXd inner = factor.solve(MatrixXd::Identity(n, n)) - alpha * alpha.transpose();
    for (Index k = 0; k < d; ++k)
      gradient[k] = 0.5 * inner.cwiseProduct(slope[static_cast<std::size_t>(k)]).sum() +
                    (x[k] - std::log(usual_length)) / (length_spread * length_spread);
    gradient[d] = inner.cwiseProduct(smooth).sum() + (x[d] - std::log(usual_tau)) / (tau_spread * tau_spread);
    return std::isfinite(*cost);
  }

 private:
  const MatrixXd& points_;
  const VectorXd& values_;
  const VectorXd& noise_;
  const std::vector<int>& groups_;
};

}  // namespace

Emulator::Emulator(const MatrixXd& points, const VectorXd& values, const VectorXd& noise_variance, std::vector<int> groups)
    : points_(points), groups_(std::move(groups)) {
  const Index n = points.rows(), d = points.cols();
  if (n == 0 || values.size() != n || noise_variance.size() != n || (!groups_.empty() && static_cast<Index>(groups_.size()) != d) || !values.allFinite() || !(noise_variance.array() > 0).all())
    throw Error("emulator", "needs points with finite values and variances above zero", "run the simulation at one point at least");
  centre_ = values.mean();
  scale_ = std::sqrt(std::max((values.array() - centre_).square().mean(), noise_variance.mean()));
  const VectorXd y = (values.array() - centre_) / scale_, noise = noise_variance / (scale_ * scale_);

  double best = std::numeric_limits<double>::infinity();
  VectorXd found = VectorXd::Constant(d + 1, std::log(usual_length));
  found[d] = std::log(usual_tau);
  const VectorXd first = found;
  const ceres::GradientProblem problem(new Posterior(points_, y, noise, groups_));
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 60;
  for (const double shift : {0.0, -1.0, 1.0}) {
    VectorXd x = first;
    x.head(d).array() += shift;
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(options, problem, x.data(), &summary);
    if (!x.allFinite() || !(summary.final_cost < best)) continue;
    best = summary.final_cost;
    found = x;
  }
  lengths_ = found.head(d).array().exp();
  tau_ = std::exp(found[d]);

  MatrixXd all(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      all(i, j) = beta_variance + tau_ * tau_ * similarity((points_.row(i) - points_.row(j)).transpose().cwiseQuotient(lengths_).cwiseAbs2(), groups_);
  all.diagonal() += noise;
  factor_.compute(all);
  weights_ = factor_.solve(y);
}

Emulator::Prediction Emulator::at(const VectorXd& point) const {
  VectorXd k(points_.rows());
  for (Index i = 0; i < k.size(); ++i)
    k[i] = beta_variance + tau_ * tau_ * similarity((points_.row(i).transpose() - point).cwiseQuotient(lengths_).cwiseAbs2(), groups_);
  const double left = beta_variance + tau_ * tau_ - k.dot(factor_.solve(k));
  return {centre_ + scale_ * k.dot(weights_), scale_ * scale_ * std::max(left, 0.0)};
}

}  // namespace repose::diagnosis
