#pragma once
/// How well the data determine the parameters of a fit.
#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

struct Interval {
  double lower = 0, upper = 0;
};

/// 90 % interval of the profile likelihood of shared parameter `index`: where the smallest chi^2 over all other parameters is
/// 2.706 scale^2 above the fit's. `se`: a first guess of the standard error. Ends at a bound of the parameter where the profile does not rise
/// that far.
Interval profile_interval(const Problem& problem, const Fit& fit, std::size_t index, double se, double scale, const FitOptions& options);

/// 90 % intervals of all shared parameters from `replicas` resamplings of the runs with replacement, each with one Gauss-Newton step
/// from the fit:  delta = -(sum J^T J)^-1 sum J^T r over the drawn runs, start values projected out. Empty with fewer than six runs.
std::vector<Interval> run_bootstrap(const Problem& problem, const Fit& fit, int replicas, std::uint64_t seed);

struct ParameterEstimate {
  std::string name, unit, effect;
  double value = 0, lower = 0, upper = 0;   ///< 90 %
  std::optional<Interval> over_runs;        ///< 90 %: of the bootstrap over runs
};

/// Of all shared parameters, then of those that an effect gives to runs for themselves (a clock's offset, a sensor's bias). Sensors are told
/// apart by name, body and axis, and a run may lack some that others have; the second is called "sensor_bias.bias (2)". Intervals of
/// shared ones are those of the profile likelihood if `profiled`, else of the curvature at the fit; of the others the mean over the runs that
/// have it has Student's, and the value of a single run the curvature's. `scale`: of the residuals, in units of the noise.
/// After an interruption: the shared ones, with all that their bounds leave open.
std::vector<ParameterEstimate> estimates(const Problem& problem, const Fit& fit, double scale, bool profiled, std::uint64_t seed,
                                         const FitOptions& options);

}  // namespace repose::diagnosis
