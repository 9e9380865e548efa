#pragma once
/// Do the backends agree about an observable, and if not, is it a matter of step or tolerance?
#include <nlohmann/json.hpp>

#include "scenarios/compare_results.hpp"

namespace repose {

/// How certain: the chance of one false "differ" among all observables of one kind and all pairs of backends.
inline constexpr double compare_alpha = 0.05;

/// One entry per observable that any run has: {name, unit, kind, values {label: {mean, sd, se, n}}, verdict, standard_errors,
/// text, pairs [...], refinement {label: {half_step: {shift, se, p}, tenth_tolerance: {...}}}}.
///
/// The same seed makes the same grains on every backend, so the statistic is paired: the mean over seeds of the
/// difference over its standard error (Student, n - 1 degrees of freedom); Welch's, for independent samples, is given beside it. p
/// values are corrected by Holm over all observables of a kind and all pairs. `differ`: corrected p < 0.05 and the difference is
/// larger than the solver's relative tolerance times the observable's scale. `standard_errors`: of the pair that differs most.
/// Where nothing is random, or one pair alone has the value, there is no scatter: `differ` means beyond that tolerance, and
/// `standard_errors` is null.
///
/// To agree is not to be equal: per pair `half_width_95`, half of the 95 % interval of the difference (one observable, not corrected), says
/// how large a difference these seeds leave room for. Also `explained_by`: refinements whose shift of one backend is significant (p < 0.05) and as large as the difference.
/// `refined`: the difference once both are refined.
nlohmann::json compare_verdicts(const Comparison& comparison, const CompareResults& results);

/// "h/2", "tolerance/10".
const char* refinement_label(Refinement refinement);
/// "half_step", "tenth_tolerance": keys of compare.json.
const char* refinement_key(Refinement refinement);

}  // namespace repose
