#pragma once
/// One law of anisotropic friction under two names.
#include <optional>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// Friction mu along a direction and r mu across it is friction r mu along the direction across, and 1/r of that across: where mu is calibrated, recordings
/// cannot tell the one from the other. The fit in its other form; nullopt if it has none (no such effect, mu stated, or beyond a bound).
std::optional<Fit> turned_by_a_quarter(const Problem& problem, const Fit& fit);

/// Of the two forms the one whose mu is nearer, as a ratio, to where the scene begins.
Fit nearer_to_the_scene(const Problem& problem, const Fit& fit);

}  // namespace repose::diagnosis
