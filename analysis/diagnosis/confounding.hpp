#pragma once
/// The recording that would tell two fitted models apart.
#include <optional>
#include <string>

#include "analysis/diagnosis/changed_recording.hpp"

namespace repose::diagnosis {

struct SuggestedRecording {
  std::string what;            ///< in words
  std::string first, second;   ///< labels of the models that it parts
  double power = 0;            ///< chance that a test at 1 % tells them apart, with this many runs and this noise
};

/// Below this chance a recording is not worth making for the sake of it.
inline constexpr double worth_recording = 0.5;

/// Of all changes (changed_recording.hpp) the one with the largest chance to tell the models apart. Its chance may be small: then none of them does.
SuggestedRecording recording_that_parts(const Problem& problem, const Fit& first, const Fit& second);

/// The chance that every run of `first`, recorded once more with this change, gives: P(N(0, 1) > 2.58 - sqrt(lambda)). lambda is what is left if one
/// of them is the truth and the other may move its constants, but only as far as the recordings that there are let it, and all start values that are free,
///   lambda = min over shared d and start values e of   sum over runs |r_truth - r_rival(d, e)|^2 + d^T I d,
/// with I the information (J^T J) of the recordings that there are; by Gauss and Newton. The smaller of both ways round; where one model holds the other's
/// effects it is the truth, for it could imitate all that the other does. None if no run has anything to change or none can be simulated so.
std::optional<double> chance_to_part(const Problem& problem, const Fit& first, const Fit& second, const Change& change);

}  // namespace repose::diagnosis
