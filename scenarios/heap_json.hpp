#pragma once
/// A measured heap as the keys of result.json (SI units; angles in degrees).
#include <nlohmann/json.hpp>

#include "analysis/heap_measurement.hpp"

namespace repose {

/// `angle_of_repose` {value, sd, se, unit, ...}: null with a `message` if the heap has none; `solid_fraction`,
/// `solid_fraction_detail`, `discharge_rate`, `discharge`, `heap`, `rest`, `profile`.
nlohmann::json heap_json(const HeapMeasurement& heap);

}  // namespace repose
