#include "analysis/diagnosis/fit.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "analysis/diagnosis/run_cost.hpp"
#include "analysis/side_by_side.hpp"

namespace repose::diagnosis {
namespace {

constexpr double far_off = 25;        // chi^2 per sample of a run that may be stuck: 5 sigma
constexpr int grown_fit = 6;
constexpr double grown_shares[] = {0.2, 0.3, 0.4, 0.55, 0.75};
constexpr int shakes = 4;
constexpr double basin_gain = 1;   // of chi^2: another basin gains more
constexpr int shaken_fit = 3;         // iterations that tell how deep a neighbouring basin is
constexpr double first_radius = 100;  // of Ceres' 1e4: contacts bend the residuals, and each step that is taken back is one of few

class Stop final : public ceres::IterationCallback {
 public:
  explicit Stop(const std::function<bool()>& interrupted) : interrupted_(interrupted) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return interrupted_ && interrupted_() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<bool()>& interrupted_;
};

/// Ceres tells of a start that fails on standard error, whatever `logging_type` says. Whoever fits sees it in the result.
void silence_log() {
  static const bool silent = [] {
    FLAGS_minloglevel = google::GLOG_FATAL;
    return true;
  }();
  static_cast<void>(silent);
}

void evaluate(const Problem& problem, Fit& fit) {
  fit.residual.clear();
  fit.chi2 = 0;
  fit.samples = 0;
  fit.parameters = static_cast<int>(fit.layout.shared.size());
  for (const std::size_t run : fit.runs) {
    fit.residual.push_back(residual_of(problem, fit, run));
    fit.chi2 += fit.residual.back().size() == 0 ? std::numeric_limits<double>::infinity() : fit.residual.back().squaredNorm();
    fit.samples += problem.runs()[run].size;
    fit.parameters += static_cast<int>(fit.layout.per_run[run].size());
  }
}

Fit solve(const Problem& problem, const Fit& start, const FitOptions& options, bool frozen);

/// Runs that share nothing are problems of their own: a step that fails in one takes back no other's.
Fit solve_each(const Problem& problem, const Fit& start, const FitOptions& options, bool frozen) {
  std::vector<Fit> each(start.runs.size());
  FitOptions alone = options;
  alone.threads = 1;
  side_by_side(each.size(), options.threads, [&](std::size_t i) {
    Fit one = start;
    one.runs = {start.runs[i]};
    each[i] = solve(problem, one, alone, frozen);
  });
  Fit all = start;
  for (std::size_t i = 0; i < each.size(); ++i) all.own[start.runs[i]] = each[i].own[start.runs[i]];
  evaluate(problem, all);
  return all;
}

Fit solve(const Problem& problem, const Fit& start, const FitOptions& options, bool frozen) {
  if ((frozen || start.layout.shared.empty()) && start.runs.size() > 1) return solve_each(problem, start, options, frozen);
  Fit best = start;
  evaluate(problem, best);
  if (!std::isfinite(best.chi2)) return best;
  const Coordinates shared(best.layout.shared);
  std::vector<double> s = shared.to(best.shared);
  std::vector<std::vector<double>> own;
  for (std::size_t run = 0; run < best.own.size(); ++run) own.push_back(Coordinates(best.layout.per_run[run]).to(best.own[run]));

  CostsSideBySide costs(options.threads);
  ceres::Problem::Options with_costs;
  with_costs.evaluation_callback = &costs;
  ceres::Problem least_squares(with_costs);
  const auto bound = [&](double* block, const Coordinates& c) {
    for (std::size_t i = 0; i < c.parameters.size(); ++i) {
      if (std::abs(c.parameters[i].lower) < 1e299) least_squares.SetParameterLowerBound(block, static_cast<int>(i), c.to(i, c.parameters[i].lower));
      if (std::abs(c.parameters[i].upper) < 1e299) least_squares.SetParameterUpperBound(block, static_cast<int>(i), c.to(i, c.parameters[i].upper));
      block[i] = std::clamp(block[i], std::abs(c.parameters[i].lower) < 1e299 ? c.to(i, c.parameters[i].lower) : -1e300,
                            std::abs(c.parameters[i].upper) < 1e299 ? c.to(i, c.parameters[i].upper) : 1e300);
    }
  };
  bool any = false;
  const bool fixed = frozen || (options.pinned >= 0 && s.size() == 1);
  for (const std::size_t run : best.runs) {
    std::vector<double*> blocks;
    if (!s.empty()) blocks.push_back(s.data());
    if (!own[run].empty()) blocks.push_back(own[run].data());
    if (blocks.empty()) continue;
    any = true;
    auto* const cost = new RunCost(problem, best.layout, run, options.until, blocks, fixed);  // Ceres owns it
    costs.add(cost);
    least_squares.AddResidualBlock(cost, nullptr, blocks);
    if (own[run].empty()) continue;
    bound(own[run].data(), Coordinates(best.layout.per_run[run]));
    least_squares.AddResidualBlock(new Prior(best.layout.per_run[run]), nullptr, own[run].data());
  }
  if (any && !s.empty()) {
    bound(s.data(), shared);
    if (fixed)
      least_squares.SetParameterBlockConstant(s.data());
    else if (options.pinned >= 0)
      least_squares.SetManifold(s.data(), new ceres::SubsetManifold(static_cast<int>(s.size()), {options.pinned}));
  }
  if (!any || (fixed && least_squares.NumParameters() == static_cast<int>(s.size()))) return best;

  ceres::Solver::Options o;
  o.max_num_iterations = options.iterations;
  o.num_threads = 1;  // Ceres sums costs in the order in which its threads come; runs are simulated side by side by CostsSideBySide
  o.linear_solver_type = ceres::DENSE_QR;
  o.initial_trust_region_radius = first_radius;
  o.function_tolerance = 1e-5;
  o.max_num_line_search_step_size_iterations = 0;  // bounds are kept by projection: a search costs as much as several steps
  o.logging_type = ceres::SILENT;
  Stop stop(options.interrupted);
  o.callbacks = {&stop};
  silence_log();
  ceres::Solver::Summary summary;
  ceres::Solve(o, &least_squares, &summary);

  Fit found = best;
  if (!frozen) found.shared = shared.from(s.data());
  for (const std::size_t run : best.runs) found.own[run] = Coordinates(best.layout.per_run[run]).from(own[run].data());
  evaluate(problem, found);
  return found.chi2 < best.chi2 || std::isfinite(options.until) ? found : best;
}

/// One run, its start values fitted to a growing part of its record.
Fit grown(const Problem& problem, const Fit& start, const FitOptions& options) {
  Fit fit = start;
  FitOptions part = options;
  for (const double share : {0.25, 0.5, 0.75}) {
    part.until = share * problem.runs()[start.runs.front()].horizon;
    fit = solve(problem, fit, part, true);
  }
  return solve(problem, fit, options, true);
}

/// Does the path jump with the step in which an engine sees that the body hit?
bool jumps(const Problem& problem, const Fit& fit, std::size_t run) { return !fit.layout.numerics.backend.empty() && problem.runs()[run].hits; }

}  // namespace

Eigen::VectorXd residual_of(const Problem& problem, const Fit& fit, std::size_t run) {
  return problem.residual(fit.layout, run, fit.shared, fit.own[run]);
}

Fit start_of(const Problem& problem, const Layout& layout, const std::vector<std::size_t>& runs) {
  Fit fit;
  fit.layout = layout;
  fit.runs = runs;
  const auto starts = [](const std::vector<Parameter>& parameters) {
    Values v(static_cast<Eigen::Index>(parameters.size()));
    for (std::size_t i = 0; i < parameters.size(); ++i) v[static_cast<Eigen::Index>(i)] = parameters[i].start;
    return v;
  };
  fit.shared = starts(layout.shared);
  for (const auto& own : layout.per_run) fit.own.push_back(starts(own));
  evaluate(problem, fit);
  return fit;
}

Fit begun_within(const Problem& problem, const Layout& layout, const Fit& larger) {
  const auto take_over = [](const std::vector<Parameter>& from, const Values& theirs, const std::vector<Parameter>& to, Values& ours) {
    for (std::size_t i = 0; i < to.size(); ++i)
      for (std::size_t j = 0; j < from.size(); ++j)
        if (from[j].use == to[i].use && from[j].key == to[i].key && from[j].component == to[i].component && from[j].effect == to[i].effect)
          ours[static_cast<Eigen::Index>(i)] = theirs[static_cast<Eigen::Index>(j)];
  };
  Fit start = start_of(problem, layout, larger.runs);
  take_over(larger.layout.shared, larger.shared, layout.shared, start.shared);
  for (std::size_t run = 0; run < start.own.size(); ++run)
    take_over(larger.layout.per_run[run], larger.own[run], layout.per_run[run], start.own[run]);
  return start;
}

Fit evaluated(const Problem& problem, Fit fit) {
  evaluate(problem, fit);
  return fit;
}

Fit minimise(const Problem& problem, const Fit& start, const FitOptions& options) { return solve(problem, start, options, false); }

Fit minimise_own(const Problem& problem, const Fit& trained, const std::vector<std::size_t>& runs, const FitOptions& options) {
  Fit fit = trained;
  fit.runs = runs;
  return solve(problem, fit, options, true);
}

double chi2_until(const Problem& problem, const Fit& fit, double until) {
  double sum = 0;
  for (const std::size_t run : fit.runs) {
    const Eigen::VectorXd r = residual_of(problem, fit, run);
    if (r.size() == 0) return std::numeric_limits<double>::infinity();
    for (const Channel& c : problem.runs()[run].channels)
      for (std::size_t i = 0; i < c.time.size() && c.time[i] <= until; ++i) sum += r[c.first + static_cast<Eigen::Index>(i)] * r[c.first + static_cast<Eigen::Index>(i)];
  }
  return sum;
}

Fit followed(const Problem& problem, const Fit& start, const std::vector<std::vector<double>>& points, const FitOptions& options) {
  double longest = 0;
  for (const std::size_t run : start.runs) longest = std::max(longest, problem.runs()[run].horizon);
  Fit fit = start;
  FitOptions part = options;
  part.iterations = grown_fit;
  for (const double share : grown_shares) {
    if (options.interrupted && options.interrupted()) break;
    part.until = share * longest;
    std::vector<Fit> tried(1, fit);
    for (const std::vector<double>& point : points) {
      tried.push_back(fit);
      for (std::size_t i = 0; i < point.size(); ++i) tried.back().shared[fit.shared.size() - static_cast<Eigen::Index>(point.size() - i)] = point[i];
    }
    std::vector<double> left(tried.size());
    side_by_side(tried.size(), options.threads, [&](std::size_t i) { left[i] = chi2_until(problem, tried[i], part.until); });
    fit = minimise(problem, tried[static_cast<std::size_t>(std::min_element(left.begin(), left.end()) - left.begin())], part);
  }
  return minimise(problem, fit, options);
}

Fit begun_anew(const Problem& problem, const Fit& fit, const std::vector<std::size_t>& runs, const FitOptions& options) {
  Fit better = fit;
  for (std::size_t i = 0; i < fit.runs.size(); ++i) {
    const std::size_t run = fit.runs[i];
    if (std::find(runs.begin(), runs.end(), run) == runs.end() || (options.interrupted && options.interrupted())) continue;
    const std::vector<Parameter>& start = problem.runs()[run].start;
    const double stuck = jumps(problem, fit, run) ? 0 : far_off;
    double least = fit.residual[i].size() == 0 ? std::numeric_limits<double>::infinity() : fit.residual[i].squaredNorm();
    if (start.empty() || least < stuck * static_cast<double>(fit.residual[i].size())) continue;
    for (const bool as_told : {false, true}) {
      Fit one = fit;
      one.runs = {run};
      for (std::size_t k = 0; k < start.size(); ++k)
        one.own[run][static_cast<Eigen::Index>(k)] = as_told && std::isfinite(start[k].told) ? start[k].told : start[k].begin();
      if (one = grown(problem, one, options); one.chi2 < least) {
        least = one.chi2;
        better.own[run] = one.own[run];
      }
    }
  }
  evaluate(problem, better);
  return better.chi2 < fit.chi2 ? better : fit;
}

Fit shaken(const Problem& problem, const Fit& fit, const std::vector<std::size_t>& runs, const FitOptions& options) {
  Fit better = fit;
  FitOptions alone = options, brief = options;
  alone.threads = brief.threads = 1;
  brief.iterations = shaken_fit;
  side_by_side(runs.size(), options.threads, [&](std::size_t n) {
    const std::size_t run = runs[n];
    if (!jumps(problem, fit, run)) return;
    Fit best = fit;
    best.runs = {run};
    best = evaluated(problem, best);
    const std::vector<Parameter>& own = problem.runs()[run].start;
    for (int round = 0; round < shakes; ++round) {
      const Fit begin = best;
      for (std::size_t i = 0; i < own.size(); ++i)
        for (const double distance : {1.0, -1.0, 0.5, -0.5, 0.25, -0.25, 0.125, -0.125}) {
          if (options.interrupted && options.interrupted()) return;
          Fit there = begin;
          double& value = there.own[run][static_cast<Eigen::Index>(i)];
          value = std::clamp(value + distance * own[i].step, own[i].lower, own[i].upper);
          if (there = solve(problem, evaluated(problem, there), brief, true); there.chi2 < best.chi2) best = std::move(there);
        }
      if (!(best.chi2 < begin.chi2 - basin_gain)) break;
      best = solve(problem, best, alone, true);
    }
    better.own[run] = best.own[run];
  });
  return evaluated(problem, better);
}

RunJacobian jacobian(const Problem& problem, const Fit& fit, std::size_t run) {
  const Eigen::VectorXd r = residual_of(problem, fit, run);
  const auto columns = [&](bool shared) {
    const std::vector<Parameter>& parameters = shared ? fit.layout.shared : fit.layout.per_run[run];
    const Coordinates c(parameters);
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(problem.runs()[run].size, static_cast<Eigen::Index>(parameters.size()));
    if (r.size() == 0) return j;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      Values s = fit.shared, o = fit.own[run];
      Values& v = shared ? s : o;
      const double before = v[k];
      for (const double delta : {nudge, -nudge}) {
        v[k] = c.from(i, c.to(i, before) + delta);
        if (v[k] == before) continue;
        const Eigen::VectorXd moved = problem.residual(fit.layout, run, s, o);
        if (moved.size() == 0) continue;
        j.col(k) = (moved - r) / (v[k] - before);
        break;
      }
    }
    return j;
  };
  return {columns(true), columns(false)};
}

