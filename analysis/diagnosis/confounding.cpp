#include "analysis/diagnosis/confounding.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace repose::diagnosis {
namespace {

constexpr int most_steps = 6;        // of Gauss and Newton
constexpr double gains_enough = 0.02;  // of lambda, relative: less is no reason for another step
constexpr double test_at = 2.58;     // standard deviations: 1 %

double chance_of(double lambda) { return 0.5 * std::erfc((test_at - std::sqrt(std::max(0.0, lambda))) / std::sqrt(2.0)); }

Eigen::VectorXd solved(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient) {
  // Parameters differ by orders of magnitude: pivots must not.
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(0).cwiseSqrt().unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  const Eigen::MatrixXd even = scale.asDiagonal() * information * scale.asDiagonal();
  return scale.asDiagonal() * even.completeOrthogonalDecomposition().solve(scale.asDiagonal() * gradient);
}

/// One model that is taken for the truth, recorded anew, and the other that tries to meet it.
class Duel {
 public:
  Duel(const Problem& problem, const Fit& truth, const Fit& rival, const Eigen::MatrixXd& known, const std::vector<SetValues>& set)
      : problem_(problem), rival_(rival), known_(known), moved_(Values::Zero(rival.shared.size())) {
    for (std::size_t i = 0; i < truth.runs.size(); ++i) {
      const std::size_t run = truth.runs[i];
      const Eigen::VectorXd recorded = residual_of(problem, with(truth, run, set[i]), run);
      rival_ = with(std::move(rival_), run, set[i]);
      const Eigen::VectorXd r = residual_of(problem, rival_, run);
      if (recorded.size() == 0 || r.size() == 0) continue;
      runs_.push_back({run, rival.own[run].size(), recorded, recorded - r, {}, {}});
    }
  }

  bool simulated() const { return !runs_.empty(); }

  /// lambda as straight lines have it; takes the derivatives that a step needs.
  double linear() {
    Eigen::MatrixXd information = known_;
    Eigen::VectorXd gradient = -known_ * moved_;
    double rest = moved_.dot(known_ * moved_);
    for (Run& run : runs_) {
      const RunJacobian j = jacobian(problem_, rival_, run.index);
      run.own = j.own.leftCols(run.free);
      run.shared = j.shared;
      const Eigen::MatrixXd alone = shared_alone({run.shared, run.own});
      const Eigen::VectorXd left = shared_alone({run.difference, run.own});
      information += alone.transpose() * alone;
      gradient += alone.transpose() * left;
      rest += left.squaredNorm();
    }
    step_ = information.size() == 0 ? Eigen::VectorXd() : solved(information, gradient);
    return std::max(0.0, rest - (step_.size() == 0 ? 0 : gradient.dot(step_)));
  }

  /// lambda as simulated, after linear().
  double simulate() {
    double least = objective();
    for (int n = 0; n < most_steps; ++n) {
      const double before = least;
      least = stepped(least);
      if (least > (1 - gains_enough) * before || chance_of(least) < 0.01) break;
      if (linear() > (1 - gains_enough) * least) break;
    }
    return least;
  }

 private:
  struct Run {
    std::size_t index;
    Eigen::Index free;
    Eigen::VectorXd recorded, difference;  ///< what the rival has still to make up for
    Eigen::MatrixXd shared, own;
  };

  double objective() const {
    double sum = moved_.dot(known_ * moved_);
    for (const Run& run : runs_) sum += run.difference.squaredNorm();
    return sum;
  }

  static void move(Values& values, const std::vector<Parameter>& parameters, const Eigen::VectorXd& by) {
    for (Eigen::Index i = 0; i < by.size(); ++i) {
      const Parameter& p = parameters[static_cast<std::size_t>(i)];
      values[i] = std::clamp(values[i] + by[i], std::min(p.lower, values[i]), std::max(p.upper, values[i]));
    }
  }

