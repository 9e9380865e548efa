#include "scenarios/bulk_diagnosis_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "analysis/diagnosis/bulk_data.hpp"
#include "analysis/diagnosis/bulk_statistics.hpp"
#include "analysis/report/report.hpp"
#include "scenarios/diagnosis_values.hpp"

namespace repose {
namespace {

using nlohmann::json;
using namespace diagnosis;

json number(double x) { return std::isfinite(x) ? json(x) : json(nullptr); }

template <class T>
json number(const std::optional<T>& x) {
  return x ? json(*x) : json(nullptr);
}

json runs_json(const BulkScore& score, const Bundle& bundle) {
  json list = json::array();
  for (const std::size_t run : score.runs) list.push_back(bundle.runs[run].id);
  return list;
}

json score_json(const BulkScore& score) {
  if (score.runs.empty()) return json::object();
  return {{"chi2_per_dof", number(score.chi2_per_dof)}, {"rmse", score.rmse}};
}

json missing_json(const BulkDiagnosis& d) {
  json list = json::array();
  if (d.verdict.word == "none" || d.verdict.word == "unknown") return list;
  const BulkFitted& best = d.models[d.best];
  for (const Term& term : best.model.candidate.hypothesis.terms) {
    const std::string& effect = term.row->name;
    json parameters = json::object();
    for (const BulkEstimate& e : best.estimates)
      if (e.effect == effect && e.name.find(term.place) != std::string::npos) parameters[e.name] = {{"value", e.value}, {"lower", e.lower}, {"upper", e.upper}, {"unit", e.unit}};
    list.push_back({{"effect", effect}, {"probability", probability_of(d.verdict, effect)}, {"parameters", parameters}});
  }
  return list;
}

/// Of the nominal scene, that the runs of the first fitted setting were compared with.
std::size_t packings_of(const BulkDiagnosis& d) {
  const BulkModel& nominal = d.models.front().model;
  return outcomes_at_fit(nominal, nominal, d.data, d.data.first_fitted()).size();
}

json where_json(const BulkDiagnosis& d, const Bundle& bundle) {
  json list = json::array();
  std::vector<std::string> grains;
  for (const GrainPopulation& population : bundle.scene.grains) grains.push_back(population.name);
  const std::vector<std::size_t>& runs = d.data.settings[d.data.first_fitted()].train_runs;
  for (const BulkLocated& l : d.where)
    list.push_back({{"observable", l.observable},
                    {"body", fmt::format("{}", fmt::join(grains, ", "))},
                    {"phase", l.phase},
                    {"run", bundle.runs[runs[l.run]].id},
                    {"t_start", number(l.t_start)},
                    {"t_end", number(l.t_end)},
                    {"region", l.radius_from ? json{{"radius_from", *l.radius_from}, {"radius_to", *l.radius_to}} : json(nullptr)},
                    {"quantity", l.quantity.empty() ? json(nullptr) : json(l.quantity)},
                    {"p", l.p},
                    {"difference", l.difference},
                    {"in_scatter", l.in_scatter}});
  return list;
}

/// Effects, as in a diagnosis of few bodies: what each has that the other lacks. One effect in two places is told apart by its place.
json separates_json(const BulkDiagnosis& d, const SuggestedRecording& s) {
  const auto names_of = [&](const std::string& label) {
    const auto found = std::find_if(d.models.begin(), d.models.end(), [&](const BulkFitted& m) { return m.model.candidate.hypothesis.label() == label; });
    return found == d.models.end() ? std::vector<std::string>{} : found->model.candidate.hypothesis.names();
  };
  const std::vector<std::string> first = names_of(s.first), second = names_of(s.second);
  const std::vector<std::string> only_first = only_in(first, second), only_second = only_in(second, first);
  if (only_first == only_second) return {s.first, s.second};
  const auto written = [](const std::vector<std::string>& names) { return names.empty() ? std::string("none") : fmt::format("{}", fmt::join(names, " + ")); };
  return {written(only_first), written(only_second)};
}

/// The last time of a run's series; none: it has none.
std::optional<double> end_of(const BundleRun& run) {
  std::optional<double> end;
  for (const Observation& o : run.observations)
    if (o.kind == ObservableKind::series && !o.time.empty()) end = std::max(end.value_or(o.time.back()), o.time.back());
  return end;
}

/// How much of each run with series was compared.
json compared_json(const Bundle& bundle) {
  std::vector<std::string> told_already;
  const Bundle cut = of_equal_length(bundle, told_already);
  json list = json::array();
  for (std::size_t i = 0; i < bundle.runs.size(); ++i)
    if (const std::optional<double> until = end_of(cut.runs[i])) list.push_back({{"run", bundle.runs[i].id}, {"until", *until}, {"recorded_until", *end_of(bundle.runs[i])}});
  return list;
}

json summaries_json(const BulkDiagnosis& d) {
  json list = json::array();
  const BulkModel& nominal = d.models.front().model;
  const std::size_t setting = d.data.first_fitted();
  const Eigen::MatrixXd plain = rows_at_fit(nominal, nominal, d.data, setting), full = rows_at_fit(d.models[d.best].model, nominal, d.data, setting);
  for (std::size_t k = 0; k < d.data.summaries.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const auto mean = [&](const Eigen::MatrixXd& rows) { return rows.rows() > 0 ? number(complete_rows(rows.col(column)).mean()) : json(nullptr); };
    const BulkSummary& s = d.data.summaries[k];
    list.push_back({{"name", s.name},
                    {"unit", s.unit},
                    {"recorded", mean(d.data.settings[setting].train)},
                    {"nominal", mean(plain)},
                    {"extended", mean(full)},
                    {"sd_seed", std::sqrt(d.scatter(column, column))}});
  }
  return list;
}

/// Of a heap or a layer: micrometres to metres.
std::string length_in_words(double metres) {
  if (std::abs(metres) < 1e-3) return fmt::format("{:.3g} µm", 1e6 * metres);
  return std::abs(metres) < 1 ? fmt::format("{:.3g} mm", 1e3 * metres) : fmt::format("{:.3g} m", metres);
}

/// "rolling friction (0.043, 0.022 to 0.070) and length scale (factor = 1.09, 1.08 to 1.09)".
std::string in_words(const BulkFitted& model) {
  std::string words;
  const std::vector<Term>& terms = model.model.candidate.hypothesis.terms;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    std::string values;
    for (const BulkEstimate& e : model.estimates) {
      if (e.effect != terms[i].row->name || e.name.find(terms[i].place) == std::string::npos) continue;
      const std::string last = e.name.substr(e.name.rfind('.') + 1);
      values += fmt::format("{}{}{:.3g}{}, {:.3g} to {:.3g}", values.empty() ? "" : "; ", last == e.effect ? "" : with_spaces(last) + " = ", e.value, e.unit == "1" ? "" : " " + e.unit, e.lower, e.upper);
    }
    words += (i == 0 ? "" : " and ") + with_spaces(terms[i].row->name) + (values.empty() ? "" : " (" + values + ")");
  }
  if (!model.model.candidate.backend.empty()) words += " (" + model.model.candidate.backend + ")";
  return words;
}

/// What the effects claim, one sentence each.
std::string claims_of(const BulkFitted& best) {
  std::string text;
  for (const Term& term : best.model.candidate.hypothesis.terms) text += (text.empty() ? "" : " ") + term.row->claim;
  return text;
}

}  // namespace

