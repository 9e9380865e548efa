#pragma once
/// The page that `repose study` writes: observables against the varied keys beside the published and the measured values.
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/reference.hpp"
#include "analysis/report/report.hpp"
#include "scenarios/experiment.hpp"
#include "scenarios/study_plan.hpp"

namespace repose {

/// `study`: what summarise_study made of the runs of `experiment`, whose measured values are drawn as bands.
report::Report study_report(const StudyPlan& plan, const nlohmann::json& study, const std::map<std::string, ReferenceSet>& references,
                            const Experiment& experiment);

}  // namespace repose
