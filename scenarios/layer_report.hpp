#pragma once
/// The report of `repose layer`.
#include "analysis/report/report.hpp"
#include "scenarios/bed.hpp"
#include "scenarios/layer_half_step.hpp"
#include "scenarios/simulate.hpp"
#include "scenarios/spreader.hpp"

namespace repose {

struct LayerReportInput {
  const Prepared& prepared;
  const Options& options;
  const RunReport& run;
  const Recording& recording;
  const LayerMeasurement& layer;
  const SpreaderPath& path;
  const Bed& bed;
  const std::string &surface_png, &thickness_png;
  const std::optional<HalfStep>& half_step;
};

report::Report layer_report(const LayerReportInput& in);

}  // namespace repose
