#include "analysis/diagnosis/bulk_emulator.hpp"

#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <cmath>

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

/// Minus the log of likelihood times priors, and its gradient, in (ln l_1, ..., ln l_d, ln tau).
class Posterior final : public ceres::FirstOrderFunction {
 public:
  Posterior(const MatrixXd& points, const VectorXd& values, const VectorXd& noise) : points_(points), values_(values), noise_(noise) {}
  int NumParameters() const override { return static_cast<int>(points_.cols()) + 1; }

  bool Evaluate(const double* const x, double* cost, double* gradient) const override {
    const Index n = points_.rows(), d = points_.cols();
    const double tau2 = std::exp(2 * x[d]);
    MatrixXd smooth(n, n);
    std::vector<MatrixXd> slope(static_cast<std::size_t>(d), MatrixXd::Zero(n, n));
    for (Index i = 0; i < n; ++i)
      for (Index j = 0; j < n; ++j) {
        double r2 = 0;
        for (Index k = 0; k < d; ++k) r2 += std::pow((points_(i, k) - points_(j, k)) * std::exp(-x[k]), 2);
        const double q = std::sqrt(5 * r2);
        smooth(i, j) = tau2 * matern(std::sqrt(r2));
        for (Index k = 0; k < d; ++k)
          slope[static_cast<std::size_t>(k)](i, j) =
              tau2 * 5 / 3 * (1 + q) * std::exp(-q) * std::pow((points_(i, k) - points_(j, k)) * std::exp(-x[k]), 2);
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
};

}  // namespace

Emulator::Emulator(const MatrixXd& points, const VectorXd& values, const VectorXd& noise_variance) : points_(points) {
  const Index n = points.rows(), d = points.cols();
  if (n == 0 || values.size() != n || noise_variance.size() != n || !values.allFinite() || !(noise_variance.array() > 0).all())
    throw Error("emulator", "needs points with finite values and variances above zero", "run the simulation at one point at least");
  centre_ = values.mean();
  scale_ = std::sqrt(std::max((values.array() - centre_).square().mean(), noise_variance.mean()));
  const VectorXd y = (values.array() - centre_) / scale_, noise = noise_variance / (scale_ * scale_);

  double best = std::numeric_limits<double>::infinity();
  VectorXd found = VectorXd::Constant(d + 1, std::log(usual_length));
  found[d] = std::log(usual_tau);
  const VectorXd first = found;
  const ceres::GradientProblem problem(new Posterior(points_, y, noise));
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
      all(i, j) = beta_variance + tau_ * tau_ * matern((points_.row(i) - points_.row(j)).cwiseQuotient(lengths_.transpose()).norm());
  all.diagonal() += noise;
  factor_.compute(all);
  weights_ = factor_.solve(y);
}

Emulator::Prediction Emulator::at(const VectorXd& point) const {
  VectorXd k(points_.rows());
  for (Index i = 0; i < k.size(); ++i)
    k[i] = beta_variance + tau_ * tau_ * matern((points_.row(i).transpose() - point).cwiseQuotient(lengths_).norm());
  const double left = beta_variance + tau_ * tau_ - k.dot(factor_.solve(k));
  return {centre_ + scale_ * k.dot(weights_), scale_ * scale_ * std::max(left, 0.0)};
}

}  // namespace repose::diagnosis
