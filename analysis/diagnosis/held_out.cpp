#include "analysis/diagnosis/held_out.hpp"

#include <algorithm>
#include <limits>

namespace repose::diagnosis {
namespace {

constexpr double worth_a_trial = 10;  // of chi^2 that another hypothesis fits a run better
constexpr double near_noise = 2;  // chi^2 per degree of freedom on the runs that were fitted: what is worse there wins nothing here
constexpr double promising = 2;       // times the chi^2 to beat, as another's start values leave it

double chi2_of(const Fit& fit, std::size_t i) {
  return fit.residual[i].size() == 0 ? std::numeric_limits<double>::infinity() : fit.residual[i].squaredNorm();
}

/// The fit with start values of one run from elsewhere; parameters that the terms have in each run stay.
Fit begun_from(const Fit& fit, std::size_t run, const Values& own, std::size_t start_values) {
  Fit one = fit;
  one.runs = {run};
  one.own[run].head(static_cast<Eigen::Index>(start_values)) = own.head(static_cast<Eigen::Index>(start_values));
  return one;
}

}  // namespace

std::vector<Fit> held_out_fits(const Problem& problem, const std::vector<const Fit*>& hypotheses, const std::vector<std::size_t>& runs,
                               const FitOptions& options, const std::function<void(std::size_t done)>& told) {
  std::vector<Fit> fits;
  for (const Fit* trained : hypotheses) {
    fits.push_back(minimise_own(problem, *trained, runs, options));
    if (!trained->layout.numerics.backend.empty() && trained->per_dof() < near_noise) fits.back() = shaken(problem, begun_anew(problem, fits.back(), runs, options), runs, options);
    told(fits.size());
  }
  std::vector<bool> moved(fits.size(), false);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::size_t run = runs[i], start_values = problem.runs()[run].start.size();
    const auto best = static_cast<std::size_t>(
        std::min_element(fits.begin(), fits.end(), [&](const Fit& a, const Fit& b) { return chi2_of(a, i) < chi2_of(b, i); }) - fits.begin());
    fits[best] = begun_anew(problem, fits[best], {run}, options);
    const Values found = fits[best].own[run];
    for (std::size_t m = 0; m < fits.size() && start_values > 0; ++m) {
      if (options.interrupted && options.interrupted()) return fits;
      const double own = chi2_of(fits[m], i);
      if (m == best || !(own > chi2_of(fits[best], i) + worth_a_trial)) continue;
      Fit other = evaluated(problem, begun_from(fits[m], run, found, start_values));
      if (!(other.chi2 < promising * own)) continue;
      other = minimise_own(problem, other, {run}, options);
      if (!(other.chi2 < own)) continue;
      fits[m].own[run] = other.own[run];
      moved[m] = true;
    }
  }
  for (std::size_t m = 0; m < fits.size(); ++m)
    if (moved[m]) fits[m] = evaluated(problem, std::move(fits[m]));
  for (Fit& fit : fits) fit.parameters -= static_cast<int>(fit.layout.shared.size());  // these runs turned none of them
  return fits;
}

}  // namespace repose::diagnosis
