#pragma once
/// The page that `repose study` writes: angle against the varied key beside the published and the measured values.
#include <map>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/reference.hpp"
#include "analysis/report/report.hpp"
#include "scenarios/study_plan.hpp"

namespace repose {

/// `study`: what summarise_study made. `measured`: the angle of the experiment, drawn as a band.
report::Report study_report(const StudyPlan& plan, const nlohmann::json& study, const std::map<std::string, ReferenceSet>& references,
                            const std::optional<ReferenceValue>& measured, const std::optional<ReferenceValue>& solid_fraction);

}  // namespace repose
