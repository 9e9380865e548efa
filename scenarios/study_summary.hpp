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

/// The observable of a study that matters most.
struct PrincipalObservable {
  std::string name;            ///< "angle_of_repose"
  std::string scatter_within;  ///< the observable that is its scatter within a run; may be empty
};

/// `points` [{set, series, label, scene, x, runs, failed, not_at_rest, observables {name: {mean, sd_seed, se, n}}}]: the principal one
/// also has the mean over seeds of its scatter within a run (of a heap's angle `sd_azimuth`, over azimuths and flanks);
/// `se` = sd_seed / sqrt(n), both null if n = 1.
/// `series` [{name, label, x, x_unit, slope {value, se, interval95, n}, reference {...}}]: the slope is that of the principal
/// observable against the first varied key, least squares over all single runs; its error comes from their scatter.
///   reference: the published curve, its slope and error (from the scatter of its values), `slope_difference` in standard
///   errors of both together, and per common x the `difference` (simulated - published) with its error.
/// `jobs` are the plan's in order: all seeds of the first point, then those of the second...
nlohmann::json summarise_study(const StudyPlan& plan, const std::vector<Job>& jobs, const JobsReport& report,
                               const std::map<std::string, ReferenceSet>& references, const PrincipalObservable& principal);

/// A value of an override as JSON: a number where it is one.
nlohmann::json override_json(const std::string& value);

}  // namespace repose
