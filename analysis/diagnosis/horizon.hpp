#pragma once
/// How far each run is followed. Its start values are first those of its first samples, whose noise soon acts no longer linearly (an
/// impact comes earlier or later, or not at all); fitted to what can be followed they are known better, and carry further.
#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// Fits the start values of every run with the nominal scene and follows it further with their remaining uncertainty,
///   C = (J^T J + diag(step^-2))^-1,   scaled by chi^2 per degree of freedom where that is above 1,
/// at most three times, while that gains.
void follow_further(Problem& problem, const FitOptions& options);

}  // namespace repose::diagnosis
