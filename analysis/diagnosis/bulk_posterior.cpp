#include "analysis/diagnosis/bulk_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/diagnosis/bulk_candidate.hpp"
#include "analysis/diagnosis/bulk_statistics.hpp"

namespace repose::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int line_points = 513;
constexpr double impossible = -std::numeric_limits<double>::infinity();

MatrixXd grid_of(Index axes, int points) {
  if (axes == 0) return MatrixXd(1, 0);
  if (axes > 1) return space_filling(points, axes);
  return VectorXd::LinSpaced(line_points, 0, 1);
}

/// A normal's logarithm without factors of 2 pi that all models share is kept whole: the models compare the same data.
class Density {
 public:
  Density(const BulkData& data, const MatrixXd& scatter) : noise_(scatter) {
    noise_.diagonal() += data.extra;
    const VectorXd unit = scatter.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
    correlation_ = unit.asDiagonal() * scatter * unit.asDiagonal();
  }
  double operator()(const VectorXd& mean_of_runs, double runs, const VectorXd& expected, const VectorXd& variance) const {
    if (!expected.allFinite()) return impossible;
    const VectorXd d = variance.cwiseSqrt();
    return log_normal_density(mean_of_runs - expected, noise_ / runs + MatrixXd(d.asDiagonal() * correlation_ * d.asDiagonal()));
  }

 private:
  MatrixXd noise_, correlation_;
};

/// ln sum exp(x).
double log_of_sum(const VectorXd& x) {
  const double top = x.maxCoeff();
  return std::isfinite(top) ? top + std::log((x.array() - top).exp().sum()) : impossible;
}

}  // namespace

double BulkPosterior::quantile(Index axis, double share) const {
  std::vector<Index> order(static_cast<std::size_t>(points.rows()));
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return points(a, axis) < points(b, axis); });
  double sum = 0;
  for (const Index i : order)
    if ((sum += weight[i]) >= share) return points(i, axis);
  return points(order.back(), axis);
}

double BulkPosterior::sd(Index axis) const {
  const double mean = weight.dot(points.col(axis));
  return std::sqrt((weight.array() * (points.col(axis).array() - mean).square()).sum());
}

MatrixXd BulkPosterior::representatives(int count) const {
  MatrixXd chosen(count, points.cols());
  double sum = 0;
  int next = 0;
  for (Index i = 0; i < points.rows() && next < count; ++i) {
    sum += weight[i];
    while (next < count && sum >= (next + 0.5) / count) chosen.row(next++) = points.row(i);
  }
  while (next < count) chosen.row(next++) = best.transpose();
  return chosen;
}

BulkPosterior posterior_of(const BulkData& data, const Predict& predict, const MatrixXd& scatter, Index axes, int points) {
  BulkPosterior posterior;
  posterior.points = grid_of(axes, points);
  const Density density(data, scatter);
  const Index count = posterior.points.rows();
  std::size_t held_runs = 0;
  for (const BulkSetting& s : data.settings) held_runs += static_cast<std::size_t>(s.held.rows());
  VectorXd train = VectorXd::Zero(count), held = VectorXd::Zero(count);
  MatrixXd single(count, static_cast<Index>(held_runs));
  for (Index i = 0; i < count; ++i) {
    const BulkPrediction expected = predict(posterior.points.row(i).transpose());
    Index run = 0;
    for (std::size_t s = 0; s < data.settings.size(); ++s) {
      const BulkSetting& setting = data.settings[s];
      if (setting.train.rows() > 0)
        train[i] += density(setting.train.colwise().mean().transpose(), static_cast<double>(setting.train.rows()), expected.mean[s], expected.variance[s]);
      if (setting.held.rows() > 0)
        held[i] += density(setting.held.colwise().mean().transpose(), static_cast<double>(setting.held.rows()), expected.mean[s], expected.variance[s]);
      for (Index j = 0; j < setting.held.rows(); ++j)
        single(i, run++) = density(setting.held.row(j).transpose(), 1, expected.mean[s], expected.variance[s]);
    }
  }
  Index best = 0;
  posterior.best_log_likelihood = train.maxCoeff(&best);
  posterior.best = posterior.points.row(best).transpose();
  // Kept as logarithms: what is unlikely by the fitted runs may be where a held-out one lies.
  if (!std::isfinite(posterior.best_log_likelihood)) train.setZero();
  const VectorXd log_weight = train.array() - log_of_sum(train);
  posterior.weight = log_weight.array().exp();
  posterior.held_log_likelihood = log_of_sum(log_weight + held);
  for (Index j = 0; j < single.cols(); ++j) posterior.held_of_run.push_back(log_of_sum(log_weight + single.col(j)));
  return posterior;
}

}  // namespace repose::diagnosis
