#pragma once
/// diagnosis.json and the headline of a bulk diagnosis: the keys of a diagnosis of few bodies.
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/diagnosis/bulk_diagnose.hpp"

namespace repose {

/// An entry of `where` speaks of all fitted runs of the first setting that has some; `run` is the one that differs most there. `body` is the grains, by the names
/// of their populations; `region` of a profile {radius_from, radius_to} [m]; `t_start` and `t_end` are null where no time was recorded: a heap at rest. `nominal` has
/// `null` "packings": its p is of a known distribution, about `replicas` packings that were simulated, and no share of them. Beyond the common keys: `summaries`
/// (recorded, nominal and extended in that setting, and the scatter between seeds of each), `scatter_dof`, `tested` (names).
nlohmann::json bulk_diagnosis_json(const diagnosis::BulkDiagnosis& d, const Bundle& bundle);

std::string bulk_diagnosis_in_words(const diagnosis::BulkDiagnosis& d);

}  // namespace repose
