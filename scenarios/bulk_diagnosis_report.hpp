#pragma once
/// report.html of a bulk diagnosis.
#include <string>
#include <utility>
#include <vector>

#include "analysis/diagnosis/bulk_diagnose.hpp"
#include "analysis/report/report.hpp"

namespace repose {

/// Of a diagnosis that simulated its nominal scene at least. `settings`: what the user chose (options, backend, seed) and the version, as shown.
report::Report bulk_diagnosis_report(const diagnosis::BulkDiagnosis& d, const Bundle& bundle, const std::vector<std::pair<std::string, std::string>>& settings);

}  // namespace repose
