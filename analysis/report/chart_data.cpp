#include "analysis/report/chart_data.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace repose::report {
namespace {

constexpr std::size_t most_points = 4000;

/// JSON has no NaN; null is a gap.
nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

std::string axis_title(const Axis& axis) {
  return axis.unit.empty() ? axis.label : axis.label + " [" + axis.unit + "]";
}

nlohmann::json axis_json(const Axis& axis) { return {{"title", axis_title(axis)}, {"log", axis.logarithmic}}; }

}  // namespace

std::vector<std::size_t> thinned(const std::vector<double>& y, std::size_t limit) {
  std::vector<std::size_t> kept;
  const std::size_t n = y.size();
  if (n <= limit || limit < 4) {
    for (std::size_t i = 0; i < n; ++i) kept.push_back(i);
    return kept;
  }
  const std::size_t stretches = (limit - 2) / 2;
  kept.push_back(0);
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t from = 1 + s * (n - 2) / stretches, to = 1 + (s + 1) * (n - 2) / stretches;
    std::size_t low = from, high = from;
    bool gap = false;
    for (std::size_t i = from; i < to; ++i) {
      gap = gap || std::isnan(y[i]);
      if (y[i] < y[low] || std::isnan(y[low])) low = i;
      if (y[i] > y[high] || std::isnan(y[high])) high = i;
    }
    kept.push_back(std::min(low, high));
    if (low != high) kept.push_back(std::max(low, high));
    if (gap)
      for (std::size_t i = from; i < to; ++i)
        if (std::isnan(y[i]) && i != kept.back()) {
          kept.push_back(i);
          break;
        }
  }
  kept.push_back(n - 1);
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

std::string chart_json(const Chart& chart, std::size_t& left_out) {
  left_out = 0;
  nlohmann::json json{{"x", axis_json(chart.x)}, {"y", axis_json(chart.y)}, {"equal", chart.equal_scales}};
  json["series"] = nlohmann::json::array();
  json["bands"] = nlohmann::json::array();
  for (const Series& series : chart.series) {
    nlohmann::json points = nlohmann::json::array();
    for (const std::size_t i : thinned(series.y, most_points)) {
      const bool hidden = (chart.x.logarithmic && !(series.x[i] > 0)) ||
                          (chart.y.logarithmic && !std::isnan(series.y[i]) && !(series.y[i] > 0));
      if (hidden) {
        ++left_out;
        continue;
      }
      if (!std::isfinite(series.x[i])) continue;
      nlohmann::json point{{"x", series.x[i]}, {"y", finite_or_null(series.y[i])}};
      if (!series.error.empty() && std::isfinite(series.error[i])) point["e"] = series.error[i];
      points.push_back(std::move(point));
    }
    json["series"].push_back({{"name", series.name},
                              {"line", series.style != Series::Style::points},
                              {"points", series.style != Series::Style::line},
                              {"dashed", series.dashed},
                              {"data", std::move(points)}});
  }
  json["windows"] = nlohmann::json::array();
  for (const Window& w : chart.windows) json["windows"].push_back({{"name", w.name}, {"from", w.from}, {"to", w.to}});
  for (const Band& band : chart.bands)
    json["bands"].push_back({{"name", band.name}, {"value", band.value}, {"half", band.half_width}});
  const std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      safe += "\\u003c";  // nothing inside can then end the script element
    else
      safe += c;
  }
  return safe;
}

}  // namespace repose::report
