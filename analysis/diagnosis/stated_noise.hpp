#pragma once
/// Noise that the bundle states too small, or far too large.
#include <map>
#include <string>
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// Observables whose samples scatter from one to the next by more than 1.5 times the noise that the bundle states, and that scatter [SI], where
/// the nominal scene, fitted to these runs, leaves no more than 1.2 times as much. What has the size of the scatter and nothing beyond it is
/// noise, whatever was stated; taken at its word, the bundle would have something missing that no physics explains. Samples that are too far
/// apart to follow the motion scatter by it: then the scene leaves less or more, and what was stated holds.
std::map<std::string, double> understated_noise(const Problem& problem, const std::vector<std::size_t>& runs, const FitOptions& options);

/// Observables of stated noise that the fit misses by less than a tenth of it, rms, and that share: a noise in millimetres that is stated as if in metres hides
/// everything.
std::map<std::string, double> overstated_noise(const Problem& problem, const Fit& fit);

}  // namespace repose::diagnosis
