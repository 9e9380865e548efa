#include "analysis/diagnosis/bulk_statistics.hpp"

#include <Eigen/Dense>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <numbers>

namespace repose::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd centred(const MatrixXd& rows) { return rows.rowwise() - rows.colwise().mean(); }

/// All samples about means of their own, one below the other.
MatrixXd residuals_of(std::span<const MatrixXd> samples, int& dof) {
  std::vector<MatrixXd> parts;
  Index rows = 0, columns = 0;
  dof = 0;
  for (const MatrixXd& sample : samples) {
    const MatrixXd whole = complete_rows(sample);
    columns = std::max(columns, sample.cols());
    if (whole.rows() < 2) continue;
    parts.push_back(centred(whole));
    rows += whole.rows();
    dof += static_cast<int>(whole.rows()) - 1;
  }
  MatrixXd all(rows, columns);
  Index at = 0;
  for (const MatrixXd& part : parts) {
    all.middleRows(at, part.rows()) = part;
    at += part.rows();
  }
  return all;
}

}  // namespace

MatrixXd complete_rows(const MatrixXd& rows) {
  MatrixXd kept(rows.rows(), rows.cols());
  Index n = 0;
  for (Index i = 0; i < rows.rows(); ++i)
    if (rows.row(i).allFinite()) kept.row(n++) = rows.row(i);
  return kept.topRows(n);
}

Scatter pooled_scatter(std::span<const MatrixXd> samples) {
  Scatter scatter;
  const MatrixXd r = residuals_of(samples, scatter.dof);
  scatter.covariance = r.transpose() * r / std::max(1, scatter.dof);
  return scatter;
}

Scatter shrunken_scatter(std::span<const MatrixXd> samples) {
  Scatter scatter = pooled_scatter(samples);
  int dof = 0;
  const MatrixXd r = residuals_of(samples, dof);
  const Index d = r.cols(), n = r.rows();
  if (d < 2 || n < 3) return scatter;
  const VectorXd sd = scatter.covariance.diagonal().cwiseSqrt().cwiseMax(1e-300);
  double variances = 0, squares = 0;
  for (Index i = 0; i < d; ++i)
    for (Index j = 0; j < i; ++j) {
      const Eigen::ArrayXd product = r.col(i).array() * r.col(j).array() / (sd[i] * sd[j]);
      const double mean = product.mean();
      variances += (product - mean).square().sum() * static_cast<double>(n) / std::pow(static_cast<double>(n - 1), 3);
      squares += mean * mean;
    }
  const double lambda = squares > 0 ? std::clamp(variances / squares, 0.0, 1.0) : 1.0;
  const VectorXd diagonal = scatter.covariance.diagonal();
  scatter.covariance *= 1 - lambda;
  scatter.covariance.diagonal() = diagonal;
  return scatter;
}

MeanTest same_mean(const MatrixXd& a_all, const MatrixXd& b_all, const VectorXd& extra, int spent) {
  const MatrixXd a = complete_rows(a_all), b = complete_rows(b_all);
  MeanTest test;
  const int d = static_cast<int>(a.cols()) - spent;
  const double na = static_cast<double>(a.rows()), nb = static_cast<double>(b.rows()), nu = na + nb - 2;
  if (d < 1 || a.rows() < 1 || b.rows() < 2 || nu - static_cast<double>(a.cols()) + 1 <= 0) return test;
  const MatrixXd samples[] = {a, b};
  const VectorXd delta = (a.colwise().mean() - b.colwise().mean()).transpose();
  MatrixXd c = pooled_scatter(samples).covariance * (1 / na + 1 / nb);
  c.diagonal() += extra / na;
  test.statistic = squared_distance(delta, c);
  if (!std::isfinite(test.statistic) || test.statistic < 0) return test;
  test.dimensions = d;
  test.dof = nu - static_cast<double>(d) + 1;
  const double f = test.statistic * test.dof / (nu * d);
  test.p = boost::math::cdf(boost::math::complement(boost::math::fisher_f(d, test.dof), f));
  return test;
}

double combined_p(std::span<const double> p) {
  if (p.empty()) return 1;
  if (p.size() == 1) return p[0];
  double sum = 0;
  for (const double value : p) sum -= 2 * std::log(std::max(value, 1e-300));
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(2.0 * static_cast<double>(p.size())), sum));
}

double log_normal_density(const VectorXd& x, const MatrixXd& covariance) {
  const VectorXd unit = covariance.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Eigen::LLT<MatrixXd> factor(unit.asDiagonal() * covariance * unit.asDiagonal());
  if (factor.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
  const VectorXd w = factor.matrixL().solve(unit.cwiseProduct(x));
  const double log_root = factor.matrixLLT().diagonal().array().log().sum() - unit.array().log().sum();
  return -0.5 * w.squaredNorm() - log_root - 0.5 * static_cast<double>(x.size()) * std::log(2 * std::numbers::pi);
}

double squared_distance(const VectorXd& delta, const MatrixXd& covariance) {
  // In units of each summary's own scatter, so that no unit decides what is small.
  const VectorXd unit = covariance.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Eigen::LDLT<MatrixXd> factor(unit.asDiagonal() * covariance * unit.asDiagonal());
  const VectorXd scaled = unit.cwiseProduct(delta);
  return scaled.dot(factor.solve(scaled));
}

double chance_to_part(double squared_distance, double n) {
  return 0.5 * std::erfc((2.58 - std::sqrt(n * std::max(0.0, squared_distance))) / std::numbers::sqrt2);
}

}  // namespace repose::diagnosis
