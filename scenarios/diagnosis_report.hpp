#pragma once
/// report.html of a diagnosis: what is missing, where, how sure, and what to record next.
#include "analysis/bundle/bundle.hpp"
#include "analysis/diagnosis/diagnose.hpp"
#include "analysis/report/report.hpp"

namespace repose {

report::Report diagnosis_report(const diagnosis::Diagnosis& d, const Bundle& bundle);

}  // namespace repose
