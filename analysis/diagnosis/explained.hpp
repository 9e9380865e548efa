#pragma once
/// How much of a mismatch a model explains.
#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// Of the nominal's chi^2 beyond what noise alone gives, the share that the model removes. Where some runs plainly leave more than
/// noise, the mean over these: one that is beyond all models (a body that the tracker lost) must not speak for the others.
/// Both fits are of the same runs. At most 1; below 0 where the model leaves more. `noise`: what noise alone gives, per degree of freedom.
double share_explained(const Fit& nominal, const Fit& model, double noise = 1);

/// What noise alone gives per degree of freedom, where it was taken for larger than it is: half the mean square of the differences between neighbouring residuals
/// of a fit that leaves less than noise, for what is systematic hardly differs from one to the next; at most what it leaves. 1 of any other fit.
double noise_left(const Problem& problem, const Fit& fit);

/// Runs of the fit that plainly leave more than noise.
std::vector<std::size_t> runs_beyond_noise(const Fit& fit);

/// The nominal's rms error beyond noise: what share of it the model leaves, so a half where a quarter of chi^2 is left. Of all runs
/// together, or the median of those that share_explained() looks at, whichever is less: neither one run that is beyond all models nor many that were
/// hardly off must speak for the others.
double error_left(const Fit& nominal, const Fit& model);

/// As share_explained(), but of what the residuals do rather than of where they are: their second derivatives (speeds: the first, accelerometers: themselves), constant
/// on at most ten equal pieces of each channel. Those that stand out from their own error by three standard errors are summed as squares over time; the shares of the
/// channels are weighted by the nominal's chi^2 in them. Displacements forget when a force acted: a constant one takes four fifths of chi^2 from a push that
/// lasts a tenth of the record, and a tenth of its acceleration. At most 1, at least -1; 1 where nothing stands out.
double share_of_accelerations(const Problem& problem, const Fit& nominal, const Fit& model);

/// By how much chi^2 falls on the straight way from one fit's residuals to another's, at best: what the other is right about, were it weaker or stronger.
/// 0 where it leads away.
double gain_towards(const Fit& nominal, const Fit& other);

}  // namespace repose::diagnosis
