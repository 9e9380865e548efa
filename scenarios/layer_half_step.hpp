#pragma once
/// Are the figures of a layer converged in its step? The same spreading over the same bed once more, with half of it.
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/report/report.hpp"
#include "scenarios/layer_measurement.hpp"
#include "scenarios/spreading.hpp"

namespace repose {

/// One figure with both steps, and the standard errors of each run (none: not known).
struct StepFigure {
  std::string name, key, unit;
  double to_unit = 1;  ///< SI to `unit`
  double value = 0, half = 0;
  std::optional<double> se, half_se;
  /// Of value - half, as of two independent beds: the bed is the same, which makes it too large, but grains part within a few diameters of travel. Nullopt
  /// where one is not known or not above 0.
  std::optional<double> error() const;
};

struct HalfStep {
  double time_step = 0;  ///< [s], the half
  double wall_s = 0, converged_fraction = 1;
  std::vector<StepFigure> figures;  ///< Sa, thickness, packing after; force along the travel and upward, torque, where steps tell them
};

/// Standard errors: what is farther apart is not converged in the step; what is not may still differ by less.
inline constexpr double apart_at_most = 2;

/// Nullopt if it was interrupted. Needs the memory of a second world.
std::optional<HalfStep> spread_with_half_step(const Spreading& spreading, const LayerMeasurement& whole, bool quiet);

nlohmann::json half_step_json(const HalfStep& half);
report::Table half_step_table(const HalfStep& half);
/// What is not converged, or that nothing is seen to differ and how large a difference would have been.
std::string half_step_in_words(const HalfStep& half);

}  // namespace repose
