#include "analysis/diagnosis/uncertainty.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Dense>

#include "analysis/statistics.hpp"
#include "core/random.hpp"

namespace repose::diagnosis {
namespace {

constexpr double ninety = 1.645;               // standard errors
constexpr double rise = ninety * ninety;       // of chi^2 at the end of the interval
constexpr double close = 0.05;                 // of the rise, relative
constexpr int trials = 8;
constexpr int iterations = 4;                  // of each refit: it begins where it will nearly end
constexpr double suspicious = 1.5;             // times the rise at the end of the interval
constexpr std::size_t least_runs = 6;
constexpr int bootstrap_replicas = 999;
constexpr std::uint64_t stream = 91;

/// How all other parameters follow shared parameter k, to first order: a profile that begins there is there at once.
struct Following {
  Values shared;             ///< per unit of parameter k; 1 at k
  std::vector<Values> own;   ///< of every run of the problem
};

Following following(const Problem& problem, const Fit& fit, Eigen::Index k) {
  Following f{Values::Zero(fit.shared.size()), {}};
  for (const Values& own : fit.own) f.own.push_back(Values::Zero(own.size()));
  f.shared[k] = 1;
  std::vector<RunJacobian> jacobians;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(fit.shared.size(), fit.shared.size());
  for (const std::size_t run : fit.runs) {
    RunJacobian j = jacobian(problem, fit, run);
    const Eigen::MatrixXd s = shared_alone(j);
    information += s.transpose() * s;
    jacobians.push_back(std::move(j));
  }
  if (const Eigen::Index n = fit.shared.size(); n > 1) {
    Eigen::MatrixXd others = information;
    others.row(k).setZero();
    others.col(k).setZero();
    Eigen::VectorXd coupled = information.col(k);
    coupled[k] = 0;
    const Values moved = -others.completeOrthogonalDecomposition().solve(coupled);
    for (Eigen::Index i = 0; i < n; ++i)
      if (i != k) f.shared[i] = moved[i];
  }
  for (std::size_t i = 0; i < fit.runs.size(); ++i)
    if (jacobians[i].own.cols() > 0) f.own[fit.runs[i]] = -jacobians[i].own.colPivHouseholderQr().solve(jacobians[i].shared * f.shared);
  return f;
}

/// Distance from the fit, in the direction of `sign`, at which the profile has risen.
double reach(const Problem& problem, const Fit& fit, std::size_t index, double se, double scale, const Following& others, const FitOptions& options,
             double sign) {
  const auto k = static_cast<Eigen::Index>(index);
  const Parameter& p = fit.layout.shared[index];
  const double most = sign > 0 ? p.upper - fit.shared[k] : fit.shared[k] - p.lower, wanted = rise * scale * scale;
  if (!(most > 0)) return 0;
  FitOptions pinned = options;
  pinned.pinned = static_cast<int>(index);
  pinned.iterations = iterations;
  FitOptions thorough = pinned;
  thorough.iterations = options.iterations;
  Fit from = fit;
  double inside = 0, outside = most, inside_rise = 0, at = std::min(most, ninety * se > 0 ? ninety * se : p.step);
  bool bracketed = false;
  for (int trial = 0; trial < trials; ++trial) {
    Fit start = from;
    const double further = fit.shared[k] + sign * at - from.shared[k];
    start.shared += further * others.shared;
    for (Eigen::Index i = 0; i < start.shared.size(); ++i) {
      const Parameter& q = fit.layout.shared[static_cast<std::size_t>(i)];
      start.shared[i] = std::clamp(start.shared[i], q.lower, q.upper);
    }
    start.shared[k] = fit.shared[k] + sign * at;
    for (std::size_t run = 0; run < start.own.size(); ++run) start.own[run] += further * others.own[run];
    Fit held = minimise(problem, start, pinned);
    // A refit that is stuck makes the profile too steep, never too flat.
    if (held.chi2 - fit.chi2 > suspicious * wanted) held = minimise(problem, minimise_own(problem, held, fit.runs, thorough), thorough);
    const double risen = held.chi2 - fit.chi2;
    if (std::abs(risen / wanted - 1) < close) return at;
    if (risen < wanted) {
      if (at >= most) return most;
      inside = at;
      inside_rise = std::max(0.0, risen);
      from = held;
    } else {
      outside = at;
      bracketed = true;
    }
    // A parabola through the fit and this point; then halves, if that leaves the bracket.
    double next = std::isfinite(risen) && risen > 0 ? at * std::sqrt(wanted / risen) : 2 * at;
    if (!bracketed) next = std::clamp(next, 1.2 * at, 4 * at);
    if (bracketed && !(next > inside + 0.05 * (outside - inside) && next < outside - 0.05 * (outside - inside))) next = 0.5 * (inside + outside);
    at = std::min(next, most);
  }
  return bracketed ? 0.5 * (inside + outside) : inside_rise > 0 ? std::min(most, inside * std::sqrt(wanted / inside_rise)) : most;
}

/// Standard errors of the values that `run` has for itself, from that run alone.
Eigen::VectorXd own_errors(const Problem& problem, const Fit& fit, std::size_t run, double scale) {
  const RunJacobian j = jacobian(problem, fit, run);
  Eigen::MatrixXd all(j.own.rows(), j.shared.cols() + j.own.cols());
  all << j.shared, j.own;
  const Eigen::MatrixXd covariance = (all.transpose() * all).eval().completeOrthogonalDecomposition().pseudoInverse();
  return scale * covariance.diagonal().tail(j.own.cols()).cwiseMax(0).cwiseSqrt();
}

ParameterEstimate named_after(const Parameter& p, double value) {
  ParameterEstimate e;
  e.name = p.component < 0 || p.use == Parameter::Use::bias ? p.key : fmt::format("{}.{}", p.key, p.component);
  e.unit = p.unit;
  e.effect = p.effect;
  e.value = value;
  return e;
}

/// What stays the same from run to run, wherever it stands in each: the parameter, and of a sensor what it reads.
std::string identity(const Parameter& p, const BundleRun& run) {
  std::string text = p.effect + "|" + p.key;
  if (p.use != Parameter::Use::bias) return text + fmt::format("|{}", p.component);
  const Observation& o = run.observations[static_cast<std::size_t>(p.component)];
  text += "|" + o.name + "|" + o.body;
  return o.axis ? text + fmt::format("|{} {} {}", o.axis->x(), o.axis->y(), o.axis->z()) : text;
}

/// What an effect gives to each run for itself: some runs may lack what others have.
struct OverRuns {
  std::string identity;
  Parameter parameter;
  std::vector<double> values;
  std::size_t run = 0;      ///< the last one that has it, and where
  Eigen::Index index = 0;
};

std::vector<OverRuns> collected_over_runs(const Problem& problem, const Fit& fit) {
  std::vector<OverRuns> all;
  for (const std::size_t run : fit.runs) {
    std::map<std::string, int> in_this_run;
    for (std::size_t i = 0; i < fit.layout.per_run[run].size(); ++i) {
      const Parameter& p = fit.layout.per_run[run][i];
      if (p.effect.empty()) continue;  // a start value
      std::string what = identity(p, *problem.runs()[run].run);
      what += fmt::format("|{}", ++in_this_run[what]);  // two sensors that read the same
      auto known = std::find_if(all.begin(), all.end(), [&](const OverRuns& o) { return o.identity == what; });
      if (known == all.end()) known = all.insert(all.end(), {what, p, {}});
      const auto k = static_cast<Eigen::Index>(i);
      known->values.push_back(fit.own[run][k]);
      known->run = run;
      known->index = k;
    }
  }
  return all;
}

std::vector<ParameterEstimate> estimates_over_runs(const Problem& problem, const Fit& fit, double scale) {
  std::vector<ParameterEstimate> list;
  std::map<std::string, int> seen;
  for (const OverRuns& o : collected_over_runs(problem, fit)) {
    const Summary summary = summarise(o.values);
    const double half = summary.n > 1 ? student_t_quantile(0.95, static_cast<int>(summary.n) - 1) * summary.se
                                      : ninety * own_errors(problem, fit, o.run, scale)[o.index];
    ParameterEstimate e = named_after(o.parameter, summary.mean);
    if (const int number = ++seen[o.parameter.key]; number > 1) e.name += fmt::format(" ({})", number);
    e.lower = e.value - half;
    e.upper = e.value + half;
    list.push_back(e);
  }
  return list;
}

}  // namespace

Interval profile_interval(const Problem& problem, const Fit& fit, std::size_t index, double se, double scale, const FitOptions& options) {
  const double value = fit.shared[static_cast<Eigen::Index>(index)];
  const Following others = following(problem, fit, static_cast<Eigen::Index>(index));
  return {value - reach(problem, fit, index, se, scale, others, options, -1), value + reach(problem, fit, index, se, scale, others, options, 1)};
}

std::vector<Interval> run_bootstrap(const Problem& problem, const Fit& fit, int replicas, std::uint64_t seed) {
  const auto n = static_cast<Eigen::Index>(fit.layout.shared.size());
  if (fit.runs.size() < least_runs || n == 0) return {};
  std::vector<Eigen::MatrixXd> information;
  std::vector<Eigen::VectorXd> slope;
  for (std::size_t i = 0; i < fit.runs.size(); ++i) {
    const Eigen::MatrixXd s = shared_alone(jacobian(problem, fit, fit.runs[i]));
    information.push_back(s.transpose() * s);
    slope.push_back(s.transpose() * fit.residual[i]);
  }
  Random random(seed, stream);
  std::vector<std::vector<double>> drawn(static_cast<std::size_t>(n));
  for (int b = 0; b < replicas; ++b) {
    Eigen::MatrixXd total = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (std::size_t i = 0; i < fit.runs.size(); ++i) {
      const auto run = static_cast<std::size_t>(random.below(fit.runs.size()));
      total += information[run];
      right += slope[run];
    }
    const Eigen::VectorXd moved = fit.shared - total.completeOrthogonalDecomposition().solve(right);
    for (Eigen::Index k = 0; k < n; ++k) drawn[static_cast<std::size_t>(k)].push_back(moved[k]);
  }
  std::vector<Interval> intervals;
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    std::sort(drawn[k].begin(), drawn[k].end());
    const auto at = [&](double share) { return drawn[k][static_cast<std::size_t>(share * static_cast<double>(drawn[k].size() - 1))]; };
    const Parameter& p = fit.layout.shared[k];
    intervals.push_back({std::clamp(at(0.05), p.lower, p.upper), std::clamp(at(0.95), p.lower, p.upper)});
  }
  return intervals;
}

