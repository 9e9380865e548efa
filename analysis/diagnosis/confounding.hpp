#pragma once
/// The recording that would tell two fitted models apart.
#include <string>
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

struct SuggestedRecording {
  std::string what;            ///< in words
  std::string first, second;   ///< labels of the models that it parts
  double power = 0;            ///< chance that a test at 1 % tells them apart, with this many runs and this noise
};

/// Simulates both fits with changed starts (speeds, spins and heights, free or given) and with changed settings (plain numbers that the
/// bundle sets for its runs: a size, a mass), halved, doubled and quadrupled, one kind at a time, on every run of `first`, and takes the change
/// with the largest separation
///   lambda = |(1 - P_J)(r_first - r_second)|^2,   power = P(N(0, 1) > 2.58 - sqrt(lambda)),
/// where P_J projects on what free start values could imitate. Without anything to change: the same runs again, more often.
SuggestedRecording recording_that_parts(const Problem& problem, const Fit& first, const Fit& second);

}  // namespace repose::diagnosis