  /// Takes the step, or the part of it that is no step back.
  double stepped(double least) {
    for (double part = 1; part > 0.1; part /= 2) {
      Duel there = *this;
      move(there.rival_.shared, rival_.layout.shared, part * step_);
      there.moved_ += there.rival_.shared - rival_.shared;
      bool failed = false;
      for (Run& run : there.runs_) {
        if (run.free > 0) {
          const Eigen::VectorXd left = run.difference - (step_.size() == 0 ? Eigen::VectorXd::Zero(run.difference.size()).eval() : (run.shared * step_).eval());
          move(there.rival_.own[run.index], rival_.layout.per_run[run.index], part * run.own.colPivHouseholderQr().solve(left));
        }
        const Eigen::VectorXd r = residual_of(problem_, there.rival_, run.index);
        failed = failed || r.size() == 0;
        if (!failed) run.difference = run.recorded - r;
      }
      if (const double sum = failed ? least : there.objective(); sum < least) {
        rival_ = std::move(there.rival_);
        moved_ = std::move(there.moved_);
        runs_ = std::move(there.runs_);
        return sum;
      }
    }
    return least;
  }

  const Problem& problem_;
  Fit rival_;
  Eigen::MatrixXd known_;
  Values moved_;  ///< shared parameters, from where the old recordings have them
  std::vector<Run> runs_;
  Eigen::VectorXd step_;
};

bool holds(const Hypothesis& large, const Hypothesis& small) {
  const std::vector<std::string> theirs = large.names(), ours = small.names();
  return std::all_of(ours.begin(), ours.end(), [&](const std::string& name) { return std::find(theirs.begin(), theirs.end(), name) != theirs.end(); });
}

/// Both ways round of one pair of models.
class Confounded {
 public:
  Confounded(const Problem& problem, const Fit& first, const Fit& second) : problem_(problem) {
    const Hypothesis &a = first.layout.hypothesis, &b = second.layout.hypothesis;
    if (holds(a, b) || !holds(b, a)) ways_.push_back({&first, &second, information_of(problem, second)});
    if (!holds(a, b)) ways_.push_back({&second, &first, information_of(problem, first)});
  }

  /// At most what lambda() will be, nearly: of one way round, by straight lines. None where nothing can be changed so.
  std::optional<double> estimate(const Change& change) const {
    std::optional<Duel> duel = of(ways_.front(), change);
    if (!duel) return {};
    return duel->linear();
  }

  std::optional<double> lambda(const Change& change) const {
    std::optional<double> least;
    for (const Way& way : ways_) {
      std::optional<Duel> duel = of(way, change);
      if (!duel) return {};
      duel->linear();
      const double lambda = duel->simulate();
      least = std::min(lambda, least.value_or(lambda));
    }
    return least;
  }

 private:
  struct Way {
    const Fit *truth, *rival;
    Eigen::MatrixXd known;  ///< to the rival, by the recordings that there are
  };

  std::optional<Duel> of(const Way& way, const Change& change) const {
    std::vector<SetValues> set;
    bool applies = change.of == Change::Of::nothing;
    for (const std::size_t run : way.truth->runs) {
      set.push_back(changed(problem_, way.truth->layout, way.truth->own[run], run, change));
      applies = applies || !set.back().parameters.empty();
    }
    if (!applies) return {};
    Duel duel(problem_, *way.truth, *way.rival, way.known, set);
    if (!duel.simulated()) return {};
    return duel;
  }

  const Problem& problem_;
  std::vector<Way> ways_;
};

}  // namespace

std::optional<double> chance_to_part(const Problem& problem, const Fit& first, const Fit& second, const Change& change) {
  const std::optional<double> lambda = Confounded(problem, first, second).lambda(change);
  if (!lambda) return {};
  return chance_of(*lambda);
}

SuggestedRecording recording_that_parts(const Problem& problem, const Fit& first, const Fit& second) {
  const Confounded pair(problem, first, second);
  struct Tried {
    Change change;
    double estimate;
  };
  std::vector<Tried> tried;
  for (const Change& change : changes_of(problem, first))
    if (const auto estimate = pair.estimate(change)) tried.push_back({change, *estimate});
  std::stable_sort(tried.begin(), tried.end(), [](const Tried& a, const Tried& b) { return a.estimate > b.estimate; });
  SuggestedRecording best;
  best.first = first.layout.hypothesis.label();
  best.second = second.layout.hypothesis.label();
  double largest = -1;
  for (const Tried& t : tried) {
    if (t.estimate <= largest) break;
    const double lambda = pair.lambda(t.change).value_or(-1);
    if (lambda <= largest) continue;
    largest = lambda;
    best.what = t.change.words();
  }
  best.power = chance_of(largest);
  return best;
}

}  // namespace repose::diagnosis
