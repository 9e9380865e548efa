#include "analysis/diagnosis/score.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "analysis/two_samples.hpp"

namespace repose::diagnosis {
Score score_of(const Problem& problem, const Fit& fit) {
  Score score;
  score.runs = fit.runs;
  std::map<std::string, std::pair<double, double>> squares;  // sum, count
  for (std::size_t i = 0; i < fit.runs.size(); ++i) {
    const std::size_t run = fit.runs[i];
    const Eigen::VectorXd plain = problem.plain_residual(fit.layout, run, fit.shared, fit.own[run]);
    if (plain.size() == 0) {  // the model cannot even be run there
      const Eigen::VectorXd lost = Eigen::VectorXd::Constant(problem.runs()[run].size, largest_residual);
      score.per_run.push_back(gaussian_log_likelihood(lost, 1));
      score.log_likelihood += score.per_run.back();
      score.error_per_run.push_back(largest_residual);
      continue;
    }
    score.per_run.push_back(gaussian_log_likelihood(fit.residual[i], 1));
    score.log_likelihood += score.per_run.back();
    score.error_per_run.push_back(fit.residual[i].norm() / std::sqrt(std::max<double>(1, static_cast<double>(fit.residual[i].size()))));
    for (const Channel& c : problem.runs()[run].channels) {
      auto& [sum, count] = squares[c.observable];
      sum += (c.noise * plain.segment(c.first, static_cast<Eigen::Index>(c.time.size()))).squaredNorm();
      count += static_cast<double>(c.time.size());
    }
  }
  for (const auto& [name, square] : squares) score.rmse[name] = std::sqrt(square.first / std::max(1.0, square.second));
  score.chi2_per_dof = fit.per_dof();
  return score;
}

double worth_of_uncertainty(const Problem& problem, const Fit& fit, const Fit& held, double scale, const FitOptions& options) {
  constexpr double rounding = 1e-9;  // of the information, for directions that no run shows
  constexpr double worth_a_look = 2; // nats
  const auto n = static_cast<Eigen::Index>(fit.layout.shared.size());
  if (n == 0 || !std::isfinite(held.chi2)) return 0;
  Eigen::MatrixXd known = information_of(problem, fit) / (scale * scale), more = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < held.runs.size(); ++i) {
    const Eigen::MatrixXd s = shared_alone(jacobian(problem, held, held.runs[i]));
    more += s.transpose() * s;
    slope += s.transpose() * held.residual[i];
  }
  // In units in which all that is known has a diagonal of one.
  const Eigen::VectorXd unit = (known + more).diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd stiff = rounding * Eigen::MatrixXd::Identity(n, n);
  known = unit.asDiagonal() * known * unit.asDiagonal() + stiff;
  const Eigen::MatrixXd both = known + unit.asDiagonal() * more * unit.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> of_both(both), of_known(known);
  if (of_both.info() != Eigen::Success || of_known.info() != Eigen::Success) return 0;
  const Eigen::VectorXd g = unit.asDiagonal() * slope;
  const auto half_log_det = [](const Eigen::LLT<Eigen::MatrixXd>& llt) { return llt.matrixLLT().diagonal().array().log().sum(); };
  const Eigen::VectorXd step = of_both.solve(g);
  double gain = 0.5 * g.dot(step);
  if (gain > worth_a_look) {  // slopes may promise what a simulation there does not keep, as that of a viscosity of nothing does
    Fit there = held;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Parameter& p = held.layout.shared[static_cast<std::size_t>(i)];
      there.shared[i] = std::clamp(held.shared[i] - unit[i] * step[i], p.lower, p.upper);
    }
    there = minimise_own(problem, evaluated(problem, std::move(there)), held.runs, options);
    const Eigen::VectorXd went = unit.cwiseInverse().asDiagonal() * (there.shared - held.shared);
    const double kept = std::isfinite(there.chi2) ? 0.5 * (held.chi2 - there.chi2 - went.dot(known * went)) : 0;
    gain = std::clamp(kept, 0.0, gain);
  }
  return gain - (half_log_det(of_both) - half_log_det(of_known));
}

PairedGain paired_gain(std::span<const double> nominal, std::span<const double> extended) {
  PairedGain gain;
  if (nominal.size() < 2) return gain;
  const MeanDifference d = paired_difference(extended, nominal);
  const double n = static_cast<double>(nominal.size());
  if (d.se > 0) gain.effect_size = d.value / (d.se * std::sqrt(n));
  gain.p = d.p_greater();
  return gain;
}

double p_of_smaller_errors(std::span<const double> nominal, std::span<const double> extended) {
  constexpr double least = 1e-9;  // of the noise: recordings without any
  if (nominal.size() < 2) return 1;
  const auto logarithms = [&](std::span<const double> errors) {
    std::vector<double> result;
    for (const double error : errors) result.push_back(std::log(std::max(error, least)));
    return result;
  };
  return paired_difference(logarithms(nominal), logarithms(extended)).p_greater();
}

}  // namespace repose::diagnosis
