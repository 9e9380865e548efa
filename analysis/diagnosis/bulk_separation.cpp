#include "analysis/diagnosis/bulk_separation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "analysis/diagnosis/bulk_statistics.hpp"

namespace repose::diagnosis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double surely = 0.95;
constexpr double fewest_runs = 8;  // a further observable is worth little in one run

struct Choice {
  std::string what;
  std::vector<BulkSummary> summaries;
  double runs = 0;
};

/// Those that some packing changes: what is always the same (the bare plate before a layer) parts nothing, and has no scatter to be weighed by.
std::vector<BulkSummary> that_vary(const std::vector<BulkSummary>& all, const std::vector<BulkOutcome>& a, const std::vector<BulkOutcome>& b) {
  std::vector<BulkSummary> result;
  for (const BulkSummary& s : all) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto* outcomes : {&a, &b}) {
      const MatrixXd rows = complete_rows(rows_of(*outcomes, {s}));
      if (rows.rows() == 0) continue;
      low = std::min(low, rows.minCoeff());
      high = std::max(high, rows.maxCoeff());
    }
    if (high > low) result.push_back(s);
  }
  return result;
}

std::vector<Choice> choices(const std::vector<BulkSummary>& at_hand, const std::vector<BulkSummary>& possible, double runs) {
  std::vector<Choice> all;
  for (const double times : {2.0, 4.0, 8.0})
    all.push_back({fmt::format("the same observables in {:.0f} runs", times * runs), at_hand, times * runs});
  const double enough = std::max(runs, fewest_runs);
  std::set<std::string> known, fresh;
  for (const BulkSummary& s : at_hand) known.insert(s.observable);
  for (const BulkSummary& s : possible)
    if (!known.contains(s.observable)) fresh.insert(s.observable);
  const auto with = [&](const std::set<std::string>& names) {
    Choice choice{fmt::format("also record {} in {:.0f} runs", fmt::join(names, ", "), enough), at_hand, enough};
    for (const BulkSummary& s : possible)
      if (names.contains(s.observable)) choice.summaries.push_back(s);
    return choice;
  };
  for (const std::string& name : fresh) all.push_back(with({name}));
  if (fresh.size() > 1) all.push_back(with(fresh));
  return all;
}

}  // namespace

SuggestedRecording bulk_recording_that_parts(const BulkModel& first, const BulkModel& second, const BulkModel& nominal, const BulkData& data,
                                             const std::vector<Observation>& recorded) {
  SuggestedRecording best;
  best.first = first.candidate.hypothesis.label();
  best.second = second.candidate.hypothesis.label();
  const std::vector<BulkOutcome> a = outcomes_at_fit(first, nominal, data, data.first_fitted()), b = outcomes_at_fit(second, nominal, data, data.first_fitted());
  if (a.size() < 2 || b.size() < 2) return best;
  double runs = 0;
  for (const BulkSetting& s : data.settings) runs += static_cast<double>(s.train.rows() + s.held.rows());
  bool sure = false;
  for (const Choice& choice : choices(that_vary(summaries_of(recorded), a, b), that_vary(summaries_of(a.front().observations), a, b), runs)) {
    const MatrixXd rows[] = {complete_rows(rows_of(a, choice.summaries)), complete_rows(rows_of(b, choice.summaries))};
    if (rows[0].rows() < 2 || rows[1].rows() < 2) continue;
    const VectorXd delta = (rows[0].colwise().mean() - rows[1].colwise().mean()).transpose();
    const double by_chance = static_cast<double>(delta.size()) * (1.0 / static_cast<double>(rows[0].rows()) + 1.0 / static_cast<double>(rows[1].rows()));
    const double power = chance_to_part(squared_distance(delta, shrunken_scatter(rows).covariance) - by_chance, choice.runs);
    if (sure || power <= best.power) continue;
    best.power = power;
    best.what = choice.what;
    sure = power >= surely;
  }
  return best;
}

}  // namespace repose::diagnosis
