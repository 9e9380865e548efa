#include "scenarios/bulk_diagnosis_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/diagnosis/bulk_profile.hpp"
#include "scenarios/bulk_diagnosis_json.hpp"

namespace repose {
namespace {

using namespace diagnosis;
using namespace report;
using nlohmann::json;

constexpr double least_told = 1e-6;  // of probabilities

std::string cell(const json& x, const char* format = "{:.4g}") { return x.is_number() ? fmt::format(fmt::runtime(format), x.get<double>()) : "–"; }

Table ranking(const json& found) {
  Table table{"Candidates", {"explanation", "coefficients", "probability", "held out [nats]", "χ² per number"}, {}, {}};
  for (const json& r : found["ranked"]) {
    std::string values;
    const json parameters = r.value("parameters", json::object());
    for (const auto& [key, p] : parameters.items()) {
      const std::string name = key.substr(key.find('.') + 1);  // of the effect, or of the pair
      values += fmt::format("{}{} = {:.3g} ({:.3g} to {:.3g}) {}", values.empty() ? "" : "; ", name, p["value"].get<double>(), p["lower"].get<double>(), p["upper"].get<double>(),
                            p["unit"].get<std::string>() == "1" ? "" : p["unit"].get<std::string>());
    }
    const std::string name = r["effects"].empty() ? "nothing missing" : r.value("where_it_acts", r["effects"].front().get<std::string>());
    table.rows.push_back({name, values, r["probability"].get<double>() < least_told ? fmt::format("< {}", least_told) : cell(r["probability"], "{:.3g}"), cell(r.value("heldout_log_likelihood", json())), cell(r.value("train_chi2_per_dof", json()), "{:.3g}")});
  }
  table.notes = {"Held out: log likelihood of the runs that were not used. χ²: of the runs that were fitted. Intervals hold 90 % of the posterior; candidates that were not looked at closer have coarse ones."};
  return table;
}

Table summaries(const json& found) {
  Table table{"Recorded and simulated", {"summary", "recorded", "nominal", "extended", "scatter of one run", "unit"}, {}, {}};
  for (const json& s : found["summaries"])
    table.rows.push_back({s["name"].get<std::string>(), cell(s["recorded"]), cell(s["nominal"]), cell(s["extended"]), cell(s["sd_seed"], "{:.2g}"), s["unit"].get<std::string>()});
  table.notes = {fmt::format("Lack of fit is tested on {}.", fmt::join(found["tested"].get<std::vector<std::string>>(), ", "))};
  return table;
}

Table places(const BulkDiagnosis& d) {
  Table table{"Where the nominal scene fails", {"observable", "phase", "part", "recorded − simulated", "in scatters of one run", "p"}, {}, {}};
  for (const BulkLocated& l : d.where)
    table.rows.push_back({l.observable + (l.quantity.empty() ? "" : ", " + l.quantity), l.phase,
                          l.radius_from ? fmt::format("{:.3g} to {:.3g} m", *l.radius_from, *l.radius_to) : l.t_start ? fmt::format("{:.3g} to {:.3g} s", *l.t_start, *l.t_end) : "whole",
                          fmt::format("{:.3g}", l.difference), fmt::format("{:.2f}", l.in_scatter), fmt::format("{:.2g}", l.p)});
  table.notes = {"p is corrected for all parts that were tested (Holm)."};
  return table;
}

const Observation* named(const std::vector<Observation>& all, ObservableKind kind, const std::string& name) {
  for (const Observation& o : all)
    if (o.kind == kind && o.name == name) return &o;
  return nullptr;
}

/// One curve of every kind of run: the first replicate stands for all.
void add_curve(Chart& chart, const std::string& label, const Observation* o, bool points) {
  if (o == nullptr || o->value.empty()) return;
  Series curve{label, o->time, o->value, {}, points ? Series::Style::points : Series::Style::line, false};
  if (o->kind == ObservableKind::profile) {
    BulkProfile last = last_profile(*o);
    curve.x = std::move(last.at);
    curve.y = std::move(last.height);
  }
  chart.series.push_back(std::move(curve));
}

std::vector<Block> curves(const BulkDiagnosis& d, const Bundle& bundle) {
  std::vector<Block> charts;
  const BulkModel& nominal = d.models.front().model;
  const std::size_t setting = d.data.first_fitted();
  const std::vector<BulkOutcome> plain = outcomes_at_fit(nominal, nominal, d.data, setting), full = outcomes_at_fit(d.models[d.best].model, nominal, d.data, setting);
  for (const Observation& o : bundle.runs[d.data.settings[setting].train_runs.front()].observations) {
    if (o.kind != ObservableKind::profile && o.kind != ObservableKind::series) continue;
    Chart chart;
    chart.title = o.name;
    chart.x = {o.kind == ObservableKind::series ? "time" : "radius", o.kind == ObservableKind::series ? "s" : "m"};
    chart.y = {o.kind == ObservableKind::series ? o.name : "height", o.kind == ObservableKind::series ? o.unit : "m"};
    add_curve(chart, "recorded (first run)", &o, true);
    if (!plain.empty()) add_curve(chart, "nominal (first seed)", named(plain.front().observations, o.kind, o.name), false);
    if (!full.empty() && d.best != 0) add_curve(chart, "extended (first seed)", named(full.front().observations, o.kind, o.name), false);
    charts.emplace_back(std::move(chart));
  }
  return charts;
}

}  // namespace

Report bulk_diagnosis_report(const BulkDiagnosis& d, const Bundle& bundle, const std::vector<std::pair<std::string, std::string>>& settings) {
  const json found = bulk_diagnosis_json(d, bundle);
  Report r;
  r.title = "Diagnosis: " + bundle.title;
  r.subtitle = fmt::format("{} runs, {} simulations", bundle.runs.size(), d.simulations);
  r.lead = bulk_diagnosis_in_words(d);
  const BulkScore& best = d.models[d.best].held_out.runs.empty() ? d.models[d.best].train : d.models[d.best].held_out;
  const BulkScore& before = best.runs.empty() || d.models.front().held_out.runs.empty() ? d.models.front().train : d.models.front().held_out;
  if (std::isfinite(best.chi2_per_dof))
    r.headlines.push_back({(d.interrupted ? "Verdict when it was interrupted: " : "Verdict: ") + d.verdict.word, best.chi2_per_dof, std::nullopt, "", fmt::format("χ² per number of the extended scene; nominal {:.3g}", before.chi2_per_dof)});
  Section what{"What is missing", {ranking(found)}};
  if (!d.verdict.indistinguishable.empty())
    what.blocks.emplace_back(Text{fmt::format("These cannot be told apart with the recordings at hand: {}.", fmt::join(d.verdict.indistinguishable.front(), ", "))});
  for (const SuggestedRecording& s : d.suggested)
    what.blocks.emplace_back(Text{fmt::format("To tell {} from {}: {} (chance to tell them apart: {:.0f} %).", s.first, s.second, s.what, 100 * s.power)});
  r.sections.push_back(std::move(what));
  r.sections.push_back({"Before and after", {summaries(found)}});
  if (!d.where.empty()) r.sections.push_back({"Where", {places(d)}});
  if (std::vector<Block> charts = curves(d, bundle); !charts.empty()) r.sections.push_back({"Curves", std::move(charts)});
  Settings all{"Settings", settings};
  const std::vector<std::pair<std::string, std::string>> found_so{{"lack of fit of the nominal scene, p", fmt::format("{:.2g}", d.lack_of_fit_p)},
                                                                  {"of the best model", fmt::format("{:.2g}", d.remaining_p)},
                                                                  {"share of the mismatch explained", fmt::format("{:.2f}", d.explained)},
                                                                  {"degrees of freedom of the scatter between seeds", std::to_string(d.scatter_dof)},
                                                                  {"held-out runs, paired p", fmt::format("{:.2g}", d.paired_p)}};
  all.entries.insert(all.entries.end(), found_so.begin(), found_so.end());
  r.sections.push_back({"How it was found", {std::move(all), Warnings{d.notes}, Listing{"extended.yaml", d.extended_scene}}});
  return r;
}

}  // namespace repose
