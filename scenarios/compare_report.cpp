#include "scenarios/compare_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace repose {
namespace {

using namespace report;
using nlohmann::json;

double number_in(const json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

// A unit in which numbers of this size read well: value * factor in `unit`.
struct ReadableUnit {
  double factor = 1;
  std::string unit;
};

ReadableUnit readable(double largest, std::string unit) {
  if (unit == "1") return {1, ""};
  double factor = 1;
  if (unit.starts_with("kg")) {  // the one unit that has a prefix already
    unit = unit.substr(1);
    factor = 1000;
  }
  if (unit.empty() || unit == "deg" || unit.starts_with("rad") || !(largest > 0)) return {factor, unit == "deg" ? "°" : unit};
  static constexpr const char* prefixes[] = {"f", "p", "n", "µ", "m", ""};
  const double exponent = std::floor(std::log10(largest * factor * 1.0000001) / 3);
  const int steps = static_cast<int>(std::clamp(exponent, -5.0, 0.0));
  return {factor * std::pow(10, -3 * steps), prefixes[5 + steps] + unit};
}

std::string told(double value, double error, double factor) {
  if (!std::isfinite(value)) return "–";
  return error > 0 ? rounded(value * factor, error * factor) : rounded(value * factor);
}

ReadableUnit unit_of(const json& observable) {
  double largest = 0;
  for (const auto& [label, value] : observable["values"].items())
    if (value["mean"].is_number()) largest = std::max(largest, std::abs(value["mean"].get<double>()));
  return readable(largest, observable["unit"]);
}

// "load.base.vertical" as "load on base, vertical", "angle_of_repose" as "angle of repose".
std::string readable_name(const json& observable) {
  std::string name = observable["name"];
  if (name.starts_with("load."))
    if (const std::size_t dot = name.rfind('.'); dot > 5) name = "load on " + name.substr(5, dot - 5) + ", " + name.substr(dot + 1);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Table observable_table(const json& compare, const std::string& kind, const std::string& title) {
  Table table;
  table.title = title;
  table.header = {"observable", "unit"};
  for (const auto& [label, ignored] : compare["backends"].items()) table.header.push_back(label);
  table.header.insert(table.header.end(), {"verdict", "standard errors"});
  for (const json& o : compare["observables"]) {
    if (o["kind"] != kind) continue;
    const ReadableUnit in = unit_of(o);
    std::vector<std::string> row = {readable_name(o), in.unit};
    for (const auto& [label, ignored] : compare["backends"].items())
      row.push_back(told(number_in(o["values"][label]["mean"]), number_in(o["values"][label]["se"]), in.factor));
    row.push_back(kind == "cost" ? "" : o["verdict"].get<std::string>());
    row.push_back(o["standard_errors"].is_number() ? fmt::format("{:.1f}", o["standard_errors"].get<double>()) : "–");
    table.rows.push_back(std::move(row));
  }
  // What differs is what one looks for.
  std::stable_partition(table.rows.begin(), table.rows.end(), [](const auto& row) { return row[row.size() - 2] == "differ"; });
  return table;
}

// What "agree" leaves room for.
Table difference_table(const json& compare) {
  Table table{"Differences and their 95 % intervals", {"observable", "unit"}, {}, {}};
  for (const json& o : compare["observables"]) {
    if (o["kind"] != "physics") continue;
    const ReadableUnit in = unit_of(o);
    std::vector<std::string> row = {readable_name(o), in.unit};
    for (const json& p : o["pairs"]) {
      if (table.rows.empty()) table.header.push_back(p["a"].get<std::string>() + " – " + p["b"].get<std::string>());
      row.push_back(p.contains("half_width_95") ? told(number_in(p["difference"]), number_in(p["half_width_95"]), in.factor) : "–");
    }
    table.rows.push_back(std::move(row));
  }
  table.notes = {"To agree is not to be equal: a true difference within the interval (Student, paired by seed, this observable alone) is not ruled "
                 "out. More seeds narrow it."};
  return table;
}

double largest_in(const json& compare, const std::string& curve, const char* axis) {
  double largest = 0;
  for (const auto& [label, backend] : compare["backends"].items())
    if (backend["curves"].contains(curve))
      for (const json& v : backend["curves"][curve][axis]) largest = std::max(largest, std::abs(v.get<double>()));
  return largest;
}

// The axes' units are SI; the chart is drawn in readable ones.
Chart curve_chart(const json& compare, const std::string& curve, Chart chart) {
  const ReadableUnit x = readable(largest_in(compare, curve, "x"), chart.x.unit), y = readable(largest_in(compare, curve, "mean"), chart.y.unit);
  chart.x.unit = x.unit;
  chart.y.unit = y.unit;
  for (const auto& [label, backend] : compare["backends"].items()) {
    if (!backend["curves"].contains(curve)) continue;
    const json& c = backend["curves"][curve];
    Series series{label, {}, {}, {}, Series::Style::line, false};
    for (std::size_t i = 0; i < c["x"].size(); ++i) {
      series.x.push_back(x.factor * c["x"][i].get<double>());
      series.y.push_back(y.factor * c["mean"][i].get<double>());
      series.error.push_back(y.factor * number_in(c["se"][i]));
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

Table refinement_table(const json& compare) {
  Table table;
  table.header = {"no.", "observable", "unit", "backend", "under h/2", "under tolerance/10"};
  int place = 0;
  for (const json& o : compare["observables"]) {
    if (o["kind"] != "physics") continue;
    ++place;
    const ReadableUnit in = unit_of(o);
    for (const auto& [label, how] : o["refinement"].items()) {
      const auto cell = [&](const char* key) {
        if (!how.contains(key)) return std::string("–");
        return told(number_in(how[key]["shift"]), number_in(how[key]["se"]), in.factor);
      };
      table.rows.push_back({std::to_string(place), readable_name(o), in.unit, label, cell("half_step"), cell("tenth_tolerance")});
    }
  }
  table.notes = {"How much each backend's own value moves when it is run finer, paired by seed, with the standard error."};
  return table;
}

Chart refinement_chart(const json& compare) {
  Chart chart;
  chart.title = "Differences and refinement in standard errors";
  chart.caption =
      "Differences between backends beside what halving the step moves each, all in their own standard errors over seeds: below about 3 is scatter.";
  chart.x = {"number of the observable in the table below", ""};
  chart.y = {"difference / its standard error", ""};
  std::map<std::string, Series> series;
  double place = 0;
  for (const json& o : compare["observables"]) {
    if (o["kind"] != "physics") continue;
    ++place;
    const auto add = [&](const std::string& name, double y) {
      if (!std::isfinite(y)) return;
      Series& s = series.try_emplace(name, Series{name, {}, {}, {}, Series::Style::points, false}).first->second;
      s.x.push_back(place);
      s.y.push_back(y);
    };
    for (const json& p : o["pairs"])
      if (p.contains("standard_errors")) add(p["a"].get<std::string>() + " – " + p["b"].get<std::string>(), number_in(p["standard_errors"]));
    for (const auto& [label, how] : o["refinement"].items())
      if (how.contains("half_step"))
        if (const double se = number_in(how["half_step"]["se"]); se > 0) add(label + " under h/2", std::abs(how["half_step"]["shift"].get<double>()) / se);
  }
  for (auto& [name, s] : series) chart.series.push_back(std::move(s));
  return chart;
}

}  // namespace

report::Report compare_report(const json& compare) {
  Report page;
  page.title = compare["title"].get<std::string>();
  page.subtitle = fmt::format("{} grains, {} {} per backend", compare["grains"].get<std::size_t>(), compare["seeds"].get<std::size_t>(),
                              compare["seeds"] == 1 ? "run" : "seeds");
  page.lead = compare["headline"].get<std::string>();
  Section verdict{"", {Warnings{compare["warnings"].get<std::vector<std::string>>()}}};
  Table physics = observable_table(compare, "physics", "");
  physics.notes = {
      "Mean ± standard error over seeds. The same seed makes the same grains, so differences are paired by seed (Student's t); p values corrected by Holm over "
      "all observables and pairs; differ: corrected p < 0.05 and more than the solver's tolerance. Forces inside a packing are not unique and not compared; "
      "loads on tools are means over the last tenth of the run. Coordination: pairs of grains that press with more than 1 % of a mean grain's weight."};
  verdict.blocks.push_back(std::move(physics));
  if (compare["seeds"] > 1) verdict.blocks.push_back(difference_table(compare));
  page.sections.push_back(std::move(verdict));

  Section why{"Where they differ, and why", {}};
  for (const json& o : compare["observables"])
    if (o["kind"] == "physics" && o["verdict"] == "differ") why.blocks.push_back(Text{readable_name(o) + ": " + o["text"].get<std::string>()});
  for (const json& p : compare["partings"]) {
    why.blocks.push_back(Text{fmt::format("Runs of {} and {} part: {}.", p["a"].get<std::string>(), p["b"].get<std::string>(), p["text"].get<std::string>())});
    if (p.contains("half_step"))
      why.blocks.push_back(Text{fmt::format("With half the step both: {}.", p["half_step"]["text"].get<std::string>())});
  }
  page.sections.push_back(std::move(why));

  Section curves{"Curves", {}};
  const std::string bars = "Mean over seeds; bars: standard error.";
  for (auto& [name, chart] : {std::pair{"heap_profile", Chart{"Heap profile", bars, {"radius", "m"}, {"height", "m"}, {}, {}, false}},
                              {"discharged_mass", Chart{"Discharge", bars, {"time", "s"}, {"mass below the outlet", "kg"}, {}, {}, false}},
                              {"kinetic_energy", Chart{"Kinetic energy", bars, {"time", "s"}, {"kinetic energy", "J"}, {}, {}, false}}}) {
    Chart drawn = curve_chart(compare, name, chart);
    if (!drawn.series.empty()) curves.blocks.push_back(std::move(drawn));
  }
  page.sections.push_back(std::move(curves));

  Section refinement{"Refinement", {}};
  if (Table table = refinement_table(compare); !table.rows.empty()) {
    if (Chart chart = refinement_chart(compare); !chart.series.empty()) refinement.blocks.push_back(std::move(chart));
    refinement.blocks.push_back(std::move(table));
  } else {
    refinement.blocks.push_back(Text{"Not run (--no-refine): step and tolerance are not ruled out as the cause of a difference."});
  }
  page.sections.push_back(std::move(refinement));
  page.sections.push_back({"How well each engine did, and what it cost", {observable_table(compare, "quality", ""), observable_table(compare, "cost", "")}});
  page.sections.push_back({"Scene", {Listing{"The scene as it was understood", compare["scene_text"].get<std::string>()}}});
  return page;
}

}  // namespace repose
