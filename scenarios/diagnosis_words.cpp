#include "scenarios/diagnosis_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "analysis/report/markup.hpp"
#include "analysis/report/report.hpp"
#include "scenarios/diagnosis_values.hpp"

namespace repose {
namespace {

using namespace diagnosis;

constexpr double clearly_more_than_noise = 1.5;  // sigma
constexpr std::size_t few_to_prove = 3;

std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

std::string joined(const std::vector<std::string>& words, const std::string& last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) text += (i == 0 ? "" : i + 1 == words.size() ? " " + last + " " : ", ") + words[i];
  return text;
}

std::string counted(std::size_t n, const std::string& what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

std::string three(double x) { return report::number(x, 3); }

/// "Between 0.12 s and 0.58 s"; "At 0.396 s" where both are written alike.
std::string time_in_words(const Segment& segment) {
  const std::string from = three(segment.from), to = three(segment.to);
  return from == to ? fmt::format("At {} s", from) : fmt::format("Between {} s and {} s", from, to);
}

/// "Between 0.12 s and 0.58 s of run push-1, while the ball rolls, it slows by 0.69 m/s² that the model does not have."
std::string place_sentence(const Diagnosis& d, bool by_a_force) {
  if (d.where.empty() || d.where.front().p > level) return "Simulation and recordings differ, though no single stretch stands out. ";
  const Located& l = d.where.front();
  const std::string force = by_a_force ? force_in_words(l) : "";
  return fmt::format("{} of run {}, {}, {}. ", time_in_words(l.segment), d.run_ids[l.run], phase_in_words(l.segment), force.empty() ? "simulation and recording part" : force);
}

/// " instead of the 0.3 that the scene states", where the effect contradicts the scene.
std::string as_stated(const FittedHypothesis& model, const std::string& effect) {
  std::vector<std::string> values;
  for (const Term& term : model.hypothesis.terms)
    for (std::size_t i = 0; i < term.stated.size() && term.row->name == effect; ++i)
      if (!term.row->parameters[i].held) values.push_back(three(term.stated[i]));
  return values.empty() ? "" : " instead of the " + joined(values, "and") + " that the scene states";
}

/// "ρ = 0.100 ± 0.010, force = ...".
std::string values_of(const FittedHypothesis& model, const std::string& effect) {
  std::vector<std::string> values;
  for (const ParameterEstimate& p : parameters_of(model, effect)) values.push_back(symbol_of(p.name) + " = " + value_in_words(p));
  return joined(values, "and") + as_stated(model, effect);
}

/// "rolling friction (ρ = 0.10 ± 0.01)".
std::string with_values(const FittedHypothesis& model, const std::string& effect) {
  const std::string values = values_of(model, effect);
  return effects_in_words({effect}) + (values.empty() ? "" : " (" + values + ")");
}

/// "Rolling friction explains it: ρ = 0.10 ± 0.01."
std::string explanation(const Diagnosis& d, const std::string& adverb) {
  const FittedHypothesis& best = d.models[d.best];
  const std::vector<std::string> names = names_in_order(best.hypothesis);
  if (names.size() == 1) {
    const std::string values = values_of(best, names.front());
    return capitalised(effects_in_words(names)) + " explains it" + adverb + (values.empty() ? "" : ": " + values);
  }
  std::vector<std::string> parts;
  for (const std::string& name : names) parts.push_back(with_values(best, name));
  return capitalised(joined(parts, "and")) + " explain it" + adverb + (names.size() > 1 ? " together" : "");
}

std::vector<std::string> rivals(const Diagnosis& d) {
  const std::vector<std::string> own = d.models[d.best].hypothesis.names();
  std::vector<std::string> others;
  for (const auto& group : d.verdict.indistinguishable)
    for (const std::string& name : group)
      if (std::find(own.begin(), own.end(), name) == own.end()) others.push_back(effects_in_words({name}));
  return others;
}

/// Of the effects of the best that which has rivals; and the others, of which there is no doubt.
struct Doubt {
  std::string name;
  std::vector<std::string> sure;
};

Doubt doubt(const Diagnosis& d) {
  Doubt result{"", names_in_order(d.models[d.best].hypothesis)};
  if (result.sure.empty()) return result;
  const auto& groups = d.verdict.indistinguishable;
  auto open = result.sure.begin();
  if (!groups.empty())
    if (const auto named = std::find(result.sure.begin(), result.sure.end(), groups.front().front()); named != result.sure.end()) open = named;
  result.name = *open;
  result.sure.erase(open);
  return result;
}

/// "Rolling friction (ρ = 0.02) explains it together with gravity tilt (x = 1.2°) or uniform force: these recordings cannot tell which of the two."
std::string explanation_in_doubt(const Diagnosis& d) {
  const FittedHypothesis& best = d.models[d.best];
  const std::vector<std::string> others = rivals(d);
  const Doubt one = doubt(d);
  if (one.sure.empty()) return explanation(d, " best") + "; but these recordings cannot tell it from " + joined(others, "or") + ". ";
  std::vector<std::string> sure, open{with_values(best, one.name)};
  for (const std::string& name : one.sure) sure.push_back(with_values(best, name));
  open.insert(open.end(), others.begin(), others.end());
  return capitalised(joined(sure, "and")) + (sure.size() == 1 ? " explains" : " explain") + " it together with " + joined(open, "or") +
         ": these recordings cannot tell which of the " + (open.size() == 2 ? "two" : "three") + ". ";
}

/// "On 12 recordings that were not used, the error falls from 9.1 σ to 1.02 σ."
std::string worth(const Diagnosis& d) {
  const Score& before = d.models.front().held_out;
  const Score& after = d.models[d.best].held_out;
  const double a = error_in_sigma(before), b = error_in_sigma(after);
  const std::size_t n = before.runs.size();
  if (d.verdict.by_fitted_runs)
    return fmt::format("The {} not used {} not show it ({} σ before and {} σ after), and no prediction proves it.",
                       n == 1 ? "recording that was" : fmt::format("{} recordings that were", n), n == 1 ? "does" : "do", three(a), three(b));
  std::string text = has_held_out(d) ? fmt::format("On {} that {} not used, the error ", counted(n, "recording"), n == 1 ? "was" : "were")
                                     : std::string("No recording was held out; on those that were fitted, which proves little, the error ");
  text += b < a ? fmt::format("falls from {} σ to {} σ", three(a), three(b)) : fmt::format("does not fall ({} σ before, {} σ after)", three(a), three(b));
  if (has_held_out(d) && b < a && n < 2)
    text += "; one recording is no proof";
  else if (has_held_out(d) && b < a && d.paired_p > 0.05 && n <= few_to_prove)
    text += fmt::format("; only {} were held out, too few to prove it", counted(n, "recording"));
  else if (has_held_out(d) && b < a && d.paired_p > 0.05)
    text += fmt::format("; the gain differs so much between them that it is not yet proven (p = {:.2g})", d.paired_p);
  text += ".";
  if (d.remaining_p <= level && b > clearly_more_than_noise) text += " What is left is still more than noise: something else is missing too.";
  return text;
}

std::string next_recording(const Diagnosis& d) {
  if (d.suggested.empty()) return "";
  const SuggestedRecording& s = d.suggested.front();
  if (s.power < worth_recording)
    return fmt::format(" No change of the start, of masses or of sizes that was tried would tell them apart; the best, {}, has a chance of {}.", s.what,
                       report::percent(std::clamp(s.power, 0.0, 1.0)));
  return fmt::format(" A recording that would tell: {} (chance {}).", s.what, report::percent(std::clamp(s.power, 0.0, 1.0)));
}

std::string when_nothing_was_tested() {
  return "Nothing could be tested: no effect and no force would show in what was recorded, as where there are as many free values as samples. That is no word for the scene. "
         "Record more samples, or measure start values instead of leaving them free.";
}

std::string when_nothing_is_missing(const Diagnosis& d) {
  if (!d.tested) return when_nothing_was_tested();
  const FittedHypothesis& nominal = d.models.front();
  const std::size_t n = nominal.held_out.runs.size();
  std::string text = d.lack_of_fit_p > diagnosis::level
                         ? fmt::format("Nothing is missing: the scene explains the recordings within their noise (lack of fit p = {:.2g}). ", d.lack_of_fit_p)
                     : d.held_out_p
                         ? fmt::format("Nothing is missing that the recordings show twice: the fitted ones differ as chance makes one in {:.0f} differ (p = {:.2g}), those that were "
                                       "held out do not (p = {:.2g}). ", 1 / d.lack_of_fit_p, d.lack_of_fit_p, *d.held_out_p)
                         : fmt::format("Nothing that could be called physics is missing: what stands out (p = {:.2g}) is smaller than what the step of another "
                                       "simulation may do. ", d.lack_of_fit_p);
  std::vector<std::string> constants;
  for (const ParameterEstimate& p : nominal.parameters) constants.push_back(symbol_of(p.name) + " = " + value_in_words(p));
  if (!constants.empty()) text += "Calibrated from them: " + joined(constants, "and") + ". ";
  text += has_held_out(d) ? fmt::format("On {} that {} not used, the error is {} σ.", counted(n, "recording"), n == 1 ? "was" : "were",
                                        three(error_in_sigma(nominal.held_out)))
                          : fmt::format("The error is {} σ; no recording was held out.", three(error_in_sigma(nominal.train)));
  if (d.scene_error > 1)
    text += fmt::format(" Stepped as the scene says it would miss them by another {} σ: a smaller time_step, or `integration: second_order`, takes that away.", three(d.scene_error));
  return text;
}

/// What the fitted recordings do not show.
std::string when_only_held_out_differ(const Diagnosis& d) {
  const std::size_t n = d.only_held_out.size();
  return place_sentence(d, true) + fmt::format("The scene explains the recordings that were fitted, within their noise (p = {:.2g}), but not {}, which {} held out: there the error is {} σ. "
                                               "Either {} misread, or something acts there that the others do not show, and no effect in the library explains it.",
                                               d.lack_of_fit_p, joined(d.only_held_out, "and"), n == 1 ? "was" : "were", three(error_in_sigma(d.models.front().held_out)),
                                               n == 1 ? "it was" : "they were");
}

std::string when_nothing_explains(const Diagnosis& d) {
  if (!d.only_held_out.empty()) return when_only_held_out_differ(d);
  std::string text = place_sentence(d, true) + "Something is missing, and no effect in the library explains it. ";
  const std::vector<std::string> names = d.models[d.best].hypothesis.names();
  const double before = error_in_sigma(d.models.front().held_out);
  if (names.empty())
    return text + fmt::format("On {} the error is {} σ.", has_held_out(d) ? "recordings that were not used" : "the recordings", three(before));
  return text + fmt::format("The nearest, {}, removes {} of the misfit; the error falls from {} σ to {} σ only.", effects_in_words(names),
                            report::percent(std::clamp(d.explained, 0.0, 1.0)), three(before), three(error_in_sigma(d.models[d.best].held_out)));
}

std::string by_verdict(const Diagnosis& d) {
  const std::string& verdict = d.verdict.word;
  if (verdict == "none") return when_nothing_is_missing(d);
  if (verdict == "unknown" || d.best == 0) return when_nothing_explains(d);
  const Numerics& how = d.models[d.best].fit.layout.numerics;
  if (verdict == "numerics" && !how.backend.empty())
    return place_sentence(d, false) +
           fmt::format("{} when {} solves the scene, at {:.2g} of its step: that is how engines differ, and no physics that is missing. ",
                       d.remaining_p > level ? "The mismatch goes away" : "The mismatch becomes least", how.backend, how.step_factor) +
           worth(d);
  const auto second_order = [](const FittedHypothesis& m) { return m.fit.layout.numerics.second_order; };
  if (verdict == "numerics" && second_order(d.models.front()) && !second_order(d.models[d.best]))
    return place_sentence(d, false) + "The mismatch goes away when the scene is solved with a step's errors: the recordings are those of a simulation with such a step. " +
           worth(d);
  if (verdict == "numerics")
    return place_sentence(d, false) + "The mismatch goes away with a finer simulation (" +
           effects_in_words(d.models[d.best].hypothesis.names()) + "): the scene's numerics are at fault, not the world. " + worth(d);
  if (verdict == "measurement")
    return place_sentence(d, false) + explanation(d, "") + ". That is an error of the measurement: " +
           d.models[d.best].hypothesis.terms.front().row->claim + " No physics is missing. " + worth(d);
  if (verdict == "ambiguous")
    return place_sentence(d, true) + explanation_in_doubt(d) + worth(d) + next_recording(d);
  return place_sentence(d, true) + explanation(d, "") + ". " + worth(d);
}

}  // namespace

std::string phase_in_words(const Segment& segment) {
  switch (segment.phase) {
    case Phase::flight: return "while the " + segment.body + " flies";
    case Phase::impact: return "while the " + segment.body + " hits";
    case Phase::sliding: return "while the " + segment.body + " slides";
    case Phase::rolling: return "while the " + segment.body + " rolls";
    case Phase::rest: return "while the " + segment.body + " rests";
  }
  return "";
}

std::string force_in_words(const Located& l) {
  const double size = l.force.norm();
  if (!(size > 2 * l.force_se.norm()) || !std::isfinite(size)) return "";
  const auto told = [&](double force) {
    return l.mass > 0 ? fmt::format("{:.2g} m/s²", std::abs(force) / l.mass) : fmt::format("{:.2g} N", std::abs(force));
  };
  if (l.segment.phase == Phase::impact)
    return fmt::format("its velocity changes by {:.2g} m/s that the model does not have", size * (l.segment.to - l.segment.from) / std::max(l.mass, 1e-300));
  const double speed = l.segment.velocity.norm();
  const double along = speed > 0 ? l.force.dot(l.segment.velocity) / speed : 0;
  if (l.segment.phase != Phase::rest && std::abs(along) > 0.7 * size)
    return fmt::format("it {} by {} that the model does not have", along < 0 ? "slows" : "gains speed", told(along));
  Eigen::Index axis = 0;
  l.force.cwiseAbs().maxCoeff(&axis);
  return fmt::format("it is pushed towards {}{} by {} that the model does not have", l.force[axis] < 0 ? "−" : "+", "xyz"[axis], told(size));
}

std::string verdict_in_words(const Diagnosis& d) {
  const std::string& verdict = d.verdict.word;
  const std::string names = effects_in_words(names_in_order(d.models[d.best].hypothesis));
  if (verdict == "none") return d.tested ? "Nothing is missing" : "Nothing could be tested";
  if (verdict == "unknown" || d.best == 0) return "Something is missing that is not in the library";
  if (verdict == "ambiguous") {
    const Doubt one = doubt(d);
    std::vector<std::string> open = rivals(d);
    open.insert(open.begin(), effects_in_words({one.name}));
    return "Missing: " + (one.sure.empty() ? "" : effects_in_words(one.sure) + ", and ") + joined(open, "or");
  }
  if (verdict == "measurement") return "A measurement error: " + names;
  if (verdict == "numerics") return "Numerics, not physics: " + names;
  return "Missing: " + names;
}

std::string raised_noise_in_words(const Diagnosis& d, const std::string& observable) {
  const auto stated = d.stated_noise.find(observable);
  const auto sensor = d.sensor_noise.find(observable);
  const auto used = d.noise.find(observable);
  if (sensor == d.sensor_noise.end() || used == d.noise.end()) return "";
  const std::string unit = unit_of(observable);
  std::string text;
  if (stated != d.stated_noise.end() && sensor->second > 1.01 * stated->second)
    text = fmt::format("The bundle states {}{}; by {} it is at least {}{}. ", three(stated->second), unit,
                       d.understated.contains(observable) ? "the scatter of the samples" : "the steps of the readings, or their range,", three(sensor->second), unit);
  if (const double step = raised_noise(d, observable); step > 0)
    text += fmt::format("To the {}{} {} come {}{} by which the step of a simulation may err here, in squares: {}{} in all, so that the step does not pass for physics. "
                        "An error below 1 σ is the sign of it; a smaller time_step takes it away.",
                        three(sensor->second), unit, stated != d.stated_noise.end() && text.empty() ? "that the bundle states" : "of the sensor", three(step), unit,
                        three(used->second.sd), unit);
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

std::string diagnosis_in_words(const Diagnosis& d) {
  std::string text = (d.interrupted ? "Interrupted; this is what was found until then. " : "") + by_verdict(d);
  for (const auto& [name, scatter] : d.understated)
    text += fmt::format(" The bundle states a noise of {0}{1} for {2}, but its samples scatter by {3}{1} from one to the next, and the scene leaves no more: that was taken for the noise.",
                        three(d.stated_noise.at(name)), unit_of(name), name, three(scatter));
  for (const auto& [name, share] : d.overstated)
    text += fmt::format(" But {} differs by {} of the noise that the bundle states: what is smaller than that noise cannot be seen, and if it is not in SI units, nothing was tested.",
                        name, three(share));
  return text;
}

}  // namespace repose
