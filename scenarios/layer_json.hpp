#pragma once
/// What `repose layer` adds to result.json.
#include <nlohmann/json.hpp>

#include "scenarios/bed.hpp"
#include "scenarios/layer_measurement.hpp"
#include "scenarios/spreader.hpp"

namespace repose {

nlohmann::json layer_json(const LayerMeasurement& layer, const LayerSetup& setup, const SpreaderPath& path, const Bed& bed);

}  // namespace repose
