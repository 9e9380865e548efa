#pragma once
/// What a fit leaves on a set of runs, and whether a second one leaves less.
#include <map>
#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// What a model leaves on a set of runs.
struct Score {
  std::vector<std::size_t> runs;           ///< of the problem
  double chi2_per_dof = 0;
  double log_likelihood = 0;               ///< nats, sum over samples, for the sensors' own noise
  std::map<std::string, double> rmse;      ///< by observable, in its SI unit (orientation: rad)
  std::vector<double> per_run;             ///< log likelihood of each run
  std::vector<double> error_per_run;       ///< rms of each run's residuals, in units of the noise
};

/// `fit` has been fitted to (or, for held-out runs, its start values have been) fit.runs.
Score score_of(const Problem& problem, const Fit& fit);

/// What is to be added to the log likelihood of held-out runs because the physics frozen there is known only to within its standard errors on the runs
/// that were fitted (Laplace):
///   g' (A + B)^-1 g / 2 - ln(det(A + B) / det B) / 2
/// B, A: information on the shared parameters in the fitted and the held-out runs, start values taken out; g: slope of chi^2 / 2 in the latter. A
/// parameter that the fitted runs hardly determine is not held against its model for the value that they happened to give. B is divided by the
/// square of `scale`, of the fitted residuals in units of the noise. The first term counts as far as a simulation with the values that it stands for (start
/// values fitted anew) bears it out. 0 without shared parameters.
double worth_of_uncertainty(const Problem& problem, const Fit& fit, const Fit& held, double scale, const FitOptions& options);

/// The extended model against the nominal on the same runs.
struct PairedGain {
  double p = 1;            ///< one-sided, paired t test over runs of the log likelihoods; 1 with fewer than two runs
  double effect_size = 0;  ///< mean over standard deviation of the difference; 0 with fewer than two runs
};
PairedGain paired_gain(std::span<const double> nominal, std::span<const double> extended);

/// The same test by the logarithms of the errors of each run: log likelihoods differ by as much more as a run is longer or further off, so that
/// three runs, each of which falls from tens of sigma to one, would prove nothing. 1 with fewer than two runs.
double p_of_smaller_errors(std::span<const double> nominal, std::span<const double> extended);

}  // namespace repose::diagnosis
