#include "scenarios/study_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

namespace repose {
namespace {

using namespace report;
using nlohmann::json;

constexpr std::size_t charted = 2;  // of the told observables, against each varied key

const json* observable(const json& point, const std::string& name) {
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
std::string told(const json& point, const std::string& name, double factor = 1) {
  const json* o = observable(point, name);
  if (o == nullptr) return "";
  const double mean = factor * (*o)["mean"].get<double>(), se = factor * number_in((*o)["se"]);
  return se > 0 ? rounded(mean, se) : rounded(mean);
}

std::string with_unit(const ToldObservable& o) { return o.unit.empty() ? o.label : fmt::format("{} [{}]", o.label, o.unit); }

// One observable against x for all series whose first varied key is `key`.
Chart chart_of(const StudyPlan& plan, const json& study, const std::string& key, const std::map<std::string, ReferenceSet>& references,
               const ToldObservable& shown, const std::map<std::string, ReferenceValue>& measured) {
  Chart chart;
  std::string title = shown.label + " against " + last_name(key);
  title.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(title.front())));
  chart.title = std::move(title);
  chart.caption = "Mean over seeds; bars: standard error of the mean.";
  chart.x = {last_name(key), ""};
  chart.y = {shown.label, shown.unit};
  std::set<std::string> drawn;
  for (std::size_t s = 0; s < plan.series.size(); ++s) {
    if (plan.series[s].x_key != key) continue;
    chart.x.unit = plan.series[s].x_unit;
    Series series{plan.series[s].label, {}, {}, {}, Series::Style::line_and_points, false};
    for (std::size_t p = 0; p < plan.points.size(); ++p) {
      const json* value = observable(study["points"][p], shown.name);
      if (plan.points[p].series != s || !plan.points[p].x || value == nullptr) continue;
      series.x.push_back(*plan.points[p].x);
      series.y.push_back(shown.factor * (*value)["mean"].get<double>());
      series.error.push_back(shown.factor * number_in((*value)["se"]));
    }
    if (!series.x.empty()) chart.series.push_back(std::move(series));
    const auto reference = references.find(plan.series[s].reference);
    if (reference == references.end() || !drawn.insert(reference->first).second) continue;
    Series published{"published (" + reference->first + ")", {}, {}, {}, Series::Style::line_and_points, true};
    for (const ReferenceValue& v : reference->second.curve(shown.name)) {
      published.x.push_back(*v.x);
      published.y.push_back(v.value);
      published.error.push_back(v.uncertainty.value_or(std::nan("")));
    }
    if (published.x.empty()) continue;
    chart.series.push_back(std::move(published));
    chart.caption = "Mean over seeds; bars: standard error of the mean. Published values: bars as stated in the reference file.";
  }
  if (const auto value = measured.find(shown.name); value != measured.end())
    chart.bands.push_back({"measured", value->second.value, value->second.uncertainty.value_or(0)});
  return chart;
}

Table point_table(const json& study, const Experiment& experiment) {
  const std::vector<ToldObservable>& shown = experiment.told();
  const ToldObservable& principal = shown.front();
  Table table;
  table.header = {"series", "point"};
  for (const ToldObservable& o : shown) table.header.push_back(with_unit(o));
  const std::string unit = principal.unit.empty() ? "" : " [" + principal.unit + "]";
  for (const std::string& name : {"sd within" + unit, "sd seed" + unit, std::string("n"), std::string("at rest")}) table.header.push_back(name);
  for (const json& point : study["points"]) {
    const json* first = observable(point, principal.name);
    const auto number = [&](const std::string& key) {
      return first && first->contains(key) && (*first)[key].is_number() ? rounded(principal.factor * (*first)[key].get<double>()) : std::string();
    };
    std::vector<std::string> row{point["series"].get<std::string>(), point["label"].get<std::string>()};
    for (const ToldObservable& o : shown) row.push_back(told(point, o.name, o.factor));
    const std::size_t runs = point["runs"].get<std::size_t>(), moving = point["not_at_rest"].get<std::size_t>();
    row.push_back(number(experiment.scatter_within()));
    row.push_back(number("sd_seed"));
    row.push_back(first ? std::to_string((*first)["n"].get<int>()) : "0");
    row.push_back(fmt::format("{} of {}", runs - moving, runs));
    table.rows.push_back(std::move(row));
  }
  table.notes = {fmt::format("sd within: scatter of the {} within one run ({}); sd seed: scatter of the runs' values; the error of a mean is sd seed / "
                             "sqrt(n), n runs.", principal.label, experiment.scatter_within())};
  return table;
}

Table slope_table(const json& study, const ToldObservable& principal) {
  Table table;
  const std::string unit = principal.unit.empty() ? "" : " [" + principal.unit + "]";
  const bool compared = std::any_of(study["series"].begin(), study["series"].end(), [](const json& series) { return series.contains("reference"); });
  table.header = {"series", "against", "slope" + unit, "95 % interval"};
  if (compared)
    for (const std::string& name : {std::string("published slope"), std::string("difference [standard errors]"), "largest difference of values" + unit})
      table.header.push_back(name);
  const double f = principal.factor;
  for (const json& series : study["series"]) {
    if (!series.contains("slope")) continue;
    const json& slope = series["slope"];
    std::string interval, published, difference, largest;
    if (slope.contains("interval95"))
      interval = fmt::format("{:.3g} to {:.3g}", f * slope["interval95"][0].get<double>(), f * slope["interval95"][1].get<double>());
    if (series.contains("reference")) {
      const json& reference = series["reference"];
      if (reference.contains("slope"))
        published = rounded(f * reference["slope"]["value"].get<double>(), f * reference["slope"]["se"].get<double>());
      if (reference.contains("slope_difference"))
        difference = fmt::format("{:.1f}", reference["slope_difference"]["standard_errors"].get<double>());
      if (!reference["differences"].empty()) largest = rounded(f * reference["largest_difference"].get<double>());
    }
    const auto per = series["x_unit"].get<std::string>();
    table.rows.push_back({series["label"].get<std::string>(), last_name(series["x"].get<std::string>()) + (per.empty() ? "" : " [" + per + "]"),
                          rounded(f * slope["value"].get<double>(), f * slope["se"].get<double>()), interval});
    if (compared)
      for (const std::string& cell : {published, difference, largest}) table.rows.back().push_back(cell);
  }
  table.notes = {"Slope: least squares over all single runs, per unit of the varied key; its error from their scatter."};
  if (compared) table.notes.push_back("Published slope: of the published values, its error from their scatter about the line.");
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
                            const Experiment& experiment) {
  const std::map<std::string, ReferenceValue> measured = experiment.measured();
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
  if (moving > 0) warnings.items.push_back(fmt::format("{} of {} {} were not at rest at the end", moving, runs, experiment.called()));
  Section results{"", {warnings}};
  std::set<std::string> keys;
  for (const StudySeries& s : plan.series) {
    if (s.x_key.empty() || !keys.insert(s.x_key).second) continue;
    for (std::size_t k = 0; k < std::min<std::size_t>(charted, experiment.told().size()); ++k) {
      Chart chart = chart_of(plan, study, s.x_key, references, experiment.told()[k], measured);
      if (chart.series.empty()) continue;
      chart.low = k > 0;
      results.blocks.push_back(std::move(chart));
    }
  }
  page.sections.push_back(std::move(results));
  page.sections.push_back({"Slopes", {slope_table(study, experiment.told().front())}});
  Section points{"Points", {point_table(study, experiment)}};
  std::string beside;
  for (const ToldObservable& o : experiment.told())
    if (const auto value = measured.find(o.name); value != measured.end())
      beside += fmt::format("{}{} {} {}", beside.empty() ? "Measured beside it: " : ", ", o.label,
                            value->second.uncertainty ? rounded(value->second.value, *value->second.uncertainty) : rounded(value->second.value), o.unit);
  if (!beside.empty()) points.blocks.push_back(Text{beside + "."});
  page.sections.push_back(std::move(points));
  page.sections.push_back({"Solver", {solver_table(study)}});
  Section sources{"Sources", {}};
  for (const auto& [name, set] : references) sources.blocks.push_back(Text{set.title + ". " + set.source + ". " + set.method});
  if (!references.empty()) page.sections.push_back(std::move(sources));
  return page;
}

}  // namespace repose