std::vector<ParameterEstimate> estimates(const Problem& problem, const Fit& fit, double scale, bool profiled, std::uint64_t seed,
                                         const FitOptions& options) {
  std::vector<ParameterEstimate> result;
  if (options.interrupted && options.interrupted()) {  // slopes that were not simulated would make intervals of nothing
    for (std::size_t i = 0; i < fit.layout.shared.size(); ++i) {
      ParameterEstimate e = named_after(fit.layout.shared[i], fit.shared[static_cast<Eigen::Index>(i)]);
      e.lower = fit.layout.shared[i].lower;
      e.upper = fit.layout.shared[i].upper;
      result.push_back(e);
    }
    return result;
  }
  const Eigen::VectorXd se = standard_errors(problem, fit, scale);
  const std::vector<Interval> over_runs = run_bootstrap(problem, fit, bootstrap_replicas, seed);
  for (std::size_t i = 0; i < fit.layout.shared.size(); ++i) {
    const Parameter& p = fit.layout.shared[i];
    const auto k = static_cast<Eigen::Index>(i);
    ParameterEstimate e = named_after(p, fit.shared[k]);
    Interval interval{std::max(p.lower, e.value - ninety * se[k]), std::min(p.upper, e.value + ninety * se[k])};
    if (profiled) interval = profile_interval(problem, fit, i, se[k], scale, options);
    e.lower = interval.lower;
    e.upper = interval.upper;
    if (!over_runs.empty()) e.over_runs = over_runs[i];
    result.push_back(e);
  }
  for (ParameterEstimate& e : estimates_over_runs(problem, fit, scale)) result.push_back(std::move(e));
  return result;
}

}  // namespace repose::diagnosis
