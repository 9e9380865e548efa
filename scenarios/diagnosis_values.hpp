#pragma once
/// Names and numbers of a diagnosis as people write them.
#include <string>
#include <vector>

#include "analysis/diagnosis/diagnose.hpp"

namespace repose {

/// "rolling friction" of "rolling_friction".
std::string with_spaces(std::string name);

/// "rolling friction"; of several "rolling friction and time offset"; of none "nothing missing"; of {"unknown"} "something outside the
/// library".
std::string effects_in_words(const std::vector<std::string>& effects);

/// The effects that the scene lacks, then those whose constants it states and has wrong.
std::vector<std::string> names_in_order(const diagnosis::Hypothesis& hypothesis);

/// The same of a candidate.
std::vector<std::string> effects_in_order(const diagnosis::Diagnosis& d, const diagnosis::Ranked& ranked);

/// The effects of the model that has this label.
std::vector<std::string> names_of(const diagnosis::Diagnosis& d, const std::string& label);

/// What `first` has and `second` has not.
std::vector<std::string> only_in(std::vector<std::string> first, const std::vector<std::string>& second);

/// "µ", "ρ", "e" for the constants of `pairs`; else the last name of the key, with spaces; a component of a vector has its axis behind it.
std::string symbol_of(const std::string& key);

/// "m/s²" for m/s^2, "°" for deg, "" for 1.
std::string written_unit(const std::string& unit);

/// "0.1000 ± 0.0100 Pa s". The uncertainty is half the 90 % interval.
std::string value_in_words(const diagnosis::ParameterEstimate& p);

/// The typical residual in units of the noise, sqrt(chi^2 per degree of freedom).
double error_in_sigma(const diagnosis::Score& score);

/// The parameters of an effect in a model.
std::vector<diagnosis::ParameterEstimate> parameters_of(const diagnosis::FittedHypothesis& model, const std::string& effect);

/// Probability that the effect is missing, alone or with another.
double probability_of(const diagnosis::Verdict& verdict, const std::string& effect);
double probability_of(const diagnosis::Diagnosis& d, const std::string& effect);

/// " m" for "position": with a space in front; empty where there is none.
std::string unit_of(const std::string& observable);

/// What the simulation's own step may err by, which was added in squares to the noise of the recordings; 0 where that raised it by less than a hundredth.
double raised_noise(const diagnosis::Diagnosis& d, const std::string& observable);

/// Whether runs were held out; if not, `held_out` scores are those of the fitted runs.
bool has_held_out(const diagnosis::Diagnosis& d);

}  // namespace repose
