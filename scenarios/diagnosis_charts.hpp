#pragma once
/// The charts of a diagnosis.
#include <vector>

#include "analysis/diagnosis/diagnose.hpp"
#include "analysis/report/report.hpp"

namespace repose {

/// Residuals against time before and after, with the located stretches shaded; the channel that fails most first, those of the run that
/// was located first before others.
std::vector<report::Chart> residual_charts(const diagnosis::Diagnosis& d);

/// The unknown force against the variable that explains it best, with the curve. `depends_on` must not be empty.
report::Chart force_chart(const diagnosis::Diagnosis& d);

/// Every hypothesis with its probability.
report::Bars ranking(const diagnosis::Diagnosis& d);

}  // namespace repose
