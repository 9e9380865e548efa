#pragma once
/// What instruments would see of a layer: what a bundle records, and what a simulation shows beside it.
#include <string>

#include "analysis/bundle/bundle.hpp"
#include "analysis/history.hpp"
#include "scenarios/layer_run.hpp"

namespace repose {

/// Surfaces `layer_before`, `layer_after`, and series `roller_force_x`, `roller_force_z`, `roller_torque` (of a blade likewise).
bool shown_by_a_layer(const Observation& observation);

/// "N", or "N m" for the torque.
std::string unit_of_load(const std::string& series);

/// Heights above the plate [m] over the region, at the middles of the cells: every one, or every n-th along both axes so that there are no
/// more than `most` places. NaN: a hole. `name`: layer_before or layer_after.
Observation surface_of(const SpreadLayer& layer, const std::string& name, std::size_t most);

/// The loads on the spreader [N], [N m] (torque about y at its centre) at every step of the spreading, from its start.
History loads_on_spreader(const SpreadLayer& layer);

}  // namespace repose
