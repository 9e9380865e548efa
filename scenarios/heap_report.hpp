#pragma once
/// The page that `repose aor` writes: the angle, the picture, the profile, the discharge, the solver, the settings.
#include <optional>
#include <string>
#include <vector>

#include "analysis/heap_measurement.hpp"
#include "analysis/reference.hpp"
#include "analysis/report/report.hpp"
#include "core/recording.hpp"
#include "scenarios/simulate.hpp"

namespace repose {

struct HeapReportInput {
  const Prepared& prepared;
  const Options& options;
  const RunReport& run;
  const std::vector<StepRecord>& steps;
  const HeapMeasurement& heap;
  std::string picture_png;                  ///< bytes
  std::optional<ReferenceValue> measured;   ///< angle of the experiment, drawn as a band
};

report::Report heap_report(const HeapReportInput& input);

}  // namespace repose
