#include "scenarios/diagnosis_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/report/report.hpp"

namespace repose {
namespace {

using namespace diagnosis;

bool is_component(const std::string& name) { return name == "0" || name == "1" || name == "2"; }

}  // namespace

std::string with_spaces(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string effects_in_words(const std::vector<std::string>& effects) {
  if (effects.empty()) return "nothing missing";
  if (effects.size() == 1 && effects.front() == "unknown") return "something outside the library";
  std::string words;
  for (std::size_t i = 0; i < effects.size(); ++i)
    words += (i == 0 ? "" : i + 1 == effects.size() ? " and " : ", ") + with_spaces(effects[i]);
  return words;
}

std::vector<std::string> names_in_order(const Hypothesis& hypothesis) {
  std::vector<std::string> absent, stated;
  for (const Term& term : hypothesis.terms) (term.stated.empty() ? absent : stated).push_back(term.row->name);
  absent.insert(absent.end(), stated.begin(), stated.end());
  return absent;
}

std::vector<std::string> effects_in_order(const Diagnosis& d, const Ranked& ranked) {
  std::vector<std::string> effects = ranked.effects;
  if (ranked.model < 0) return effects;
  const std::vector<Term>& terms = d.models[static_cast<std::size_t>(ranked.model)].hypothesis.terms;
  std::stable_partition(effects.begin(), effects.end(), [&](const std::string& name) {
    return std::none_of(terms.begin(), terms.end(), [&](const Term& term) { return term.row->name == name && !term.stated.empty(); });
  });
  return effects;
}

std::vector<std::string> names_of(const Diagnosis& d, const std::string& label) {
  for (const FittedHypothesis& m : d.models)
    if (m.hypothesis.label() == label) return m.hypothesis.names();
  return {};
}

std::vector<std::string> only_in(std::vector<std::string> first, const std::vector<std::string>& second) {
  std::erase_if(first, [&](const std::string& name) { return std::find(second.begin(), second.end(), name) != second.end(); });
  return first;
}

std::string symbol_of(const std::string& key) {
  static const std::map<std::string, std::string> symbols = {
      {"friction", "µ"}, {"rolling_friction", "ρ"}, {"restitution", "e"}, {"viscosity", "η"}, {"coefficient", "C"}};
  const std::size_t dot = key.rfind('.');
  std::string last = dot == std::string::npos ? key : key.substr(dot + 1);
  if (is_component(last) && dot != std::string::npos)
    return fmt::format("{} {}", symbol_of(key.substr(0, dot)), "xyz"[last[0] - '0']);
  if (const auto found = symbols.find(last); found != symbols.end()) return found->second;
  if (last.ends_with("_deg")) last.erase(last.size() - 4);
  return with_spaces(last);
}

std::string written_unit(const std::string& unit) {
  if (unit == "1") return "";
  if (unit == "deg") return "°";
  std::string text;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    if (unit[i] != '^' || i + 1 == unit.size()) {
      text += unit[i];
      continue;
    }
    ++i;
    text += unit[i] == '2' ? "²" : unit[i] == '3' ? "³" : std::string("^") + unit[i];
  }
  return text;
}

std::string value_in_words(const ParameterEstimate& p) {
  const std::string number = report::rounded(p.value, 0.5 * (p.upper - p.lower)), unit = written_unit(p.unit);
  return unit.empty() ? number : number + (unit == "°" ? "" : " ") + unit;
}

double error_in_sigma(const Score& score) { return std::sqrt(std::max(0.0, score.chi2_per_dof)); }

std::vector<ParameterEstimate> parameters_of(const FittedHypothesis& model, const std::string& effect) {
  std::vector<ParameterEstimate> list;
  for (const ParameterEstimate& p : model.parameters)
    if (p.effect == effect) list.push_back(p);
  return list;
}

double probability_of(const Verdict& verdict, const std::string& effect) {
  double sum = 0;
  for (const Ranked& r : verdict.ranked)
    if (std::find(r.effects.begin(), r.effects.end(), effect) != r.effects.end()) sum += r.probability;
  return std::min(1.0, sum);
}

double probability_of(const Diagnosis& d, const std::string& effect) { return probability_of(d.verdict, effect); }

std::string unit_of(const std::string& observable) {
  static const std::map<std::string, std::string> units = {
      {"position", " m"}, {"orientation", " rad"}, {"height", " m"}, {"speed", " m/s"}, {"specific_force", " m/s²"}};
  const auto found = units.find(observable);
  return found == units.end() ? "" : found->second;
}

double raised_noise(const Diagnosis& d, const std::string& observable) {
  const auto sensor = d.sensor_noise.find(observable);
  const auto used = d.noise.find(observable);
  if (sensor == d.sensor_noise.end() || used == d.noise.end() || !(used->second.sd > 1.01 * sensor->second)) return 0;
  return std::sqrt(used->second.sd * used->second.sd - sensor->second * sensor->second);
}

bool has_held_out(const Diagnosis& d) { return !d.models.front().held_fit.runs.empty(); }

}  // namespace repose
