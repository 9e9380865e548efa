#include "analysis/diagnosis/explained.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>

#include "analysis/diagnosis/verdict.hpp"

namespace repose::diagnosis {
namespace {

constexpr int most_pieces = 10;
constexpr int samples_of_a_piece = 6;  // at least
constexpr double stands_out = 3;       // standard errors

/// Of what an observable shows, until it is an acceleration.
int derivatives_to_acceleration(const std::string& observable) { return observable == "specific_force" ? 0 : observable == "speed" ? 1 : 2; }

/// The n-fold integral at t of what is 1 from `from` to `to`.
double integral(int n, double t, double from, double to) {
  if (n == 0) return t >= from && t < to ? 1 : 0;
  const double in = std::clamp(t, from, to) - from;
  return n == 1 ? in : 0.5 * in * in + in * std::max(0.0, t - to);
}

/// Derivatives, constant on equal pieces of a channel's time, by least squares beside a free beginning.
class Derivatives {
 public:
  explicit Derivatives(const Channel& channel)
      : order_(derivatives_to_acceleration(channel.observable)),
        pieces_(std::clamp(static_cast<int>(channel.time.size()) / samples_of_a_piece, 0, most_pieces)) {
    if (pieces_ < 2) return;
    const double begin = channel.time.front(), span = channel.time.back() - begin;
    Eigen::MatrixXd design(static_cast<Eigen::Index>(channel.time.size()), order_ + pieces_);
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      const double t = (channel.time[static_cast<std::size_t>(i)] - begin) / span;
      for (int k = 0; k < order_; ++k) design(i, k) = std::pow(t, k);
      for (int p = 0; p < pieces_; ++p) design(i, order_ + p) = integral(order_, t, static_cast<double>(p) / pieces_, p + 1 == pieces_ ? 2.0 : (p + 1.0) / pieces_);
    }
    solve_ = design.completeOrthogonalDecomposition().pseudoInverse();
  }

  /// Sum of their squares where they stand out; `residual` in units of the noise.
  double power(const Eigen::VectorXd& residual) const {
    if (pieces_ < 2) return 0;
    const Eigen::VectorXd found = (solve_ * residual).tail(pieces_), error = solve_.bottomRows(pieces_).rowwise().norm();
    return (found.cwiseAbs().array() > stands_out * error.array()).select(found.cwiseAbs2().array(), 0).sum();
  }

 private:
  int order_, pieces_;
  Eigen::MatrixXd solve_;
};

double excess(const Fit& fit, double noise = 1) { return std::max(0.0, fit.chi2 - noise * static_cast<double>(fit.samples - fit.parameters)); }

/// Of the excess chi^2 of each run that plainly leaves more than noise: the share that the model leaves.
std::vector<double> left_in_runs(const Fit& nominal, const Fit& model) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < nominal.runs.size(); ++i) {
    const auto of_run = [i](const Fit& fit) {
      const double free = static_cast<double>(fit.residual[i].size() - fit.own[fit.runs[i]].size());
      return std::max(0.0, fit.residual[i].squaredNorm() - free);
    };
    if (nominal.residual[i].size() == 0 || model.residual[i].size() == 0) continue;
    const double before = of_run(nominal);
    if (before > (plainly_more_than_noise - 1) * static_cast<double>(nominal.residual[i].size())) shares.push_back(of_run(model) / before);
  }
  return shares;
}

}  // namespace

double share_explained(const Fit& nominal, const Fit& model, double noise) {
  const std::vector<double> left = left_in_runs(nominal, model);
  if (!left.empty())
    return std::accumulate(left.begin(), left.end(), 0.0, [](double sum, double l) { return sum + std::max(-1.0, 1 - l); }) / static_cast<double>(left.size());
  const double before = excess(nominal, noise);
  return before > 0 ? 1 - excess(model, noise) / before : 0;
}

double noise_left(const Problem& problem, const Fit& fit) {
  if (!(fit.per_dof() < 1)) return 1;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < fit.runs.size(); ++i)
    for (const Channel& c : problem.runs()[fit.runs[i]].channels)
      for (std::size_t k = 1; k < c.time.size() && fit.residual[i].size() > 0; ++k, ++count) {
        const Eigen::Index at = c.first + static_cast<Eigen::Index>(k);
        sum += std::pow(fit.residual[i][at] - fit.residual[i][at - 1], 2) / 2;
      }
  return count == 0 ? 1 : std::min(fit.per_dof(), sum / static_cast<double>(count));
}

std::vector<std::size_t> runs_beyond_noise(const Fit& fit) {
  std::vector<std::size_t> beyond;
  for (std::size_t i = 0; i < fit.runs.size(); ++i)
    if (fit.residual[i].size() > 0 && fit.residual[i].squaredNorm() > plainly_more_than_noise * static_cast<double>(fit.residual[i].size())) beyond.push_back(fit.runs[i]);
  return beyond;
}

double error_left(const Fit& nominal, const Fit& model) {
  const double before = excess(nominal), together = before > 0 ? excess(model) / before : 1;
  std::vector<double> left = left_in_runs(nominal, model);
  if (left.empty()) return std::sqrt(together);
  const auto middle = left.begin() + static_cast<std::ptrdiff_t>(left.size() / 2);
  std::nth_element(left.begin(), middle, left.end());
  return std::sqrt(std::min(together, *middle));
}

double share_of_accelerations(const Problem& problem, const Fit& nominal, const Fit& model) {
  double sum = 0, weights = 0;
  for (std::size_t i = 0; i < nominal.runs.size(); ++i) {
    if (nominal.residual[i].size() == 0 || model.residual[i].size() == 0) continue;
    for (const Channel& c : problem.runs()[nominal.runs[i]].channels) {
      const auto of_channel = [&](const Fit& fit) { return fit.residual[i].segment(c.first, static_cast<Eigen::Index>(c.time.size())); };
      const Derivatives derivatives(c);
      const double before = derivatives.power(of_channel(nominal));
      if (before == 0) continue;
      const double weight = of_channel(nominal).squaredNorm();
      sum += weight * std::max(-1.0, 1 - derivatives.power(of_channel(model)) / before);
      weights += weight;
    }
  }
  return weights > 0 ? sum / weights : 1;
}

double gain_towards(const Fit& nominal, const Fit& other) {
  double along = 0, length = 0;
  for (std::size_t i = 0; i < nominal.residual.size(); ++i) {
    if (nominal.residual[i].size() == 0 || other.residual[i].size() == 0) return 0;
    const Eigen::VectorXd way = other.residual[i] - nominal.residual[i];
    along -= way.dot(nominal.residual[i]);
    length += way.squaredNorm();
  }
  return along > 0 ? along * along / length : 0;
}

}  // namespace repose::diagnosis
