#pragma once
/// The page that `repose compare` writes.
#include <nlohmann/json.hpp>

#include "analysis/report/report.hpp"

namespace repose {

/// `compare`: what summarise_compare made, with `title` and the resolved `scene_text` added.
report::Report compare_report(const nlohmann::json& compare);

}  // namespace repose