json bulk_diagnosis_json(const BulkDiagnosis& d, const Bundle& bundle) {
  json result;
  const BulkFitted& nominal = d.models.front();
  const BulkFitted& best = d.models[d.best];
  result["verdict"] = d.verdict.word;
  result["headline"] = bulk_diagnosis_in_words(d);
  result["missing"] = missing_json(d);
  for (const Ranked& r : d.verdict.ranked) {
    json entry = {{"effects", r.effects}, {"probability", r.probability}};
    if (r.model >= 0) {
      const BulkFitted& m = d.models[static_cast<std::size_t>(r.model)];
      entry["heldout_log_likelihood"] = number(r.held_out);
      entry["where_it_acts"] = m.model.candidate.hypothesis.label();
      entry["train_chi2_per_dof"] = number(m.train.chi2_per_dof);
      entry["parameters"] = json::object();
      for (const BulkEstimate& e : m.estimates) entry["parameters"][e.name] = {{"value", e.value}, {"lower", e.lower}, {"upper", e.upper}, {"unit", e.unit}};
    }
    result["ranked"].push_back(entry);
  }
  result["indistinguishable"] = d.verdict.indistinguishable;
  result["suggested_recordings"] = json::array();
  for (const SuggestedRecording& s : d.suggested)
    result["suggested_recordings"].push_back({{"what", s.what}, {"separates", separates_json(d, s)}, {"power", s.power}});
  result["where"] = where_json(d, bundle);
  result["depends_on"] = json::array();
  json calibrated = json::object();
  for (const BulkEstimate& e : nominal.estimates) calibrated[e.name] = {{"value", e.value}, {"lower", e.lower}, {"upper", e.upper}};
  result["nominal"] = {{"calibrated", calibrated}, {"lack_of_fit_p", d.lack_of_fit_p}, {"replicas", packings_of(d)}, {"null", "packings"}};
  result["fit"]["train"] = {{"runs", runs_json(nominal.train, bundle)}, {"nominal", score_json(nominal.train)}, {"extended", score_json(best.train)}};
  result["fit"]["heldout"] = {{"runs", runs_json(nominal.held_out, bundle)}, {"nominal", score_json(nominal.held_out)}, {"extended", score_json(best.held_out)},
                              {"paired_p", d.paired_p}, {"effect_size", d.effect_size}};
  result["compared"] = compared_json(bundle);
  result["extended_scene"] = "extended.yaml";
  if (!best.model.candidate.backend.empty()) result["extended_backend"] = best.model.candidate.backend;
  result["summaries"] = summaries_json(d);
  result["tested"] = json::array();
  for (const Eigen::Index k : d.data.tested) result["tested"].push_back(d.data.summaries[static_cast<std::size_t>(k)].name);
  result["scatter_dof"] = d.scatter_dof;
  result["remaining_p"] = d.remaining_p;
  result["explained"] = d.explained;
  result["simulations"] = d.simulations;
  result["notes"] = d.notes;
  return result;
}

