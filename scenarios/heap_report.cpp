#include "scenarios/heap_report.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/error.hpp"
#include "scenarios/version.hpp"

namespace repose {
namespace {

using namespace report;

constexpr double mm = 1e3;

std::string angle_note(const HeapReportInput& in) {
  const ReposeAngle& a = *in.heap.repose.angle;
  std::string note = fmt::format("standard error; standard deviation over {} flanks {:.2f}°", a.flanks.size(), a.sd);
  if (in.measured)
    note += fmt::format("; measured {}°", rounded(in.measured->value, in.measured->uncertainty));
  return note;
}

Chart profile_chart(const HeapMeasurement& heap) {
  Chart chart;
  chart.title = "Mean radial profile";
  chart.caption =
      "Mean height of the surface in rings of one mean grain diameter, from the exact shapes; bars: standard deviation within the "
      "ring. The line has the measured angle and spans the stretch that is fitted.";
  chart.x = {"distance from the axis", "mm"};
  chart.y = {"height above the plate", "mm"};
  chart.equal_scales = true;
  const RadialProfile& p = heap.repose.profile;
  Series profile{"heap", {}, {}, {}, Series::Style::points, false};
  for (std::size_t i = 0; i < p.radius.size(); ++i) {
    profile.x.push_back(p.radius[i] * mm);
    profile.y.push_back(p.height[i] * mm);
    profile.error.push_back(p.sd[i] * mm);
  }
  chart.series.push_back(std::move(profile));
  if (heap.repose.angle) {
    const ReposeAngle& a = *heap.repose.angle;
    const double slope = std::tan(a.value * std::numbers::pi / 180);
    // Through the middle of the profile: an outline stands above the mean surface by its roughness.
    double offset = 0, n = 0;
    for (std::size_t i = 0; i < p.radius.size(); ++i)
      if (p.radius[i] >= 0.2 * a.foot && p.radius[i] <= 0.8 * a.foot) {
        offset += p.height[i] + slope * p.radius[i];
        n += 1;
      }
    if (n > 0) {
      const auto at = [&](double share) { return (offset / n - slope * share * a.foot) * mm; };
      chart.series.push_back({fmt::format("{:.1f}°", a.value), {0.2 * a.foot * mm, 0.8 * a.foot * mm}, {at(0.2), at(0.8)}, {},
                              Series::Style::line, true});
    }
  }
  return chart;
}

Chart outline_chart(const HeapReportInput& in) {
  Chart chart;
  chart.title = "Outline, as a camera sees it";
  chart.caption = "Highest point of the heap in each column of the side view, along the whole line of sight, at two azimuths.";
  chart.x = {"across the picture", "mm"};
  chart.y = {"height above the plate", "mm"};
  chart.equal_scales = true;
  const auto site = heap_site(in.prepared.scene);
  for (double azimuth : {0.0, 90.0}) {
    const Outline o = heap_outline(in.prepared.model, in.run.final_state, in.heap.repose.grains, *site, azimuth);
    Series s{fmt::format("azimuth {:.0f}°", azimuth), {}, {}, {}, Series::Style::line, false};
    for (std::size_t i = 0; i < o.s.size(); ++i) {
      s.x.push_back(o.s[i] * mm);
      s.y.push_back(o.z[i] * mm);
    }
    chart.series.push_back(std::move(s));
  }
  return chart;
}

Chart flank_chart(const HeapReportInput& in) {
  const ReposeAngle& a = *in.heap.repose.angle;
  Chart chart;
  chart.title = "Angle of each flank";
  chart.caption = "One point per flank; the upper and the lower half of the fitted stretch apart show whether the flank is straight.";
  chart.x = {"azimuth", "°"};
  chart.y = {"angle", "°"};
  Series whole{"flank", {}, {}, {}, Series::Style::line_and_points, false};
  Series upper{"upper half", {}, {}, {}, Series::Style::points, false}, lower{"lower half", {}, {}, {}, Series::Style::points, false};
  for (const Flank& f : a.flanks) {
    for (Series* s : {&whole, &upper, &lower}) s->x.push_back(f.azimuth_deg);
    whole.y.push_back(f.angle_deg);
    upper.y.push_back(f.upper_deg);
    lower.y.push_back(f.lower_deg);
  }
  chart.series = {whole, upper, lower};
  if (in.measured) chart.bands.push_back({"measured", in.measured->value, in.measured->uncertainty.value_or(0)});
  return chart;
}

Chart discharge_chart(const HeapMeasurement& heap) {
  Chart chart;
  chart.title = "Discharge";
  chart.caption = "Mass below the outlet of the funnel. The steady rate is the slope between 20 % and 80 %.";
  chart.x = {"time", "s"};
  chart.y = {"mass", "mg"};
  Series s{"below the outlet", heap.discharge.time, {}, {}, Series::Style::line, false};
  for (double m : heap.discharge.mass) s.y.push_back(m * 1e6);
  chart.series.push_back(std::move(s));
  return chart;
}

Chart solver_chart(const std::vector<StepRecord>& steps, double tolerance) {
  Chart chart;
  chart.title = "Residual of each step";
  chart.caption = "Relative residual of the exact contact law after the last iteration.";
  chart.x = {"time", "s"};
  chart.y = {"residual", "", true};
  Series s{"residual", {}, {}, {}, Series::Style::line, false};
  for (const StepRecord& r : steps) {
    s.x.push_back(r.time);
    s.y.push_back(r.report.residual);
  }
  chart.series.push_back(std::move(s));
  chart.bands.push_back({"tolerance", tolerance, 0});
  return chart;
}

Chart iteration_chart(const std::vector<StepRecord>& steps) {
  Chart chart;
  chart.title = "Iterations of each step";
  chart.x = {"time", "s"};
  chart.y = {"iterations", ""};
  Series s{"iterations", {}, {}, {}, Series::Style::line, false};
  for (const StepRecord& r : steps) {
    s.x.push_back(r.time);
    s.y.push_back(r.report.iterations);
  }
  chart.series.push_back(std::move(s));
  return chart;
}

Table figures(const HeapReportInput& in) {
  const HeapMeasurement& heap = in.heap;
  const HeapGrains& g = heap.repose.grains;
  Table table;
  table.header = {"quantity", "value", "unit", "remark"};
  const auto row = [&](std::string name, std::string value, std::string unit, std::string remark) {
    table.rows.push_back({std::move(name), std::move(value), std::move(unit), std::move(remark)});
  };
  if (heap.repose.angle) {
    const ReposeAngle& a = *heap.repose.angle;
    row("angle of repose", rounded(a.value, a.se), "°", "standard error from six sectors");
    row("  over azimuths and flanks", fmt::format("{:.2f}", a.sd), "°", "standard deviation of single flanks");
    row("  of the mean radial profile", rounded(a.radial, a.radial_se), "°", "error of the line fit");
    row("  of the whole-depth outline", fmt::format("{:.2f}", a.whole_depth), "°", "reads flat on small heaps");
    row("  upper minus lower half", fmt::format("{:.2f}", a.concavity), "°", "0: straight flanks");
  }
  row("grains on the base", fmt::format("{}", g.heap.size()), "", heap.repose.profile.covers_base ? "the heap covers its base" : "the heap does not cover its base");
  row("grains over the rim", fmt::format("{}", g.trench.size() + g.rim.size()), "", "in the trench or on the rim");
  row("mass of the heap", fmt::format("{:.4g}", g.heap_mass * 1e6), "mg", "");
  if (heap.solid) row("solid fraction", rounded(heap.solid->value, heap.solid->se), "1", "interior of the heap; measured 0.451 (460/1020)");
  if (heap.rate) row("discharge rate", rounded(heap.rate->rate * 1e6, heap.rate->se * 1e6), "mg/s", "20 % to 80 %");
  if (heap.beverloo) row("  after Beverloo", fmt::format("{:.4g}", *heap.beverloo * 1e6), "mg/s", "C 0.58, k 1.4, bulk density of this heap");
  row("fastest grain at the end", fmt::format("{:.2g}", heap.rest.speed_max), "√(g d)", heap.rest.at_rest ? "at rest" : "NOT at rest: " + heap.rest.reason);
  if (heap.moved)
    row("largest displacement", fmt::format("{:.2g}", heap.moved->max), "d", fmt::format("in the last {:.3g} s", heap.moved->interval));
  row("deepest penetration", fmt::format("{:.3g}", 100 * in.run.max_penetration / g.diameter), "% of d", "over all steps, by geometry");
  row("converged steps", fmt::format("{:.2f}", 100 * in.run.converged_fraction), "%", fmt::format("tolerance {:.1g}", in.prepared.scene.solver.tolerance));
  row("iterations per step", fmt::format("{:.1f}", in.run.iterations_mean), "", "mean");
  row("contacts", fmt::format("{:.0f}", in.run.contacts_mean), "", "mean");
  return table;
}

}  // namespace

report::Report heap_report(const HeapReportInput& in) {
  Report page;
  page.title = "Angle of repose";
  page.subtitle = fmt::format("{} grains, backend {}, seed {}", in.prepared.model.grain_count(), in.options.backend, in.options.seed);
  if (in.heap.repose.angle)
    page.headlines.push_back({"Angle of repose", in.heap.repose.angle->value, in.heap.repose.angle->se, "°", angle_note(in)});
  if (in.heap.solid) page.headlines.push_back({"Solid fraction", in.heap.solid->value, in.heap.solid->se, "", "measured 0.451"});

  Warnings warnings;
  if (!in.heap.repose.angle) warnings.items.push_back("no angle: " + in.heap.repose.message);
  if (!in.heap.rest.at_rest) warnings.items.push_back("the heap is not at rest: " + in.heap.rest.reason);
  if (in.heap.rest.in_funnel > 0)
    warnings.items.push_back(fmt::format("{} grains stay in the funnel: its outlet is clogged, or closed", in.heap.rest.in_funnel));
  for (const Finding& f : in.prepared.findings) warnings.items.push_back(f.place + ": " + f.message);
  for (const std::string& name : in.prepared.unsupported) warnings.items.push_back("left out, the backend cannot do it: " + name);
  page.sections.push_back({"", {warnings, Picture{in.picture_png, "Heap at the end of the run, coloured by shape.", ""}}});

  Section heap{"Heap", {profile_chart(in.heap)}};
  if (!in.heap.repose.grains.heap.empty()) heap.blocks.push_back(outline_chart(in));
  if (in.heap.repose.angle) heap.blocks.push_back(flank_chart(in));
  page.sections.push_back(std::move(heap));
  page.sections.push_back({"Figures", {figures(in)}});
  Section flow{"Flow and solver", {}};
  if (in.heap.discharge.time.size() >= 2) flow.blocks.push_back(discharge_chart(in.heap));
  if (!in.steps.empty()) {
    flow.blocks.push_back(solver_chart(in.steps, in.prepared.scene.solver.tolerance));
    flow.blocks.push_back(iteration_chart(in.steps));
  }
  page.sections.push_back(std::move(flow));
  Settings settings{"Run", {}};
  settings.entries = {{"backend", in.options.backend},
                      {"seed", std::to_string(in.options.seed)},
                      {"steps", std::to_string(in.run.steps)},
                      {"time step", fmt::format("{:.3g} s", in.prepared.scene.solver.time_step)},
                      {"simulated", fmt::format("{:.4g} s", in.run.final_state.time)},
                      {"wall clock", fmt::format("{:.1f} s", in.run.wall_s)},
                      {"version", std::string(version()) + " (" + commit() + ")"}};
  page.sections.push_back({"Settings", {settings, Listing{"Scene as it was understood", in.prepared.scene.text}}});
  return page;
}

}  // namespace repose
