#pragma once
/// What the report draws: residuals of some runs, before and after.
#include <string>
#include <vector>

#include "analysis/diagnosis/locate.hpp"

namespace repose::diagnosis {

struct FittedHypothesis;

struct ResidualSample {
  std::string run, channel;
  std::vector<double> time, nominal, extended;  ///< [s] since the simulation's start; in sigma
};

/// Of at most six runs, half of them fitted where some are held out; those where the mismatch was located come first, for the report shades it. What cannot
/// be simulated is left out.
std::vector<ResidualSample> shown_residuals(const Problem& problem, const FittedHypothesis& nominal, const FittedHypothesis& best, const std::vector<Located>& where);

}  // namespace repose::diagnosis
