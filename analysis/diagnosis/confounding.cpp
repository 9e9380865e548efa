#include "analysis/diagnosis/confounding.hpp"

#include <fmt/format.h>

#include <cmath>

#include <Eigen/Dense>

namespace repose::diagnosis {
namespace {

struct Change {
  std::string ending, words;  // of the key of a start value
  int component;              // -1: all
  double factor;
};

const std::vector<Change>& changes() {
  static const std::vector<Change> list = [] {
    std::vector<Change> all;
    for (const double factor : {1.0, 0.5, 2.0, 4.0}) {
      const std::string times = factor == 1 ? "" : fmt::format("{} times ", factor);
      if (factor == 1) {
        all.push_back({"", "the same start, recorded again", -1, 1});
        continue;
      }
      all.push_back({".velocity", fmt::format("start at {}the speed", times), -1, factor});
      all.push_back({".angular_velocity", fmt::format("start with {}the spin", times), -1, factor});
      all.push_back({".position", fmt::format("start from {}the height", times), 2, factor});
    }
    return all;
  }();
  return list;
}

double separation(const Problem& problem, const Fit& first, const Fit& second, const Change& change, bool& applies) {
  double lambda = 0;
  for (const std::size_t run : first.runs) {
    Fit a = first, b = second;
    const std::vector<Parameter>& own = a.layout.per_run[run];
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (own[i].use != Parameter::Use::scene || change.ending.empty() || !own[i].key.ends_with(change.ending)) continue;
      if (change.component >= 0 && own[i].component != change.component) continue;
      const auto k = static_cast<Eigen::Index>(i);
      a.own[run][k] = b.own[run][k] = change.factor * first.own[run][k];
      applies = true;
    }
    const Eigen::VectorXd of_a = residual_of(problem, a, run), of_b = residual_of(problem, b, run);
    if (of_a.size() == 0 || of_b.size() == 0) continue;
    Eigen::VectorXd d = of_a - of_b;
    const RunJacobian j = jacobian(problem, a, run);
    if (j.own.cols() > 0) d -= j.own * j.own.colPivHouseholderQr().solve(d);
    lambda += std::min(d.squaredNorm(), 1e6);
  }
  return lambda;
}

}  // namespace

SuggestedRecording recording_that_parts(const Problem& problem, const Fit& first, const Fit& second) {
  SuggestedRecording best;
  best.first = first.layout.hypothesis.label();
  best.second = second.layout.hypothesis.label();
  double largest = -1;
  for (const Change& change : changes()) {
    bool applies = change.ending.empty();
    const double lambda = separation(problem, first, second, change, applies);
    if (!applies || lambda <= largest) continue;
    largest = lambda;
    best.what = change.words;
  }
  best.power = 0.5 * std::erfc((2.58 - std::sqrt(std::max(0.0, largest))) / std::sqrt(2.0));
  return best;
}

}  // namespace repose::diagnosis
