#pragma once
/// What an experimenter does who follows a suggestion: the runs of a case once more, changed in one respect, beside those that there are.
#include <optional>
#include <string>

#include "analysis/diagnosis/changed_recording.hpp"
#include "tests/bench/concealment/concealed_case.hpp"

namespace repose::concealment {

/// The change that a diagnosis of the bundle suggests in these words (SuggestedRecording::what); none if they are nobody's.
std::optional<diagnosis::Change> change_in_words(const Bundle& bundle, const std::string& what);

/// The bundle of the case with every run twice, "run-1" and "run-1-again": changed as planned in the nominal scene, and as it really began in the
/// true one. What was held out is so again. The same seed gives the same noise. Throws Error where the world cannot be simulated so.
Bundle recorded_again(const ConcealedCase& made, const diagnosis::Change& change, std::uint64_t seed);

}  // namespace repose::concealment
