#pragma once
/// What a diagnosis found, in plain words.
#include <string>

#include "analysis/diagnosis/diagnose.hpp"

namespace repose {

/// Where the mismatch is, what explains it, and what that is worth on recordings that were not used. Says what is not known:
/// rivals that cannot be told apart, nothing held out, gains that so few runs do not prove, a rest that is more than noise.
std::string diagnosis_in_words(const diagnosis::Diagnosis& d);

/// The verdict as a heading: "Missing: rolling friction", "Nothing is missing", "A measurement error: length scale".
std::string verdict_in_words(const diagnosis::Diagnosis& d);

/// Why another noise than the recordings' own is used: "To the 0.0004 m that the bundle states come 0.0003 m that a simulation's step may err by ...".
/// Empty if none is.
std::string raised_noise_in_words(const diagnosis::Diagnosis& d, const std::string& observable);

/// "while the ball rolls".
std::string phase_in_words(const diagnosis::Segment& segment);

/// What the unknown force does to the body: "it slows by 0.69 m/s² that the model does not have". Empty if the force is within two
/// standard errors of nothing, or acts on a body at rest too weakly to be seen.
std::string force_in_words(const diagnosis::Located& located);

}  // namespace repose
