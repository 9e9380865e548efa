#pragma once
/// diagnosis.json, the machine's view of a diagnosis.
///
/// `missing` names effects only where the verdict does: it is empty for `none` and `unknown`. Its probabilities are those of the effect,
/// alone or with another; those of `ranked` sum to 1. A parameter that each run has for itself (a clock's offset) is given as its mean
/// over the fitted runs. `separates` names what the two explanations do not share; `none`: nothing more.
/// Beside the keys of the contract: `headline`, `noise`, `explained`, `remaining_p`, `notes`, `simulations`, and under `fit` the start
/// values of each run (`own`), with which extended.yaml gives the stated score. `noise` gives for each observable `sd` (used), `stated` (by the bundle),
/// `of_recordings` (before what a simulation's step may err by) and, where they differ, `why`. Effects of a candidate: first those that the scene lacks,
/// then those whose constants it states. A suggested recording of small `power` is the best that was tried: none would do.
/// `tested`: false where no effect would have shown, so that `none` says nothing. `held_out_p`: of the nominal's lack of fit in held-out runs, where that alone
/// makes the verdict `none`, else null. `only_held_out`: held-out runs that the nominal plainly misses though it explains those that were fitted. `by_fitted_runs`: no held-out
/// run shows the mismatch. With nothing held out `ranked` has no held-out likelihoods, `paired_p` is 1 and `effect_size` 0.
#include <nlohmann/json.hpp>

#include "analysis/diagnosis/diagnose.hpp"

namespace repose {

nlohmann::json diagnosis_json(const diagnosis::Diagnosis& d);

}  // namespace repose
