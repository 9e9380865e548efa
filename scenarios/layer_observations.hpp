#pragma once
/// What instruments would see of a layer: what a bundle records, and what a simulation shows beside it.
#include <string>

#include "analysis/bundle/bundle.hpp"
#include "analysis/history.hpp"
#include "scenarios/layer_run.hpp"

namespace repose {

/// "N", or "N m" for the torque.
std::string unit_of_load(const std::string& series);

/// Heights above the plate [m] over the region, at the middles of the cells: every one, or every n-th along both axes so that there are no
/// more than `most` places. Where no grain stands the plate shows: 0. `name`: layer_before or layer_after.
Observation surface_of(const SpreadLayer& layer, const std::string& name, std::size_t most);

/// The loads on the spreader, series as told_of_a_layer() names them [N], [N m] (torque about y at its centre): at the end of every step, times from
/// the start of the spreading.
History loads_on_spreader(const SpreadLayer& layer);

}  // namespace repose
