#include "scenarios/diagnosis_json.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/diagnosis_values.hpp"
#include "scenarios/diagnosis_words.hpp"

namespace repose {
namespace {

using nlohmann::json;
using namespace diagnosis;

json parameters_json(const FittedHypothesis& model, const std::string& effect) {
  json list = json::object();
  for (const ParameterEstimate& p : parameters_of(model, effect)) {
    list[p.name] = {{"value", p.value}, {"lower", p.lower}, {"upper", p.upper}, {"unit", p.unit}};
    if (p.over_runs) list[p.name]["over_runs"] = {{"lower", p.over_runs->lower}, {"upper", p.over_runs->upper}};
  }
  return list;
}

json suggestion_json(const Diagnosis& d, const SuggestedRecording& s) {
  const std::vector<std::string> first = names_of(d, s.first), second = names_of(d, s.second);
  const auto written = [](const std::vector<std::string>& names) { return names.empty() ? std::string("none") : fmt::format("{}", fmt::join(names, " + ")); };
  return {{"what", s.what}, {"separates", {written(only_in(first, second)), written(only_in(second, first))}}, {"power", s.power}};
}

json noise_json(const Diagnosis& d, const std::string& observable, const NoiseModel& noise) {
  json result = {{"sd", noise.sd}, {"correlation", noise.phi}};
  if (const auto stated = d.stated_noise.find(observable); stated != d.stated_noise.end()) result["stated"] = stated->second;
  if (const auto sensor = d.sensor_noise.find(observable); sensor != d.sensor_noise.end()) result["of_recordings"] = sensor->second;
  if (const std::string why = raised_noise_in_words(d, observable); !why.empty()) result["why"] = why;
  return result;
}

json score_json(const Diagnosis& d, const FittedHypothesis& model, bool held) {
  const Score& s = held ? model.held_out : model.train;
  json result = {{"chi2_per_dof", s.chi2_per_dof}, {"rmse", s.rmse}, {"log_likelihood", s.log_likelihood}};
  const Fit& fit = held && !model.held_fit.runs.empty() ? model.held_fit : model.fit;
  // Start values of each run: with them, the extended scene gives this score.
  for (const std::size_t run : s.runs)
    for (std::size_t i = 0; i < fit.layout.per_run[run].size(); ++i) {
      const Parameter& p = fit.layout.per_run[run][i];
      // The number of a bias is its observation's, not that of an axis.
      const std::string name = p.component < 0 ? p.key : fmt::format("{}.{}{}", p.key, p.use == Parameter::Use::bias ? "observable_" : "", p.component);
      result["own"][d.run_ids[run]][name] = fit.own[run][static_cast<Eigen::Index>(i)];
    }
  return result;
}

json run_names(const Diagnosis& d, const Score& score) {
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
  const bool held = has_held_out(d);
  const bool named = d.verdict.word != "none" && d.verdict.word != "unknown";
  for (const std::string& effect : named ? names_in_order(best.hypothesis) : std::vector<std::string>{})
    result["missing"].push_back({{"effect", effect}, {"probability", probability_of(d, effect)}, {"parameters", parameters_json(best, effect)}});
  for (const Ranked& r : d.verdict.ranked) {
    json entry = {{"effects", effects_in_order(d, r)}, {"probability", r.probability}};
    if (r.model >= 0) {
      const FittedHypothesis& model = d.models[static_cast<std::size_t>(r.model)];
      if (held) {
        entry["heldout_log_likelihood"] = model.held_out.log_likelihood;
        entry["predicted_log_likelihood"] = r.held_out;
      }
      entry["where_it_acts"] = model.hypothesis.label();
      entry["train_chi2_per_dof"] = model.train.chi2_per_dof;
    }
    result["ranked"].push_back(entry);
  }
  result["indistinguishable"] = d.verdict.indistinguishable;
  result["suggested_recordings"] = json::array();
  for (const SuggestedRecording& s : d.suggested)
    result["suggested_recordings"].push_back(suggestion_json(d, s));
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
  result["nominal"] = {{"calibrated", calibrated}, {"lack_of_fit_p", d.lack_of_fit_p}, {"replicas", d.replicas}, {"null", d.bootstrapped ? "bootstrap" : "noise"}};
  result["fit"]["train"] = {{"runs", run_names(d, nominal.train)}, {"nominal", score_json(d, nominal, false)}, {"extended", score_json(d, best, false)}};
  result["fit"]["heldout"] = {{"runs", held ? run_names(d, nominal.held_out) : json::array()},
                              {"nominal", held ? score_json(d, nominal, true) : json::object()},
                              {"extended", held ? score_json(d, best, true) : json::object()},
                              {"paired_p", d.paired_p},
                              {"effect_size", d.effect_size}};
  result["compared"] = json::array();
  for (const Compared& c : d.compared) result["compared"].push_back({{"run", c.run}, {"until", c.until}, {"recorded_until", c.recorded_until}});
  result["extended_scene"] = "extended.yaml";
  if (const std::string& backend = d.models[d.best].fit.layout.numerics.backend; !backend.empty()) result["extended_backend"] = backend;
  for (const auto& [name, noise] : d.noise) result["noise"][name] = noise_json(d, name, noise);
  result["remaining_p"] = d.remaining_p;
  result["tested"] = d.tested;
  result["held_out_p"] = d.held_out_p ? json(*d.held_out_p) : json(nullptr);
  result["only_held_out"] = d.only_held_out;
  result["by_fitted_runs"] = d.verdict.by_fitted_runs;
  result["explained"] = d.explained;
  result["explained_accelerations"] = d.accelerations;
  result["simulations"] = d.simulations;
  result["notes"] = d.notes;
  return result;
}

}  // namespace repose
