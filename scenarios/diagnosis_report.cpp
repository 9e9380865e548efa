#include "scenarios/diagnosis_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/report/markup.hpp"
#include "scenarios/diagnosis_charts.hpp"
#include "scenarios/diagnosis_values.hpp"
#include "scenarios/diagnosis_words.hpp"

namespace repose {
namespace {

using namespace diagnosis;
using namespace report;

constexpr double least_shown = 0.1;        // share that a curve explains: below it, its chart shows nothing
constexpr std::size_t runs_for_a_chart = 4;
constexpr std::size_t most_places = 10, most_residual_charts = 12, charts_in_front = 2;

std::string three(double x) { return number(x, 3); }

/// Numbers beside the sentence: the error now, the constants found, how sure.
std::vector<Headline> headlines(const Diagnosis& d) {
  const FittedHypothesis& nominal = d.models.front();
  const FittedHypothesis& best = d.models[d.best];
  const std::string where = has_held_out(d) ? "Error on runs not used" : "Error on the fitted runs";
  std::vector<Headline> list;
  list.push_back({where, error_in_sigma(best.held_out), std::nullopt, "σ", d.best == 0 ? "1 σ is the noise alone" : fmt::format("before: {} σ", three(error_in_sigma(nominal.held_out)))});
  if (d.best != 0 && d.verdict.word != "unknown")
    for (const std::string& effect : names_in_order(best.hypothesis))
      for (const ParameterEstimate& p : parameters_of(best, effect))
        if (list.size() < 4)
          list.push_back({symbol_of(p.name) + " of " + effects_in_words({effect}), p.value, 0.5 * (p.upper - p.lower), written_unit(p.unit), "half the 90 % interval"});
  if (d.best == 0) list.push_back({"Lack of fit, p", d.lack_of_fit_p, std::nullopt, "", fmt::format("from {} replicas of noise", d.replicas)});
  const Ranked& first = d.verdict.ranked.front();
  list.push_back({"Probability of " + effects_in_words(effects_in_order(d, first)), std::round(100 * first.probability), std::nullopt, "%", ""});
  return list;
}

Table places(const Diagnosis& d) {
  Table table{"Where", {"run", "body", "phase", "from [s]", "to [s]", "seen in", "missing force x, y, z [N]", "p"}, {}, {}};
  const auto found = static_cast<std::size_t>(std::count_if(d.where.begin(), d.where.end(), [](const Located& l) { return l.p <= level; }));
  const std::size_t shown = std::min({most_places, d.where.size(), std::max<std::size_t>(1, found)});
  for (std::size_t i = 0; i < shown; ++i) {
    const Located& l = d.where[i];
    table.rows.push_back({d.run_ids[l.run], l.segment.body, phase_name(l.segment.phase), three(l.segment.from), three(l.segment.to), l.observable,
                          fmt::format("{}, {}, {}", number(l.force.x(), 2), number(l.force.y(), 2), number(l.force.z(), 2)), number(l.p, 2)});
  }
  table.notes = {fmt::format("An unknown force on each stretch, tested on the likelihood of the whole record; p is corrected for having looked everywhere "
                             "and never below 1/{}.", d.replicas + 1)};
  if (d.where.size() > shown)
    table.notes.push_back(fmt::format("Of {} stretches, {} {} (p ≤ {}); all are in diagnosis.json.", d.where.size(), found, found == 1 ? "stands out" : "stand out", level));
  return table;
}

Table parameters(const Diagnosis& d) {
  Table table{"Constants", {"constant", "of", "value", "90 % from", "to", "unit"}, {}, {}};
  const FittedHypothesis& best = d.models[d.best];
  std::vector<ParameterEstimate> all = parameters_of(best, "");
  for (const std::string& effect : names_in_order(best.hypothesis))
    for (const ParameterEstimate& p : parameters_of(best, effect)) all.push_back(p);
  for (const ParameterEstimate& p : all)
    table.rows.push_back({p.name, p.effect.empty() ? "calibrated" : effects_in_words({p.effect}), number(p.value, 4), number(p.lower, 4), number(p.upper, 4), written_unit(p.unit)});
  return table;
}

Table before_and_after(const Diagnosis& d) {
  Table table{"Before and after", {"runs", "measure", "nominal", "extended"}, {}, {}};
  const FittedHypothesis& nominal = d.models.front();
  const FittedHypothesis& best = d.models[d.best];
  const auto add = [&](const std::string& which, const Score& a, const Score& b) {
    const std::string runs = fmt::format("{} {}", a.runs.size(), which);
    table.rows.push_back({runs, "error [σ]", three(error_in_sigma(a)), three(error_in_sigma(b))});
    for (const auto& [name, rmse] : a.rmse)
      table.rows.push_back({runs, fmt::format("rms error of {}{}", name, name == "position" ? " [m]" : name == "orientation" ? " [rad]" : ""), three(rmse), three(b.rmse.at(name))});
    table.rows.push_back({runs, "log likelihood [nats]", number(a.log_likelihood, 5), number(b.log_likelihood, 5)});
  };
  if (has_held_out(d)) {
    add("held out", nominal.held_out, best.held_out);
    table.notes = {fmt::format("Held out: physics frozen, only start values fitted. The gain over these runs has p = {} (one-sided, paired) and effect size {}.",
                               number(d.paired_p, 2), number(d.effect_size, 2))};
  } else {
    table.notes = {"Nothing was held out: these recordings have shaped the model, so that its fit to them proves little."};
  }
  add("fitted", nominal.train, best.train);
  return table;
}

/// What each held-out run says by itself.
Chart gains(const Diagnosis& d) {
  const Score& before = d.models.front().held_out;
  const Score& after = d.models[d.best].held_out;
  Chart chart;
  chart.title = "Gain of each held-out run";
  chart.x = {"held-out run, in the order of the bundle", ""};
  chart.y = {"gain in log likelihood", "nats"};
  chart.low = true;
  Series series{"extended over nominal", {}, {}, {}, Series::Style::points, false};
  for (std::size_t i = 0; i < before.per_run.size() && i < after.per_run.size(); ++i) {
    series.x.push_back(static_cast<double>(i + 1));
    series.y.push_back(after.per_run[i] - before.per_run[i]);
  }
  chart.series.push_back(std::move(series));
  chart.bands.push_back({"no gain", 0, 0});
  return chart;
}

Table uses(const Diagnosis& d, const Bundle& bundle) {
  Table table{"Runs", {"use", "number", "runs"}, {}, {}};
  const auto list = [](const std::vector<std::string>& ids) {
    const std::size_t shown = std::min<std::size_t>(24, ids.size());
    std::string text = fmt::format("{}", fmt::join(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
    return shown < ids.size() ? text + fmt::format(" and {} more", ids.size() - shown) : text;
  };
  std::vector<std::string> fitted(d.run_ids.begin(), d.run_ids.begin() + static_cast<std::ptrdiff_t>(d.train_runs));
  std::vector<std::string> held(d.run_ids.begin() + static_cast<std::ptrdiff_t>(d.train_runs), d.run_ids.end()), unused;
  for (const BundleRun& run : bundle.runs)
    if (std::find(d.run_ids.begin(), d.run_ids.end(), run.id) == d.run_ids.end()) unused.push_back(run.id);
  for (const auto& [use, ids] : {std::pair{"fitted", &fitted}, {"held out, judged", &held}, {"not used", &unused}})
    if (!ids->empty()) table.rows.push_back({use, std::to_string(ids->size()), list(*ids)});
  return table;
}

/// What to record next, or that nothing that was tried would tell.
Table next_recordings(const Diagnosis& d) {
  Table table{"What to record next", {"recording", "would tell", "from", "chance, test at 1 %"}, {}, {}};
  bool worth_it = false;
  for (const SuggestedRecording& s : d.suggested) {
    const auto words = [&](const std::string& label, const std::string& other) { return effects_in_words(only_in(names_of(d, label), names_of(d, other))); };
    table.rows.push_back({s.what, words(s.first, s.second), words(s.second, s.first), percent(std::clamp(s.power, 0.0, 1.0))});
    worth_it = worth_it || s.power >= worth_recording;
  }
  table.notes = {"Every run recorded once more with this change, at the same noise. The chance allows each explanation to move its constants as far as these recordings let it."};
  if (!worth_it) table.notes.insert(table.notes.begin(), "No change of the start, of masses or of sizes that was tried would tell them apart; this is the best of them.");
  return table;
}

Section what_is_missing(const Diagnosis& d) {
  Section section{"What explains it", {ranking(d)}};
  if (!d.verdict.indistinguishable.empty())
    section.blocks.emplace_back(Warnings{{"These recordings cannot tell apart: " + effects_in_words(d.verdict.indistinguishable.front()) + "."}});
  if (!d.suggested.empty()) section.blocks.emplace_back(next_recordings(d));
  if (!d.depends_on.empty() && d.depends_on.front().explained >= least_shown && d.verdict.word != "none") section.blocks.emplace_back(force_chart(d));
  if (Table table = parameters(d); !table.rows.empty()) section.blocks.emplace_back(std::move(table));
  return section;
}

}  // namespace

Report diagnosis_report(const Diagnosis& d, const Bundle& bundle, const std::vector<std::pair<std::string, std::string>>& settings) {
  Report r;
  r.title = verdict_in_words(d);
  r.subtitle = "Diagnosis of: " + bundle.title;
  r.lead = diagnosis_in_words(d);
  r.headlines = headlines(d);

  std::vector<Chart> residuals = residual_charts(d);
  Section where{d.verdict.word == "none" ? "Residuals" : "Where simulation and recordings differ", {}};
  for (std::size_t i = 0; i < std::min(charts_in_front, residuals.size()); ++i) where.blocks.emplace_back(residuals[i]);
  if (!d.where.empty() && d.verdict.word != "none") where.blocks.emplace_back(places(d));
  r.sections.push_back(std::move(where));
  r.sections.push_back(what_is_missing(d));
  if (d.best != 0) {
    r.sections.push_back({"What it is worth", {before_and_after(d)}});
    if (has_held_out(d) && d.models.front().held_out.per_run.size() >= runs_for_a_chart) r.sections.back().blocks.emplace_back(gains(d));
  }
  Section left_out{"What was used, and what was left out", {uses(d, bundle)}};
  left_out.blocks.emplace_back(Warnings{d.notes});
  r.sections.push_back(std::move(left_out));
  if (residuals.size() > charts_in_front) {
    Section more{"More residuals", {}};
    for (std::size_t i = charts_in_front; i < std::min(most_residual_charts, residuals.size()); ++i) {
      residuals[i].low = true;
      more.blocks.emplace_back(std::move(residuals[i]));
    }
    r.sections.push_back(std::move(more));
  }
  Settings all{"Settings", settings};
  all.entries.emplace_back("simulations", std::to_string(d.simulations));
  all.entries.emplace_back("replicas of noise", std::to_string(d.replicas));
  all.entries.emplace_back("lack of fit before, p", number(d.lack_of_fit_p, 2));
  all.entries.emplace_back("lack of fit after, p", number(d.remaining_p, 2));
  for (const auto& [name, noise] : d.noise) {
    if (const auto stated = d.stated_noise.find(name); stated != d.stated_noise.end()) all.entries.emplace_back("noise of " + name + ", stated", three(stated->second) + unit_of(name));
    all.entries.emplace_back("noise of " + name + ", used", fmt::format("{}{}, correlation {:.2f}", three(noise.sd), unit_of(name), noise.phi));
    if (const std::string why = raised_noise_in_words(d, name); !why.empty()) all.entries.emplace_back("noise of " + name + ", why", why);
  }
  const std::string extended = d.best == 0                      ? "extended.yaml: the scene as calibrated"
                               : d.verdict.word == "unknown" ? "extended.yaml: the scene with what comes nearest, which explains too little to be believed"
                                                             : "extended.yaml: the scene with what was missing";
  r.sections.push_back({"How it was found", {std::move(all), Listing{extended, d.extended_scene}}});
  return r;
}

}  // namespace repose
