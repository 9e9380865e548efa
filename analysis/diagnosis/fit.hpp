#pragma once
/// Least squares over runs: shared parameters, and those of each run.
#include <functional>
#include <limits>
#include <vector>

#include "analysis/diagnosis/problem.hpp"

namespace repose::diagnosis {

struct Fit {
  Layout layout;
  Values shared;
  std::vector<Values> own;                 ///< of every run of the problem; fitted for `runs` only
  std::vector<std::size_t> runs;           ///< that were fitted
  std::vector<Eigen::VectorXd> residual;   ///< of `runs`, whitened
  double chi2 = 0;                         ///< sum of squares; infinite where a simulation fails
  Eigen::Index samples = 0;
  int parameters = 0;
  double worth() const { return chi2 + 2 * parameters; }  ///< less is better: Akaike's criterion
  double excess() const { return chi2 - static_cast<double>(samples - parameters); }  ///< of chi^2 beyond what noise alone gives
  double per_dof() const { return chi2 / std::max<double>(1, static_cast<double>(samples - parameters)); }
};

struct FitOptions {
  int iterations = 12;
  int threads = 1;
  int pinned = -1;  ///< a shared parameter that stays where it begins
  double until = std::numeric_limits<double>::infinity();  ///< [s]: later samples do not count, and the result may be worse over all of them
  std::function<bool()> interrupted;
};

/// The start values of a layout.
Fit start_of(const Problem& problem, const Layout& layout, const std::vector<std::size_t>& runs);

/// The start of a layout with the values of another fit for all parameters that both have.
Fit begun_within(const Problem& problem, const Layout& layout, const Fit& larger);

/// The fit with residuals and chi^2 of the values that it has.
Fit evaluated(const Problem& problem, Fit fit);

/// Minimises chi^2 = sum of squared whitened residuals from `start` (Levenberg-Marquardt of Ceres within the bounds, derivatives by
/// differences; logarithmic parameters in ln). Never ends worse than it began; a start where a simulation fails is handed back.
Fit minimise(const Problem& problem, const Fit& start, const FitOptions& options);

/// Frozen shared parameters: only the values of each run of `runs` are fitted.
Fit minimise_own(const Problem& problem, const Fit& trained, const std::vector<std::size_t>& runs, const FitOptions& options);

/// Chi^2 of the samples until a time [s].
double chi2_until(const Problem& problem, const Fit& fit, double until);

/// The best of the fit and of `points` (values of its last shared parameters), fitted to a growing part of all records: where a small difference grows, as that
/// of a spin does after an impact, the whole record leads a fit astray, and its beginning does not. At each length the points are looked at again, for a coefficient may do
/// nothing beyond some value (a contact that sticks). May be worse than `start`.
Fit followed(const Problem& problem, const Fit& start, const std::vector<std::vector<double>>& points, const FitOptions& options);

/// Those of `runs` that are off by more than 5 sigma may be stuck, behind an impact that their first start values miss: they are begun anew from the start
/// values as read off the data and as the scene has them, fitted to a growing part of the record. So is every run in which
/// bodies hit (RunData::hits) that another backend solves: there the path jumps with the step in which it sees that. Shared parameters stay. Never worse than `fit`.
Fit begun_anew(const Problem& problem, const Fit& fit, const std::vector<std::size_t>& runs, const FitOptions& options);

/// Where paths jump (as above), a fit ends in the basin that it began in: the runs are fitted from either side of it, each start value moved by an
/// eighth of its step and up to the whole. Other runs and shared parameters stay. Never worse than `fit`.
Fit shaken(const Problem& problem, const Fit& fit, const std::vector<std::size_t>& runs, const FitOptions& options);

/// Derivatives of the residuals of one run at the fit; 0 where a simulation on either side fails or a bound is in the way.
struct RunJacobian {
  Eigen::MatrixXd shared, own;
};
RunJacobian jacobian(const Problem& problem, const Fit& fit, std::size_t run);

/// What the shared parameters do to a run beyond what its own values imitate.
Eigen::MatrixXd shared_alone(const RunJacobian& jacobian);

/// How many of the shared parameters, from the `first` on, the recordings show beyond what start values imitate: an axis that nobody watched, or
/// along which every run has its own start, says nothing and costs nothing.
int seen_parameters(const Problem& problem, const Fit& fit, std::size_t first);

/// J^T J of the shared parameters at the fit, without what the values of each run can imitate.
Eigen::MatrixXd information_of(const Problem& problem, const Fit& fit);

/// Standard errors of the shared parameters from the curvature at the fit, times `scale`.
Eigen::VectorXd standard_errors(const Problem& problem, const Fit& fit, double scale);

/// Residuals of a run at the fit.
Eigen::VectorXd residual_of(const Problem& problem, const Fit& fit, std::size_t run);

/// How far the readings of a fit's runs part from those at the scene's own step (Problem::numerics): the largest rms of a run [sigma]; 0 where that is the
/// fit's step or a coarser one is not used.
double moved_by_coarser_step(const Problem& problem, const Fit& fit);

}  // namespace repose::diagnosis
