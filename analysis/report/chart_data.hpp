#pragma once
/// A chart as the data that report.js draws.
#include <string>
#include <vector>

#include "analysis/report/report.hpp"

namespace repose::report {

/// Indices of at most about `limit` points that look like all of them: the lowest and the highest of each stretch, the
/// ends, and the gaps (NaN).
std::vector<std::size_t> thinned(const std::vector<double>& y, std::size_t limit);

/// JSON that is safe inside a script element. Points that a logarithmic axis cannot show are left out; `left_out`
/// counts.
std::string chart_json(const Chart& chart, std::size_t& left_out);

}  // namespace repose::report
