#pragma once
/// The report of a diagnosis: what a person must know in a minute, then all of it.
#include <string>
#include <utility>
#include <vector>

#include "analysis/bundle/bundle.hpp"
#include "analysis/diagnosis/diagnose.hpp"
#include "analysis/report/report.hpp"

namespace repose {

/// `settings`: what the user chose (options, backend, seed) and the version, as shown.
report::Report diagnosis_report(const diagnosis::Diagnosis& d, const Bundle& bundle,
                                const std::vector<std::pair<std::string, std::string>>& settings);

}  // namespace repose
