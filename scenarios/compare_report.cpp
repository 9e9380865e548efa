#include "scenarios/compare_report.hpp"

#include <cmath>
#include <tuple>

#include <fmt/format.h>

namespace repose {
namespace {

using namespace report;
using nlohmann::json;

double number_in(const json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

std::string told(const json& value) {
  if (!value["mean"].is_number()) return "–";
  const double se = number_in(value["se"]);
  return se > 0 ? rounded(value["mean"].get<double>(), se) : rounded(value["mean"].get<double>());
}

Table observable_table(const json& compare, const std::string& kind, const std::string& title) {
  Table table;
  table.title = title;
  table.header = {"observable", "unit"};
  for (const auto& [label, ignored] : compare["backends"].items()) table.header.push_back(label);
  table.header.insert(table.header.end(), {"verdict", "standard errors"});
  for (const json& o : compare["observables"]) {
    if (o["kind"] != kind) continue;
    std::vector<std::string> row = {o["name"].get<std::string>(), o["unit"] == "1" ? "" : o["unit"].get<std::string>()};
    for (const auto& [label, ignored] : compare["backends"].items()) row.push_back(told(o["values"][label]));
    row.push_back(o["verdict"].get<std::string>());
    row.push_back(o["standard_errors"].is_number() ? fmt::format("{:.1f}", o["standard_errors"].get<double>()) : "–");
    table.rows.push_back(std::move(row));
  }
  return table;
}

Chart curve_chart(const json& compare, const std::string& curve, Chart chart) {
  for (const auto& [label, backend] : compare["backends"].items()) {
    if (!backend["curves"].contains(curve)) continue;
    const json& c = backend["curves"][curve];
    Series series{label, {}, {}, {}, Series::Style::line, false};
    for (std::size_t i = 0; i < c["x"].size(); ++i) {
      series.x.push_back(c["x"][i].get<double>());
      series.y.push_back(c["mean"][i].get<double>());
      series.error.push_back(number_in(c["se"][i]));
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

// Shift under refinement, and the differences between backends, in standard errors of the seeds: one scale for all observables.
Table refinement_table(const json& compare) {
  Table table;
  table.header = {"observable", "unit", "backend", "under h/2", "under tolerance/10"};
  for (const json& o : compare["observables"]) {
    if (o["kind"] != "physics") continue;
    for (const auto& [label, how] : o["refinement"].items()) {
      const auto cell = [&](const char* key) {
        if (!how.contains(key)) return std::string("–");
        const double se = number_in(how[key]["se"]);
        return se > 0 ? rounded(how[key]["shift"].get<double>(), se) : rounded(how[key]["shift"].get<double>());
      };
      table.rows.push_back({o["name"].get<std::string>(), o["unit"] == "1" ? "" : o["unit"].get<std::string>(), label, cell("half_step"),
                            cell("tenth_tolerance")});
    }
  }
  table.notes = {"How much each backend's own value moves when it is run finer, paired by seed, with the standard error."};
  return table;
}

Chart refinement_chart(const json& compare) {
  Chart chart;
  chart.title = "Differences and refinement in standard errors";
  chart.caption =
      "Numbered as in the table of refinement's first column (order of the observables). Differences between backends beside what halving the step moves each: "
      "a difference that is no larger than a shift may be the step's.";
  chart.x = {"observable, in the order of the table", ""};
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
  Section verdict{"", {Warnings{compare["warnings"].get<std::vector<std::string>>()}, Text{compare["headline"].get<std::string>()}}};
  Table physics = observable_table(compare, "physics", "");
  physics.notes = {
      "Mean ± standard error over seeds. The same seed makes the same grains, so differences are paired by seed (Student's t); p values corrected by Holm over "
      "all observables and pairs; differ: corrected p < 0.05 and more than the solver's tolerance. Forces inside a packing are not unique and not compared; "
      "loads on tools are means over the last tenth of the run. Coordination: pairs of grains that press with more than 1 % of a mean grain's weight."};
  verdict.blocks.push_back(std::move(physics));
  page.sections.push_back(std::move(verdict));

  Section why{"Where they differ, and why", {}};
  for (const json& o : compare["observables"])
    if (o["kind"] == "physics" && o["verdict"] == "differ") why.blocks.push_back(Text{o["name"].get<std::string>() + ": " + o["text"].get<std::string>()});
  for (const json& p : compare["partings"]) {
    why.blocks.push_back(Text{fmt::format("{} and {} part {}.", p["a"].get<std::string>(), p["b"].get<std::string>(), p["text"].get<std::string>())});
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