std::string bulk_diagnosis_in_words(const BulkDiagnosis& d) {
  if (d.models.empty()) return "Interrupted before the nominal scene was simulated.";
  if (d.interrupted && d.models.size() == 1)
    return fmt::format("Interrupted: the nominal scene was simulated (lack of fit p = {:.2g}), no candidate was judged yet.", d.lack_of_fit_p);
  if (d.verdict.word == "none")
    return d.tested_dimensions > 0 ? fmt::format("Nothing is missing: the nominal scene explains what was recorded within the scatter of its packings (p = {:.2g}).", d.lack_of_fit_p)
                                   : "Nothing can be said: there are as many free constants as tested numbers.";
  std::string text = d.interrupted ? "Interrupted; this is what was found until then. " : "";
  if (!d.where.empty()) {
    const BulkLocated& l = d.where.front();
    text += fmt::format("The recorded {}{} differs from the nominal scene by {:.1f} standard deviations of a single run{} (p = {:.2g}). ", with_spaces(l.observable), l.quantity.empty() ? "" : " (" + l.quantity + ")", std::abs(l.in_scatter),
                       l.radius_from ? fmt::format(" between {} and {} from the axis", length_in_words(*l.radius_from), length_in_words(*l.radius_to))
                       : l.t_start   ? fmt::format(" between {:.3g} and {:.3g} s", *l.t_start, *l.t_end)
                                     : "",
                       l.p);
  }
  if (d.verdict.word == "unknown" || d.best == 0) return text + "Something is missing that no candidate explains.";
  const BulkFitted& best = d.models[d.best];
  std::string name = in_words(best);
  const bool several = best.model.candidate.hypothesis.terms.size() > 1;
  if (d.verdict.word == "ambiguous") {
    // The first of the class is the best's own.
    const std::vector<std::string>& alike = d.verdict.indistinguishable.front();
    text += fmt::format("The best explanation is {}; these observables cannot tell {} from {}.", name, several ? with_spaces(alike.front()) : "it",
                        with_spaces(fmt::format("{}", fmt::join(alike.begin() + 1, alike.end(), " or "))));
  } else {
    name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
    text += name + (several ? " explain it." : " explains it.");
  }
  if (!best.held_out.runs.empty())
    text += fmt::format(" On {} recordings that were not used, χ² per number falls from {:.3g} to {:.3g}.", best.held_out.runs.size(), d.models.front().held_out.chi2_per_dof,
                        best.held_out.chi2_per_dof);
  for (const SuggestedRecording& s : d.suggested) text += fmt::format(" To tell {} from {}: {} (chance {:.0f} %).", with_spaces(s.first), with_spaces(s.second), s.what, 100 * s.power);
  return text + (several ? " Claims: " : " Claim: ") + claims_of(best);
}

}  // namespace repose
