#include "scenarios/diagnosis_json.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/report/report.hpp"
#include "core/effect_library.hpp"

namespace repose {
namespace {

using nlohmann::json;
using namespace diagnosis;

json parameters_json(const FittedHypothesis& model, const std::string& effect) {
  json list = json::object();
  for (const ParameterEstimate& p : model.parameters)
    if (p.effect == effect) list[p.name] = {{"value", p.value}, {"lower", p.lower}, {"upper", p.upper}, {"unit", p.unit}};
  return list;
}

double probability_of(const Diagnosis& d, const std::vector<std::string>& effects) {
  for (const Ranked& r : d.verdict.ranked)
    if (r.effects == effects) return r.probability;
  return 0;
}

json score_json(const Diagnosis& d, const FittedHypothesis& model, bool held) {
  const Score& s = held ? model.held_out : model.train;
  json result = {{"chi2_per_dof", s.chi2_per_dof}, {"rmse", s.rmse}, {"log_likelihood", s.log_likelihood}};
  const Fit& fit = held && !model.held_fit.runs.empty() ? model.held_fit : model.fit;
  // Start values of each run: with them, the extended scene gives this score.
  for (const std::size_t run : s.runs)
    for (std::size_t i = 0; i < fit.layout.per_run[run].size(); ++i) {
      const Parameter& p = fit.layout.per_run[run][i];
      const std::string name = p.component < 0 ? p.key : fmt::format("{}.{}", p.key, p.component);
      result["own"][d.run_ids[run]][name] = fit.own[run][static_cast<Eigen::Index>(i)];
    }
  return result;
}

json names_of(const Diagnosis& d, const Score& score) {
  json list = json::array();
  for (const std::size_t run : score.runs) list.push_back(d.run_ids[run]);
  return list;
}


}  // namespace

json diagnosis_json(const Diagnosis& d) {
  const FittedHypothesis& nominal = d.models.front();
  const FittedHypothesis& best = d.models[d.best];
  json result;
  result["verdict"] = d.verdict.word;
  result["headline"] = diagnosis_in_words(d);
  result["missing"] = json::array();
  for (const std::string& effect : best.hypothesis.names())
    result["missing"].push_back({{"effect", effect},
                                 {"probability", probability_of(d, best.hypothesis.names())},
                                 {"parameters", parameters_json(best, effect)}});
  for (const Ranked& r : d.verdict.ranked) {
    json entry = {{"effects", r.effects}, {"probability", r.probability}};
    if (r.model >= 0) {
      entry["heldout_log_likelihood"] = r.held_out;
      entry["where_it_acts"] = d.models[static_cast<std::size_t>(r.model)].hypothesis.label();
      entry["train_chi2_per_dof"] = d.models[static_cast<std::size_t>(r.model)].train.chi2_per_dof;
    }
    result["ranked"].push_back(entry);
  }
  result["indistinguishable"] = d.verdict.indistinguishable;
  result["suggested_recordings"] = json::array();
  for (const SuggestedRecording& s : d.suggested)
    result["suggested_recordings"].push_back({{"what", s.what}, {"separates", {s.first, s.second}}, {"power", s.power}});
  result["where"] = json::array();
  for (const Located& l : d.where)
    result["where"].push_back({{"observable", l.observable},
                               {"body", l.segment.body},
                               {"phase", phase_name(l.segment.phase)},
                               {"run", d.run_ids[l.run]},
                               {"t_start", l.segment.from},
                               {"t_end", l.segment.to},
                               {"region", nullptr},
                               {"p", l.p},
                               {"force", {l.force.x(), l.force.y(), l.force.z()}},
                               {"force_se", {l.force_se.x(), l.force_se.y(), l.force_se.z()}}});
  result["depends_on"] = json::array();
  for (const Dependence& s : d.depends_on)
    result["depends_on"].push_back({{"variable", s.variable}, {"explained", s.explained}, {"curve", s.curve}});
  json calibrated = json::object();
  for (const ParameterEstimate& p : nominal.parameters) calibrated[p.name] = {{"value", p.value}, {"lower", p.lower}, {"upper", p.upper}};
  result["nominal"] = {{"calibrated", calibrated}, {"lack_of_fit_p", d.lack_of_fit_p}, {"replicas", d.replicas}};
  result["fit"]["train"] = {{"runs", names_of(d, nominal.train)}, {"nominal", score_json(d, nominal, false)}, {"extended", score_json(d, best, false)}};
  const bool held = !nominal.held_fit.runs.empty();
  result["fit"]["heldout"] = {{"runs", held ? names_of(d, nominal.held_out) : json::array()},
                              {"nominal", held ? score_json(d, nominal, true) : json::object()},
                              {"extended", held ? score_json(d, best, true) : json::object()},
                              {"paired_p", d.paired_p},
                              {"effect_size", d.effect_size}};
  result["extended_scene"] = "extended.yaml";
  for (const auto& [name, noise] : d.noise) result["noise"][name] = {{"sd", noise.sd}, {"correlation", noise.phi}};
  result["remaining_p"] = d.remaining_p;
  result["explained"] = d.explained;
  result["simulations"] = d.simulations;
  result["notes"] = d.notes;
  return result;
}

std::string diagnosis_in_words(const Diagnosis& d) {
  const FittedHypothesis& nominal = d.models.front();
  const FittedHypothesis& best = d.models[d.best];
  std::string text;
  if (d.verdict.word == "none")
    return fmt::format("Nothing is missing: the nominal scene explains the recordings within their noise (lack of fit p = {:.2g}).", d.lack_of_fit_p);
  if (!d.where.empty()) {
    const Located& l = d.where.front();
    text += fmt::format("In run {}, between {:.3g} s and {:.3g} s ({} of {}), the model lacks a force of about {:.2g} N (p = {:.2g}). ", d.run_ids[l.run],
                        l.segment.from, l.segment.to, phase_name(l.segment.phase), l.segment.body, l.force.norm(), l.p);
  }
  if (d.verdict.word == "unknown") return text + "Something is missing that no effect in the library explains.";
  std::string names;
  for (const Term& term : best.hypothesis.terms) {
    names += (names.empty() ? "" : " and ") + term.row->name;
    for (const ParameterEstimate& p : best.parameters)
      if (p.effect == term.row->name) {
        names += fmt::format(" ({} = {}{}{})", p.name.substr(p.name.rfind('.') + 1), report::rounded(p.value, 0.5 * (p.upper - p.lower)),
                             p.unit.empty() || p.unit == "1" ? "" : " ", p.unit == "1" ? "" : p.unit);
        break;
      }
  }
  text += d.verdict.word == "ambiguous" ? "The best explanation is " + names + ", but it cannot be told apart from " : names + " explains it";
  if (d.verdict.word == "ambiguous") {
    bool first = true;
    for (const std::string& other : d.verdict.indistinguishable.front()) {
      bool named = false;
      for (const std::string& own : best.hypothesis.names()) named = named || own == other;
      if (named) continue;
      text += (first ? "" : ", ") + other;
      first = false;
    }
  }
  const bool held = !nominal.held_fit.runs.empty();
  text += fmt::format(". On {} recording{} {}, chi^2 per degree of freedom falls from {:.3g} to {:.3g}.", nominal.held_out.runs.size(),
                      nominal.held_out.runs.size() == 1 ? "" : "s", held ? "that were not used" : "(nothing was held out)", nominal.held_out.chi2_per_dof,
                      best.held_out.chi2_per_dof);
  text += " Claim: " + best.hypothesis.terms.front().row->claim;
  return text;
}

}  // namespace repose
