#pragma once
/// What may be wrong with a recording of many grains: ruler, clock and zeros. It asks for no simulation: the error is made on what was simulated.
///
///   length_scale   profiles and surfaces, along and across: factor * true
///   time_scale     times of series: factor * true       both where something flows: of other series mean and scatter are used, which know no clock
///   time_offset    times of series: true + offset, up to half the record's length
///   sensor_bias    one candidate for each other observable: a scalar, the values of a series, the heights of a profile or a surface: true + bias
#include <vector>

#include "analysis/diagnosis/bulk_candidate.hpp"

namespace repose::diagnosis {

/// The errors that such recordings can have.
std::vector<BulkCandidate> recording_errors(const Bundle& bundle, const NaturalScale& scale);

/// What the recording would hold if the errors among the candidate's parameters were made. Others change nothing.
std::vector<Observation> disturbed(const BulkCandidate& candidate, const Eigen::VectorXd& point, std::vector<Observation> observations);

}  // namespace repose::diagnosis
