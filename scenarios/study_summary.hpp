#pragma once
/// From the results of the jobs to study.json: means and scatter per point, slopes per series, and the published values.
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/reference.hpp"
#include "scenarios/jobs.hpp"
#include "scenarios/study_plan.hpp"

namespace repose {

/// `points` [{set, series, label, scene, x, runs, failed, not_at_rest, observables {name: {mean, sd_seed, se, n}}}]: the angle also has
/// `sd_azimuth`, the mean over seeds of the scatter over azimuths and flanks within a heap; `se` = sd_seed / sqrt(n), both null if n = 1.
/// `series` [{name, label, slope {value, se, interval95, n}, reference {...}}]: the slope is that of the angle against the
/// first varied key, least squares over all single runs; its error comes from their scatter.
///   reference: the published curve, its slope and error (from the scatter of its values), `slope_difference` in standard
///   errors of both together, and per common x the `difference` (simulated - published) with its error.
/// `jobs` are the plan's in order: all seeds of the first point, then those of the second...
nlohmann::json summarise_study(const StudyPlan& plan, const std::vector<Job>& jobs, const JobsReport& report,
                               const std::map<std::string, ReferenceSet>& references);

/// A value of an override as JSON: a number where it is one.
nlohmann::json override_json(const std::string& value);

}  // namespace repose
