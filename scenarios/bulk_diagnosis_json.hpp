#pragma once
/// diagnosis.json and the headline of a bulk diagnosis: the keys of a diagnosis of few bodies.
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/diagnosis/bulk_diagnose.hpp"

namespace repose {

/// `where` has `run` null: an entry speaks of all runs of the first setting. Beyond the common keys: `summaries` (recorded, nominal, extended and
/// the scatter between seeds of each), `scatter_dof`, `tested` (names).
nlohmann::json bulk_diagnosis_json(const diagnosis::BulkDiagnosis& d, const Bundle& bundle);

std::string bulk_diagnosis_in_words(const diagnosis::BulkDiagnosis& d);

}  // namespace repose
