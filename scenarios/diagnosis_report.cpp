#include "scenarios/diagnosis_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "scenarios/diagnosis_json.hpp"

namespace repose {
namespace {

using namespace diagnosis;
using namespace report;

std::string joined(const std::vector<std::string>& names) { return names.empty() ? "nothing missing" : fmt::format("{}", fmt::join(names, " + ")); }

Table ranking(const Diagnosis& d) {
  Table table{"Candidates", {"explanation", "acts at", "probability", "held-out log likelihood [nats]", "chi² per degree of freedom, fitted runs"}, {}, {}};
  for (const Ranked& r : d.verdict.ranked) {
    std::vector<std::string> row = {joined(r.effects), "", fmt::format("{:.3g}", r.probability), "–", "–"};
    if (r.model >= 0) {
      const FittedHypothesis& m = d.models[static_cast<std::size_t>(r.model)];
      for (const Term& term : m.hypothesis.terms)
        if (!term.place.empty()) row[1] += (row[1].empty() ? "" : ", ") + term.place;
      row[3] = fmt::format("{:.1f}", r.held_out);
      row[4] = fmt::format("{:.3g}", m.train.chi2_per_dof);
    }
    table.rows.push_back(row);
  }
  table.notes = {"Probabilities come from the likelihood of runs that were not fitted, less a price for each parameter and effect."};
  return table;
}

Table places(const Diagnosis& d) {
  Table table{"Where the nominal scene fails", {"run", "body", "phase", "from [s]", "to [s]", "seen in", "missing force [N]", "p"}, {}, {}};
  for (std::size_t i = 0; i < std::min<std::size_t>(12, d.where.size()); ++i) {
    const Located& l = d.where[i];
    table.rows.push_back({d.run_ids[l.run], l.segment.body, phase_name(l.segment.phase), fmt::format("{:.3g}", l.segment.from),
                          fmt::format("{:.3g}", l.segment.to), l.observable, fmt::format("({:.2g}, {:.2g}, {:.2g})", l.force.x(), l.force.y(), l.force.z()),
                          fmt::format("{:.2g}", l.p)});
  }
  table.notes = {fmt::format("p is corrected for having looked at every stretch of every run; never below 1/{}.", d.replicas + 1)};
  return table;
}

Table before_and_after(const Diagnosis& d) {
  Table table{"Before and after", {"runs", "measure", "nominal", "extended"}, {}, {}};
  const FittedHypothesis& nominal = d.models.front();
  const FittedHypothesis& best = d.models[d.best];
  const auto add = [&](const std::string& which, const Score& a, const Score& b) {
    table.rows.push_back({which, "chi² per degree of freedom", fmt::format("{:.3g}", a.chi2_per_dof), fmt::format("{:.3g}", b.chi2_per_dof)});
    for (const auto& [name, rmse] : a.rmse) table.rows.push_back({which, "rms error of " + name, fmt::format("{:.3g}", rmse), fmt::format("{:.3g}", b.rmse.at(name))});
  };
  add("fitted", nominal.train, best.train);
  if (!nominal.held_fit.runs.empty()) add("held out", nominal.held_out, best.held_out);
  table.notes = {fmt::format("Held out: one-sided p = {:.2g} (paired over runs), effect size {:.2g}.", d.paired_p, d.effect_size)};
  return table;
}

/// Residuals of one run and channel against time.
std::vector<Block> residual_charts(const Diagnosis& d) {
  std::vector<Block> charts;
  for (const ResidualSample& s : d.residuals) {
    if (charts.size() >= 12) break;
    Chart chart;
    chart.title = s.run + ", " + s.channel;
    chart.x = {"time", "s"};
    chart.y = {"simulated minus recorded", "σ"};
    chart.series.push_back({"nominal", s.time, s.nominal, {}, Series::Style::points, false});
    if (d.best != 0) chart.series.push_back({"extended", s.time, s.extended, {}, Series::Style::points, false});
    for (const Located& l : d.where)
      if (l.p <= level && d.run_ids[l.run] == s.run) {
        chart.series.push_back({"located", {l.segment.from, l.segment.to}, {0, 0}, {}, Series::Style::line, false});
        break;
      }
    charts.emplace_back(std::move(chart));
  }
  return charts;
}

Chart shape_chart(const Diagnosis& d) {
  Chart chart;
  const std::string variable = d.depends_on.front().variable;
  chart.title = "The missing force against the variable that explains it best";
  chart.x = {variable, variable == "speed" || variable == "slip_speed" ? "m/s" : variable == "height" ? "m" : variable == "time" ? "s" : variable == "spin" ? "rad/s" : "N"};
  chart.y = {"missing force against the motion", "N"};
  Series series{"one stretch of one run", {}, {}, {}, Series::Style::points, false};
  for (const Located& l : d.where) {
    const double speed = l.segment.velocity.norm();
    const Vec3 along = speed > 0 ? Vec3(l.segment.velocity / speed) : Vec3::UnitZ();
    const Segment& s = l.segment;
    const double x = variable == "speed" ? s.speed : variable == "slip_speed" ? s.slip_speed : variable == "normal_force" ? s.normal_force
                   : variable == "spin" ? s.spin : variable == "height" ? s.height : s.time;
    const double error = l.force_se.norm();
    if (!std::isfinite(error)) continue;
    series.x.push_back(x);
    series.y.push_back(-l.force.dot(along));
    series.error.push_back(error);
  }
  chart.series.push_back(std::move(series));
  chart.caption = fmt::format("A {} law explains {:.0f} % of what left-out runs show.", d.depends_on.front().curve, 100 * d.depends_on.front().explained);
  return chart;
}

}  // namespace

Report diagnosis_report(const Diagnosis& d, const Bundle& bundle) {
  Report r;
  r.title = "Diagnosis: " + bundle.title;
  r.subtitle = fmt::format("{} runs, {} simulations", d.run_ids.size(), d.simulations);
  r.lead = diagnosis_in_words(d);
  r.headlines.push_back({"Verdict: " + d.verdict.word, d.models[d.best].held_out.chi2_per_dof, std::nullopt, "",
                         fmt::format("chi² per degree of freedom of the extended scene; nominal {:.3g}", d.models.front().held_out.chi2_per_dof)});
  Section what{"What is missing", {ranking(d)}};
  if (!d.verdict.indistinguishable.empty())
    what.blocks.emplace_back(Text{"These cannot be told apart with the recordings at hand: " + joined(d.verdict.indistinguishable.front()) + "."});
  for (const SuggestedRecording& s : d.suggested)
    what.blocks.emplace_back(Text{fmt::format("To tell {} from {}: {} (chance to tell them apart: {:.0f} %).", s.first, s.second, s.what, 100 * s.power)});
  r.sections.push_back(std::move(what));
  Table values{"Parameters", {"parameter", "value", "90 % from", "to", "unit"}, {}, {}};
  for (const ParameterEstimate& p : d.models[d.best].parameters)
    values.rows.push_back({p.name, fmt::format("{:.4g}", p.value), fmt::format("{:.4g}", p.lower), fmt::format("{:.4g}", p.upper), p.unit});
  if (!values.rows.empty()) r.sections.back().blocks.emplace_back(std::move(values));
  r.sections.push_back({"Before and after", {before_and_after(d)}});
  if (!d.where.empty()) r.sections.push_back({"Where", {places(d)}});
  if (!d.depends_on.empty()) r.sections.back().blocks.emplace_back(shape_chart(d));
  r.sections.push_back({"Residuals", residual_charts(d)});
  Settings settings{"Settings", {{"replicas of noise", std::to_string(d.replicas)}, {"lack of fit of the nominal scene, p", fmt::format("{:.2g}", d.lack_of_fit_p)}}};
  for (const auto& [name, noise] : d.noise)
    settings.entries.emplace_back("noise of " + name, fmt::format("{:.3g}, correlation of neighbours {:.2f}", noise.sd, noise.phi));
  r.sections.push_back({"How it was found", {std::move(settings), Warnings{d.notes}, Listing{"extended.yaml", d.extended_scene}}});
  return r;
}

}  // namespace repose
