#pragma once
/// The recording of many grains that would tell two fitted models apart.
#include "analysis/diagnosis/bulk_model.hpp"
#include "analysis/diagnosis/confounding.hpp"

namespace repose::diagnosis {

/// Compares what both fitted models gave, in everything that a simulation shows, recorded or not: the observables at hand in more runs
/// (2, 4 and 8 times as many), or one further observable, or all of them. Takes the cheapest that parts them with a chance of 95 %, else the one
/// with the largest. The distance of two means of few seeds is too large by chance alone, by d (1/n_1 + 1/n_2) with n seeds and d summaries: that
/// is taken off. No words if one of the models was not simulated.
SuggestedRecording bulk_recording_that_parts(const BulkModel& first, const BulkModel& second, const BulkModel& nominal, const BulkData& data,
                                             const std::vector<Observation>& recorded);

}  // namespace repose::diagnosis
