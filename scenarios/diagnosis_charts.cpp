#include "scenarios/diagnosis_charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/report/markup.hpp"
#include "scenarios/diagnosis_values.hpp"

namespace repose {
namespace {

using namespace diagnosis;
using namespace report;

double sum_of_squares(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values)
    if (std::isfinite(v)) sum += v * v;
  return sum;
}

/// Significant stretches of a run, in time; those of the same name that touch or overlap are one.
std::vector<Window> windows_of(const Diagnosis& d, const std::string& run) {
  std::vector<Window> windows;
  for (const Located& l : d.where)
    if (l.p <= level && d.run_ids[l.run] == run) windows.push_back({fmt::format("{}, p = {}", phase_name(l.segment.phase), number(l.p, 2)), l.segment.from, l.segment.to});
  std::sort(windows.begin(), windows.end(), [](const Window& a, const Window& b) { return a.from < b.from; });
  std::vector<Window> joined;
  for (const Window& w : windows) {
    if (!joined.empty() && joined.back().name == w.name && w.from <= joined.back().to + 1e-9)
      joined.back().to = std::max(joined.back().to, w.to);
    else
      joined.push_back(w);
  }
  return joined;
}

bool is_held_out(const Diagnosis& d, const std::string& run) {
  const auto found = std::find(d.run_ids.begin(), d.run_ids.end(), run);
  return static_cast<std::size_t>(found - d.run_ids.begin()) >= d.train_runs;
}

Chart residual_chart(const Diagnosis& d, const ResidualSample& s) {
  Chart chart;
  chart.title = fmt::format("{}, {} ({})", s.run, s.channel, is_held_out(d, s.run) ? "held out" : "fitted");
  chart.x = {"time", "s"};
  chart.y = {"simulated − recorded", "σ"};
  chart.series.push_back({d.best == 0 ? "residual" : "before: nominal scene", s.time, s.nominal, {}, Series::Style::points, false});
  if (d.best != 0) chart.series.push_back({"after: extended scene", s.time, s.extended, {}, Series::Style::points, false});
  chart.bands.push_back({"noise, ±2 σ", 0, 2});
  chart.windows = windows_of(d, s.run);
  return chart;
}

struct Variable {
  std::string words, unit;
};

const Variable& variable(const std::string& name) {
  static const std::map<std::string, Variable> all = {
      {"speed", {"speed", "m/s"}},         {"slip_speed", {"slip speed", "m/s"}}, {"normal_force", {"normal force", "N"}},
      {"spin", {"spin", "rad/s"}},         {"position", {"position", "m"}},       {"height", {"height", "m"}},
      {"time", {"time", "s"}},             {"temperature", {"temperature", "K"}}, {"direction", {"direction", "rad"}},
      {"impact_speed", {"speed of impact", "m/s"}}, {"size", {"size", "m"}}};
  static const Variable other;
  const auto found = all.find(name);
  return found == all.end() ? other : found->second;
}

/// c x^power from nothing to the largest x.
Series curve_of(const Dependence& dependence, double until) {
  const int power = dependence.curve == "quadratic" ? 2 : 1, points = 41;
  Series curve{power == 2 ? "in proportion to its square" : "in proportion to it", {}, {}, {}, Series::Style::line, true};
  for (int i = 0; i < points; ++i) {
    const double x = until * i / (points - 1);
    curve.x.push_back(x);
    curve.y.push_back(dependence.coefficient * std::pow(x, power));
  }
  return curve;
}

}  // namespace

std::vector<Chart> residual_charts(const Diagnosis& d) {
  std::vector<const ResidualSample*> samples;
  for (const ResidualSample& s : d.residuals) samples.push_back(&s);
  const std::string first = d.where.empty() ? "" : d.run_ids[d.where.front().run];
  std::stable_sort(samples.begin(), samples.end(), [&](const ResidualSample* a, const ResidualSample* b) {
    const bool a_first = a->run == first, b_first = b->run == first;
    return a_first != b_first ? a_first : sum_of_squares(a->nominal) > sum_of_squares(b->nominal);
  });
  std::vector<Chart> charts;
  for (const ResidualSample* s : samples) charts.push_back(residual_chart(d, *s));
  return charts;
}

Chart force_chart(const Diagnosis& d) {
  const Dependence& best = d.depends_on.front();
  const Variable& x = variable(best.variable);
  Chart chart;
  chart.title = "The force that the model lacks, against " + x.words;
  chart.x = {x.words, x.unit};
  chart.y = {"force against the motion", "N"};
  Series points{"one stretch of one run", {}, {}, {}, Series::Style::points, false};
  std::size_t unseen = 0;
  double until = 0;
  for (const Located& l : d.where) {
    if (l.segment.phase == Phase::impact) continue;  // told as a mean over the samples beside it, far below what acts in the moment
    const ForceAgainstMotion force = against_motion(l);
    // A stretch whose error is as large as a body's weight says nothing and would only stretch the axis.
    if (!std::isfinite(force.se) || (l.mass > 0 && force.se > 9.81 * l.mass)) {
      ++unseen;
      continue;
    }
    points.x.push_back(variable_of(l.segment, best.variable));
    points.y.push_back(force.value);
    points.error.push_back(force.se);
    until = std::max(until, points.x.back());
  }
  chart.series.push_back(std::move(points));
  chart.series.push_back(curve_of(best, until));
  chart.caption = fmt::format("Of what stretches that were left out show, this curve explains {}.", percent(best.explained));
  for (std::size_t i = 1; i < std::min<std::size_t>(3, d.depends_on.size()); ++i)
    chart.caption += fmt::format("{} {} {}", i == 1 ? " Others:" : ",", variable(d.depends_on[i].variable).words, percent(d.depends_on[i].explained));
  if (d.depends_on.size() > 1) chart.caption += ".";
  chart.caption += " Bars: one standard error.";
  if (unseen > 0) chart.caption += fmt::format(" {} stretch{} in which no force could be seen {} left out.", unseen, unseen == 1 ? "" : "es", unseen == 1 ? "is" : "are");
  return chart;
}

Bars ranking(const Diagnosis& d) {
  Bars bars{"What could explain it", {}, ""};
  for (const Ranked& r : d.verdict.ranked) {
    Bar bar{effects_in_words(effects_in_order(d, r)), std::clamp(r.probability, 0.0, 1.0), "", false};
    if (r.model >= 0) {
      const FittedHypothesis& m = d.models[static_cast<std::size_t>(r.model)];
      std::string places;
      for (const Term& term : m.hypothesis.terms)
        if (!term.place.empty()) places += (places.empty() ? "" : ", ") + term.place;
      if (!places.empty()) bar.label += " (" + places + ")";
      bar.note = fmt::format("leaves {} σ", number(error_in_sigma(m.held_out), 3));
    }
    bar.strong = bars.bars.empty();
    bars.bars.push_back(std::move(bar));
  }
  bars.caption = fmt::format("Probabilities come from the likelihood of {}, less a price for each parameter and effect. Beside them: the error that each leaves there.",
                             has_held_out(d) ? "runs that were not fitted" : "the fitted runs, for none was held out");
  return bars;
}

}  // namespace repose
