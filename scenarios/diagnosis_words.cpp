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

/// "Between 0.12 s and 0.58 s of run push-1, while the ball rolls, it slows by 0.69 m/s² that the model does not have."
std::string place_sentence(const Diagnosis& d, bool by_a_force) {
  if (d.where.empty() || d.where.front().p > level) return "Simulation and recordings differ, though no single stretch stands out. ";
  const Located& l = d.where.front();
  const std::string force = by_a_force ? force_in_words(l) : "";
  return fmt::format("Between {} s and {} s of run {}, {}, {}. ", three(l.segment.from), three(l.segment.to), d.run_ids[l.run],
                     phase_in_words(l.segment), force.empty() ? "simulation and recording part" : force);
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

/// "Rolling friction explains it: ρ = 0.10 ± 0.01."
std::string explanation(const Diagnosis& d, const std::string& adverb) {
  const FittedHypothesis& best = d.models[d.best];
  const std::vector<std::string> names = best.hypothesis.names();
  if (names.size() == 1) {
    const std::string values = values_of(best, names.front());
    return capitalised(effects_in_words(names)) + " explains it" + adverb + (values.empty() ? "" : ": " + values);
  }
  std::vector<std::string> parts;
  for (const std::string& name : names) {
    const std::string values = values_of(best, name);
    parts.push_back(effects_in_words({name}) + (values.empty() ? "" : " (" + values + ")"));
  }
  return capitalised(joined(parts, "and")) + " explain it" + adverb + (names.size() > 1 ? " together" : "");
}

std::string rivals(const Diagnosis& d) {
  const std::vector<std::string> own = d.models[d.best].hypothesis.names();
  std::vector<std::string> others;
  for (const auto& group : d.verdict.indistinguishable)
    for (const std::string& name : group)
      if (std::find(own.begin(), own.end(), name) == own.end()) others.push_back(effects_in_words({name}));
  return joined(others, "or");
}

/// Of two effects the one that has rivals.
std::string in_doubt(const Diagnosis& d) {
  return d.models[d.best].hypothesis.terms.size() > 1 && !d.verdict.indistinguishable.empty() ? effects_in_words({d.verdict.indistinguishable.front().front()}) : "it";
}

/// "On 12 recordings that were not used, the error falls from 9.1 σ to 1.02 σ."
std::string worth(const Diagnosis& d) {
  const Score& before = d.models.front().held_out;
  const Score& after = d.models[d.best].held_out;
  const double a = error_in_sigma(before), b = error_in_sigma(after);
  const std::size_t n = before.runs.size();
  std::string text = has_held_out(d) ? fmt::format("On {} that {} not used, the error ", counted(n, "recording"), n == 1 ? "was" : "were")
                                     : std::string("No recording was held out; on those that were fitted, which proves little, the error ");
  text += b < a ? fmt::format("falls from {} σ to {} σ", three(a), three(b)) : fmt::format("does not fall ({} σ before, {} σ after)", three(a), three(b));
  if (has_held_out(d) && b < a && n < 2)
    text += "; one recording is no proof";
  else if (has_held_out(d) && b < a && d.paired_p > 0.05)
    text += fmt::format("; the gain differs so much between them that it is not yet proven (p = {:.2g})", d.paired_p);
  text += ".";
  if (d.remaining_p <= level && b > clearly_more_than_noise) text += " What is left is still more than noise: something else is missing too.";
  return text;
}

std::string next_recording(const Diagnosis& d) {
  if (d.suggested.empty()) return "";
  const SuggestedRecording& s = d.suggested.front();
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

std::string when_nothing_explains(const Diagnosis& d) {
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
    return place_sentence(d, true) + explanation(d, " best") + "; but these recordings cannot tell " + in_doubt(d) + " from " + rivals(d) + ". " + worth(d) +
           next_recording(d);
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
  const std::string names = effects_in_words(d.models[d.best].hypothesis.names());
  if (verdict == "none") return d.tested ? "Nothing is missing" : "Nothing could be tested";
  if (verdict == "unknown" || d.best == 0) return "Something is missing that is not in the library";
  if (verdict == "ambiguous") return "Missing: " + names + ", or " + rivals(d);
  if (verdict == "measurement") return "A measurement error: " + names;
  if (verdict == "numerics") return "Numerics, not physics: " + names;
  return "Missing: " + names;
}

std::string diagnosis_in_words(const Diagnosis& d) {
  std::string text = (d.interrupted ? "Interrupted; this is what was found until then. " : "") + by_verdict(d);
  for (const auto& [name, share] : d.overstated)
    text += fmt::format(" But {} differs by {} of the noise that the bundle states: what is smaller than that noise cannot be seen, and if it is not in SI units, nothing was tested.",
                        name, three(share));
  return text;
}

}  // namespace repose