Eigen::MatrixXd shared_alone(const RunJacobian& jacobian) {
  if (jacobian.own.cols() == 0) return jacobian.shared;
  return jacobian.shared - jacobian.own * jacobian.own.colPivHouseholderQr().solve(jacobian.shared);
}

int seen_parameters(const Problem& problem, const Fit& fit, std::size_t first) {
  constexpr double negligible = 1e-3;  // of what the parameter does before start values are taken out: slopes are finite differences
  const auto n = static_cast<Eigen::Index>(fit.layout.shared.size()), from = static_cast<Eigen::Index>(first);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(n), alone = all;
  for (const std::size_t run : fit.runs) {
    const RunJacobian j = jacobian(problem, fit, run);
    all += j.shared.colwise().squaredNorm().transpose();
    alone += shared_alone(j).colwise().squaredNorm().transpose();
  }
  int seen = 0;
  for (Eigen::Index i = from; i < n; ++i) seen += alone[i] > negligible * negligible * all[i] ? 1 : 0;
  return seen;
}

Eigen::MatrixXd information_of(const Problem& problem, const Fit& fit) {
  const auto n = static_cast<Eigen::Index>(fit.layout.shared.size());
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const std::size_t run : fit.runs) {
    const Eigen::MatrixXd s = shared_alone(jacobian(problem, fit, run));
    information += s.transpose() * s;
  }
  return information;
}

Eigen::VectorXd standard_errors(const Problem& problem, const Fit& fit, double scale) {
  const Eigen::MatrixXd information = information_of(problem, fit);
  if (information.size() == 0) return {};
  const Eigen::MatrixXd covariance = information.completeOrthogonalDecomposition().pseudoInverse();
  return scale * covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

double moved_by_coarser_step(const Problem& problem, const Fit& fit) {
  if (fit.layout.numerics.step_factor <= 1) return 0;
  Fit finely = fit;
  finely.layout.numerics.step_factor = 1;
  finely = evaluated(problem, std::move(finely));
  double largest = 0;
  for (std::size_t i = 0; i < fit.residual.size(); ++i) {
    const Eigen::Index n = fit.residual[i].size();
    if (n == 0 || finely.residual[i].size() != n) continue;
    largest = std::max(largest, (fit.residual[i] - finely.residual[i]).norm() / std::sqrt(static_cast<double>(n)));
  }
  return largest;
}

}  // namespace repose::diagnosis
