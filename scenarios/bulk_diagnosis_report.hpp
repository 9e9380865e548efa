#pragma once
/// report.html of a bulk diagnosis.
#include "analysis/diagnosis/bulk_diagnose.hpp"
#include "analysis/report/report.hpp"

namespace repose {

/// Of a diagnosis that simulated its nominal scene at least.
report::Report bulk_diagnosis_report(const diagnosis::BulkDiagnosis& d, const Bundle& bundle);

}  // namespace repose
