#pragma once
/// Recordings may themselves be simulated, by a maker who took a finer step than the scene's but no exact one.
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

struct StepMismatch {
  double size = 0;     ///< of what stands out, rms [sigma]: what the leading fit removes of chi^2, or what the nominal has too much of it
  double allowed = 0;  ///< what a quarter of the scene's step may differ by (Problem::scene_error)
  /// Is it no larger than that, and does at least half of it lie in the direction that the scene of first order takes, at a quarter of its step or as it
  /// stands, or in that of one of `numerics`? Then it has no name, however significant.
  bool may_be_one = false;
};

/// `nominal`, `leading`: of the same runs. `numerics`: fits whose hypotheses are numerics alone.
StepMismatch step_mismatch(const Problem& problem, const Fit& nominal, const Fit& leading, const std::vector<const Fit*>& numerics, const FitOptions& options);

}  // namespace repose::diagnosis
