#include "scenarios/study_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

namespace repose {
namespace {

using namespace report;
using nlohmann::json;

const json* observable(const json& point, const char* name) {
  const json& all = point["observables"];
  return all.contains(name) ? &all[name] : nullptr;
}

// NaN for null: a chart then draws no bar.
double number_in(const json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

std::string last_name(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

// "31.20 +- 0.15" for an observable of a point, "" if it has none.
std::string told(const json& point, const char* name) {
  const json* o = observable(point, name);
  if (o == nullptr) return "";
  const double se = number_in((*o)["se"]);
  return se > 0 ? rounded((*o)["mean"].get<double>(), se) : rounded((*o)["mean"].get<double>());
}

// Angle against x for all series whose first varied key is `key`.
Chart angle_chart(const StudyPlan& plan, const json& study, const std::string& key, const std::map<std::string, ReferenceSet>& references,
                  const std::optional<ReferenceValue>& measured) {
  Chart chart;
  chart.title = "Angle of repose against " + last_name(key);
  chart.caption = "Mean over seeds; bars: standard error of the mean. Published values: bars as stated in the reference file.";
  chart.x = {last_name(key), ""};
  chart.y = {"angle of repose", "°"};
  std::set<std::string> drawn;
  for (std::size_t s = 0; s < plan.series.size(); ++s) {
    if (plan.series[s].x_key != key) continue;
    Series series{plan.series[s].label, {}, {}, {}, Series::Style::line_and_points, false};
    for (std::size_t p = 0; p < plan.points.size(); ++p) {
      const json* angle = observable(study["points"][p], "angle_of_repose");
      if (plan.points[p].series != s || !plan.points[p].x || angle == nullptr) continue;
      series.x.push_back(*plan.points[p].x);
      series.y.push_back((*angle)["mean"].get<double>());
      series.error.push_back(number_in((*angle)["se"]));
    }
    if (!series.x.empty()) chart.series.push_back(std::move(series));
    const auto reference = references.find(plan.series[s].reference);
    if (reference == references.end() || !drawn.insert(reference->first).second) continue;
    Series published{"published (" + reference->first + ")", {}, {}, {}, Series::Style::line_and_points, true};
    for (const ReferenceValue& v : reference->second.curve("angle_of_repose")) {
      published.x.push_back(*v.x);
      published.y.push_back(v.value);
      published.error.push_back(v.uncertainty.value_or(std::nan("")));
    }
    chart.series.push_back(std::move(published));
  }
  if (measured) chart.bands.push_back({"measured", measured->value, measured->uncertainty.value_or(0)});
  return chart;
}

Table point_table(const json& study) {
  Table table;
  table.header = {"series", "point", "angle [°]", "sd azimuth [°]", "sd seed [°]", "n", "solid fraction", "grains on base", "at rest"};
  for (const json& point : study["points"]) {
    const json* angle = observable(point, "angle_of_repose");
    const auto number = [&](const char* key) {
      return angle && (*angle)[key].is_number() ? fmt::format("{:.2f}", (*angle)[key].get<double>()) : std::string();
    };
    const std::size_t runs = point["runs"].get<std::size_t>(), moving = point["not_at_rest"].get<std::size_t>();
    table.rows.push_back({point["series"].get<std::string>(), point["label"].get<std::string>(), told(point, "angle_of_repose"),
                          number("sd_azimuth"), number("sd_seed"), angle ? std::to_string((*angle)["n"].get<int>()) : "0",
                          told(point, "solid_fraction"), told(point, "grains_on_base"), fmt::format("{} of {}", runs - moving, runs)});
  }
  table.notes = {"sd azimuth: scatter over azimuths and flanks within one heap; sd seed: scatter of the heaps' mean angles; the error of "
                 "the angle is sd seed / sqrt(n)."};
  return table;
}

Table slope_table(const json& study) {
  Table table;
  table.header = {"series", "against", "slope [°]", "95 % interval", "published slope", "difference [standard errors]", "largest difference of values [°]"};
  for (const json& series : study["series"]) {
    if (!series.contains("slope")) continue;
    const json& slope = series["slope"];
    std::string interval, published, difference, largest;
    if (slope.contains("interval95"))
      interval = fmt::format("{:.1f} to {:.1f}", slope["interval95"][0].get<double>(), slope["interval95"][1].get<double>());
    if (series.contains("reference")) {
      const json& reference = series["reference"];
      if (reference.contains("slope"))
        published = rounded(reference["slope"]["value"].get<double>(), reference["slope"]["se"].get<double>());
      if (reference.contains("slope_difference"))
        difference = fmt::format("{:.1f}", reference["slope_difference"]["standard_errors"].get<double>());
      if (!reference["differences"].empty()) largest = fmt::format("{:.2f}", reference["largest_difference"].get<double>());
    }
    table.rows.push_back({series["label"].get<std::string>(), last_name(series["x"].get<std::string>()),
                          rounded(slope["value"].get<double>(), slope["se"].get<double>()), interval, published, difference, largest});
  }
  table.notes = {"Slope: least squares over all single runs, per unit of the varied key; its error from their scatter. Published slope: of the "
                 "published values, its error from their scatter about the line."};
  return table;
}

Table solver_table(const json& study) {
  Table table;
  table.header = {"series", "point", "converged", "iterations", "penetration / d", "contacts per grain", "wall clock per run [s]"};
  for (const json& point : study["points"])
    table.rows.push_back({point["series"].get<std::string>(), point["label"].get<std::string>(), told(point, "converged_fraction"),
                          told(point, "iterations_mean"), told(point, "penetration_diameters"), told(point, "contacts_per_grain"),
                          told(point, "wall_s")});
  return table;
}

}  // namespace

report::Report study_report(const StudyPlan& plan, const json& study, const std::map<std::string, ReferenceSet>& references,
                            const std::optional<ReferenceValue>& measured, const std::optional<ReferenceValue>& solid_fraction) {
  Report page;
  page.title = plan.title;
  std::size_t runs = 0, failed = 0, moving = 0;
  for (const json& point : study["points"]) {
    runs += point["runs"].get<std::size_t>();
    failed += point["failed"].get<std::size_t>();
    moving += point["not_at_rest"].get<std::size_t>();
  }
  page.subtitle = fmt::format("{} runs at {} points", runs, plan.points.size());
  Warnings warnings;
  if (failed > 0) warnings.items.push_back(fmt::format("{} runs failed", failed));
  if (moving > 0) warnings.items.push_back(fmt::format("{} heaps were not at rest at the end", moving));
  Section results{"", {warnings}};
  std::set<std::string> keys;
  for (const StudySeries& s : plan.series)
    if (!s.x_key.empty() && keys.insert(s.x_key).second) {
      Chart chart = angle_chart(plan, study, s.x_key, references, measured);
      if (!chart.series.empty()) results.blocks.push_back(std::move(chart));
    }
  page.sections.push_back(std::move(results));
  page.sections.push_back({"Slopes", {slope_table(study)}});
  Section points{"Points", {point_table(study)}};
  std::string beside = "Measured beside it: ";
  if (measured) beside += fmt::format("angle {}°", rounded(measured->value, measured->uncertainty));
  if (solid_fraction) beside += fmt::format(", solid fraction of the poured powder {:.3f}", solid_fraction->value);
  if (measured || solid_fraction) points.blocks.push_back(Text{beside + "."});
  page.sections.push_back(std::move(points));
  page.sections.push_back({"Solver", {solver_table(study)}});
  Section sources{"Sources", {}};
  for (const auto& [name, set] : references) sources.blocks.push_back(Text{set.title + ". " + set.source + ". " + set.method});
  if (!references.empty()) page.sections.push_back(std::move(sources));
  return page;
}

}  // namespace repose
