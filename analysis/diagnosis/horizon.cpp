#include "analysis/diagnosis/horizon.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "analysis/side_by_side.hpp"

namespace repose::diagnosis {
namespace {

constexpr int passes = 3;
constexpr double worthwhile = 1.05;  // times as far

/// Twice the standard deviations along the axes of what is left of the start's uncertainty, as columns.
Eigen::MatrixXd left_uncertain(const Problem& problem, const Fit& fit, std::size_t run) {
  const Eigen::MatrixXd j = jacobian(problem, fit, run).own;
  Eigen::MatrixXd precision = j.transpose() * j;
  const std::vector<Parameter>& start = problem.runs()[run].start;
  for (std::size_t i = 0; i < start.size(); ++i) precision(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += 1 / (start[i].step * start[i].step);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(precision);
  return 2 * std::max(1.0, std::sqrt(fit.per_dof())) * axes.eigenvectors() * axes.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

void follow_further(Problem& problem, const FitOptions& options) {
  FitOptions alone = options;
  alone.threads = 1;
  side_by_side(problem.runs().size(), options.threads, [&](std::size_t run) {
    for (int pass = 0; pass < passes; ++pass) {
      const RunData& data = problem.runs()[run];
      if (data.start.empty() || data.horizon >= data.recorded || (options.interrupted && options.interrupted())) return;
      const Fit fit = minimise_own(problem, start_of(problem, problem.layout({}), {run}), {run}, alone);
      if (!std::isfinite(fit.chi2)) return;
      const double before = data.horizon;
      problem.follow(run, fit.own[run], left_uncertain(problem, fit, run));
      if (data.horizon < worthwhile * before) return;
    }
  });
}

}  // namespace repose::diagnosis
