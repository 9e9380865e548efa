#include "scenarios/layer_half_step.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "scenarios/layer_run.hpp"
#include "scenarios/progress.hpp"

namespace repose {
namespace {

using nlohmann::json;

std::vector<StepFigure> figures_of(const LayerMeasurement& whole, const LayerMeasurement& half) {
  std::vector<StepFigure> figures;
  const auto add = [&](const char* name, const char* key, const char* unit, double to_unit, const auto& value, const auto& se) {
    figures.push_back({name, key, unit, to_unit, value(whole), value(half), se(whole), se(half)});
  };
  using M = LayerMeasurement;
  add("Sa after", "Sa", "µm", 1e6, [](const M& m) { return m.after.roughness.Sa; },
      [](const M& m) { return m.after.error ? std::optional(m.after.error->Sa) : std::nullopt; });
  add("layer thickness, mean", "thickness", "µm", 1e6, [](const M& m) { return m.thickness.mean; }, [](const M& m) { return m.thickness_se; });
  if (whole.after.packing.fraction && half.after.packing.fraction)
    add("packing fraction after", "packing_fraction", "1", 1, [](const M& m) { return *m.after.packing.fraction; }, [](const M& m) { return m.after.packing.se; });
  if (whole.load.used == 0 || half.load.used == 0) return figures;
  const auto component = [](const std::optional<Vec3>& v, int axis) { return v ? std::optional((*v)[axis]) : std::nullopt; };
  add("force along the travel", "force_x", "µN", 1e6, [](const M& m) { return m.load.force.x(); }, [&](const M& m) { return component(m.load.force_se, 0); });
  add("force upward", "force_z", "µN", 1e6, [](const M& m) { return m.load.force.z(); }, [&](const M& m) { return component(m.load.force_se, 2); });
  add("torque about y", "torque_y", "nN m", 1e9, [](const M& m) { return m.load.torque.y(); }, [&](const M& m) { return component(m.load.torque_se, 1); });
  return figures;
}

std::string with_error(double value, const std::optional<double>& se, double unit) {
  return se ? fmt::format("{:.4g} ± {:.2g}", value * unit, *se * unit) : fmt::format("{:.4g}", value * unit);
}

}  // namespace

std::optional<double> StepFigure::error() const {
  const double error = se && half_se ? std::hypot(*se, *half_se) : 0;
  return error > 0 && std::isfinite(value - half) ? std::optional(error) : std::nullopt;
}

std::optional<HalfStep> spread_with_half_step(const Spreading& spreading, const LayerMeasurement& whole, bool quiet) {
  const Prepared& p = spreading.prepared;
  const LayerSetup& setup = *p.scene.layer;
  SolverOptions solver = p.scene.solver;
  solver.time_step *= 0.5;
  std::vector<StepRecord> steps;
  ProgressDisplay display(quiet);
  RunHooks hooks;
  hooks.logged = [&](const StepRecord& step) { steps.push_back(step); };
  hooks.progress = [&](const Progress& progress) { display.show(progress); };
  const std::optional<RunReport> report = simulate_in_memory(p, solver, hooks, setup.spreader);
  if (!report) return {};
  const LayerMeasurement half = measure_layer(setup, p.model, p.model.initial, report->final_state, steps, spreading.path.lowest, spreading.path.from);
  return HalfStep{solver.time_step, report->wall_s, report->converged_fraction, figures_of(whole, half)};
}

json half_step_json(const HalfStep& half) {
  const auto known = [](const std::optional<double>& v) { return v ? json(*v) : json(nullptr); };
  json figures = json::object();
  for (const StepFigure& f : half.figures)
    figures[f.key] = {{"value", f.value}, {"se", known(f.se)}, {"half_step", f.half}, {"half_step_se", known(f.half_se)}, {"error_of_difference", known(f.error())}};
  return {{"time_step", half.time_step}, {"wall_s", half.wall_s}, {"converged_fraction", half.converged_fraction}, {"figures", figures}};
}

report::Table half_step_table(const HalfStep& half) {
  report::Table t;
  t.title = "With half the step";
  t.header = {"figure", "with the step", "with half of it", "unit", "standard errors apart", "difference that would show"};
  for (const StepFigure& f : half.figures) {
    const std::optional<double> error = f.error();
    t.rows.push_back({f.name, with_error(f.value, f.se, f.to_unit), with_error(f.half, f.half_se, f.to_unit), f.unit,
                      error ? fmt::format("{:.1f}", std::abs(f.value - f.half) / *error) : "not known",
                      error ? fmt::format("{:.2g}", apart_at_most * *error * f.to_unit) : "not known"});
  }
  t.notes = {half_step_in_words(half)};
  return t;
}

std::string half_step_in_words(const HalfStep& half) {
  std::vector<std::string> apart, alike, unknown;
  for (const StepFigure& f : half.figures) {
    const std::optional<double> error = f.error();
    if (!error)
      unknown.push_back(f.name);
    else if (std::abs(f.value - f.half) > apart_at_most * *error)
      apart.push_back(f.name);
    else
      alike.push_back(fmt::format("{} ({:.2g} {})", f.name, apart_at_most * *error * f.to_unit, f.unit));
  }
  std::string words;
  const auto say = [&](const std::string& what) { words += (words.empty() ? "" : "; ") + what; };
  if (!apart.empty()) say(fmt::format("not converged in the step: {}", fmt::join(apart, ", ")));
  if (!alike.empty()) say(fmt::format("no difference is seen, and one beyond what stands in brackets would have been, of {}", fmt::join(alike, ", ")));
  if (!unknown.empty()) say(fmt::format("nothing can be said of {}, whose error is not known: the run is short, or the region small", fmt::join(unknown, ", ")));
  return words + fmt::format(". Half the step is {:.3g} s; {:.1f} % of its steps converged.", half.time_step, 100 * half.converged_fraction);
}

}  // namespace repose
