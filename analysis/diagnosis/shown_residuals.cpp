#include "analysis/diagnosis/shown_residuals.hpp"

#include <algorithm>
#include <utility>

#include "analysis/diagnosis/diagnose.hpp"
#include "analysis/diagnosis/verdict.hpp"

namespace repose::diagnosis {
namespace {

constexpr std::size_t shown_runs = 6;

std::vector<std::size_t> located_first(std::vector<std::size_t> runs, const std::vector<Located>& where) {
  std::stable_partition(runs.begin(), runs.end(), [&](std::size_t run) {
    return std::any_of(where.begin(), where.end(), [&](const Located& l) { return l.run == run && l.p <= level; });
  });
  if (!where.empty()) std::stable_partition(runs.begin(), runs.end(), [&](std::size_t run) { return run == where.front().run; });
  return runs;
}

void add_run(const Problem& problem, std::size_t run, const Fit& plain, const Fit& full, std::vector<ResidualSample>& samples) {
  const Eigen::VectorXd before = problem.plain_residual(plain.layout, run, plain.shared, plain.own[run]);
  const Eigen::VectorXd after = problem.plain_residual(full.layout, run, full.shared, full.own[run]);
  if (before.size() == 0 || after.size() == 0) return;
  for (const Channel& c : problem.runs()[run].channels) {
    const auto n = static_cast<Eigen::Index>(c.time.size());
    if (n == 0) continue;
    ResidualSample s{problem.runs()[run].run->id, c.observable, c.time, {}, {}};
    for (double& t : s.time) t += problem.runs()[run].run->from;
    if (c.observable == "position") s.channel += std::string(" ") + "xyz"[c.axis];
    if (c.observable == "orientation") s.channel += std::string(" about ") + "xyz"[c.axis];
    if (!c.body.empty()) s.channel = c.body + ": " + s.channel;
    s.nominal.assign(before.data() + c.first, before.data() + c.first + n);
    s.extended.assign(after.data() + c.first, after.data() + c.first + n);
    samples.push_back(std::move(s));
  }
}

}  // namespace

std::vector<ResidualSample> shown_residuals(const Problem& problem, const FittedHypothesis& nominal, const FittedHypothesis& best, const std::vector<Located>& where) {
  std::vector<ResidualSample> samples;
  std::size_t shown = 0;
  const auto add = [&](const Fit& plain, const Fit& full, std::size_t most) {
    for (const std::size_t run : located_first(plain.runs, where)) {
      if (shown == most) return;
      ++shown;
      add_run(problem, run, plain, full, samples);
    }
  };
  add(nominal.fit, best.fit, nominal.held_fit.runs.empty() ? shown_runs : shown_runs / 2);
  if (!nominal.held_fit.runs.empty()) add(nominal.held_fit, best.held_fit, shown_runs);
  return samples;
}

}  // namespace repose::diagnosis
