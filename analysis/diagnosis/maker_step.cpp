#include "analysis/diagnosis/maker_step.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/explained.hpp"

namespace repose::diagnosis {
namespace {

constexpr double alike = 0.5;  // of what is removed

/// The nominal as the scene says to solve it, at this share of its step; start values fitted.
Fit of_first_order(const Problem& problem, const Fit& nominal, double share, const FitOptions& options) {
  Fit fit = nominal;
  fit.layout.numerics = {};
  fit.layout.numerics.step_factor = share;
  return minimise_own(problem, evaluated(problem, std::move(fit)), nominal.runs, options);
}

}  // namespace

StepMismatch step_mismatch(const Problem& problem, const Fit& nominal, const Fit& leading, const std::vector<const Fit*>& numerics, const FitOptions& options) {
  StepMismatch mismatch;
  for (const auto& [observable, error] : problem.scene_error()) mismatch.allowed = std::max(mismatch.allowed, step_of_makers * error);
  const double removed = std::max(0.0, nominal.chi2 - leading.chi2);
  mismatch.size = std::sqrt(std::max({removed, nominal.excess(), 0.0}) / static_cast<double>(nominal.samples));
  if (!(mismatch.size <= mismatch.allowed)) return mismatch;
  const auto imitates = [&](const Fit& fit) { return gain_towards(nominal, fit) >= alike * removed; };
  mismatch.may_be_one = std::any_of(numerics.begin(), numerics.end(), [&](const Fit* fit) { return imitates(*fit); });
  for (const double share : {step_of_makers, 1.0})
    mismatch.may_be_one = mismatch.may_be_one || imitates(of_first_order(problem, nominal, share, options));
  return mismatch;
}

}  // namespace repose::diagnosis
