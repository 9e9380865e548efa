#include "scenarios/bulk_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "analysis/heap_measurement.hpp"
#include "core/error.hpp"
#include "scenarios/history.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/layer_observations.hpp"
#include "scenarios/record_block.hpp"
#include "scenarios/version.hpp"

namespace repose {
namespace {

using nlohmann::json;

const std::set<std::string>& simulated_series() {
  static const std::set<std::string> names{"discharged_mass", "mass_on_base", "roller_force_x", "roller_force_z", "roller_torque", "surface_angle"};
  return names;
}

bool can_be_simulated(const Scene& scene, const Observation& o) {
  if (scene.layer) return told_of_a_layer(o);
  if (o.name == "surface_angle" && !has_turning_drum(scene)) return false;
  return (o.kind == ObservableKind::scalar && o.name == "angle_of_repose") || (o.kind == ObservableKind::profile && o.name == "heap") ||
         (o.kind == ObservableKind::series && simulated_series().contains(o.name));
}

/// Along one axis of a surface's grid.
struct Extent {
  double from = 0, to = 0, cell = 0;  ///< cell 0: a single row
};

Extent extent_of(std::vector<double> at) {
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  if (at.empty()) return {};
  return {at.front(), at.back(), at.size() > 1 ? (at.back() - at.front()) / static_cast<double>(at.size() - 1) : 0};
}

/// Mean and scatter of heights are those of a region and of a cell: finer cells see into the gaps between grains. Simulations measure as `layer` says.
std::string doubt_of(const Observation& o, const LayerSetup& layer) {
  constexpr double alike = 0.05;
  const Extent x = extent_of(o.at), y = extent_of(o.at_y);
  const double lower[] = {layer.lower.x(), layer.lower.y()}, upper[] = {layer.upper.x(), layer.upper.y()};
  bool same_cell = true, same_region = true;
  for (const int k : {0, 1}) {
    const Extent& e = k == 0 ? x : y;
    const double size = std::max(layer.cell, e.cell);
    same_cell = same_cell && (e.cell == 0 || std::abs(e.cell - layer.cell) <= alike * layer.cell);
    same_region = same_region && std::abs(e.from - lower[k]) <= size && std::abs(e.to - upper[k]) <= size;
  }
  if (same_cell && same_region) return {};
  return fmt::format("`{}` was recorded over x {:.4g} to {:.4g} m, y {:.4g} to {:.4g} m in cells of {:.3g} m, and simulations measure x {:.4g} to {:.4g} m, y {:.4g} to {:.4g} m in cells of {:.3g} m: "
                     "roughness and mean height depend on both. Set `layer.region` and `layer.surface.cell` as recorded.",
                     o.name, x.from, x.to, y.from, y.to, std::max(x.cell, y.cell), lower[0], upper[0], lower[1], upper[1], layer.cell);
}

/// Once for each name. Runs that measure otherwise by their own settings are let pass.
void doubt_surfaces(Bundle& bundle) {
  std::set<std::string> told;
  for (const BundleRun& run : bundle.runs) {
    if (std::any_of(run.set.begin(), run.set.end(), [](const Override& change) { return change.path.starts_with("layer"); })) continue;
    for (const Observation& o : run.observations) {
      if (o.kind != ObservableKind::surface || told.contains(o.name)) continue;
      const std::string doubt = doubt_of(o, *bundle.scene.layer);
      if (doubt.empty()) continue;
      told.insert(o.name);
      bundle.warnings.push_back(doubt);
    }
  }
}

constexpr std::size_t most_places = 5000;  // of a surface that is kept: its mean and its scatter need no more

/// Everything that such a run can show.
struct Shown {
  std::vector<std::string> series;
  std::vector<std::string> units;
  bool heap = false;
};

Shown shown_of(const Bundle& bundle) {
  Shown shown;
  shown.heap = heap_site(bundle.scene).has_value();
  const auto add = [&](const std::string& name, const std::string& unit) {
    if (std::find(shown.series.begin(), shown.series.end(), name) != shown.series.end()) return;
    shown.series.push_back(name);
    shown.units.push_back(unit);
  };
  for (const Observation& o : bundle.runs.front().observations)
    if (o.kind == ObservableKind::series && simulated_series().contains(o.name)) add(o.name, o.unit);
  if (funnel_outlet(bundle.scene)) add("discharged_mass", "kg");
  return shown;
}

json simulate_one(const Backend& backend, const Scene& scene, std::uint64_t seed, const Shown& shown, bool allow_unsupported) {
  SimulationRequest request;
  request.scene = &scene;
  request.seed = seed;
  request.series = shown.series;
  request.until_rest = shown.heap && std::none_of(shown.series.begin(), shown.series.end(), [](const std::string& name) { return name.starts_with("roller_"); });
  const HistoryRun run = run_history(backend, request, allow_unsupported);
  json result;
  for (std::size_t i = 0; i < shown.series.size(); ++i)
    result["series"].push_back({{"name", shown.series[i]}, {"unit", shown.units[i]}, {"value", run.history.series.at(shown.series[i])}});
  result["time"] = run.history.time;
  result["converged"] = run.history.converged;
  if (shown.heap) {
    const HeapMeasurement heap = measure_heap(scene, run.model, run.final_state, nullptr, {});
    result["heap"] = {{"radius", heap.repose.profile.radius}, {"height", heap.repose.profile.height}};
    if (heap.repose.angle) result["angle_of_repose"] = heap.repose.angle->value;
  }
  return result;
}

/// nullopt if it was interrupted.
std::optional<json> spread_one(LayerRuns& layers, const Scene& scene, std::uint64_t seed) {
  const std::optional<SpreadLayer> layer = layers.run(scene, seed);
  if (!layer) return std::nullopt;
  demand_converged(*layer);
  json result;
  const History loads = loads_on_spreader(*layer);
  for (const auto& [name, values] : loads.series) result["series"].push_back({{"name", name}, {"unit", unit_of_load(name)}, {"value", values}});
  result["time"] = loads.time;
  result["converged"] = loads.converged;
  for (const char* name : {"layer_before", "layer_after"}) {
    const Observation surface = surface_of(*layer, name, most_places);
    result["surfaces"].push_back({{"name", name}, {"x", surface.at}, {"y", surface.at_y}, {"height", surface.value}});
  }
  return result;
}

std::vector<double> with_holes(const json& values) {
  std::vector<double> result;
  for (const json& v : values) result.push_back(v.is_null() ? std::numeric_limits<double>::quiet_NaN() : v.get<double>());
  return result;
}

diagnosis::BulkOutcome outcome_of(const json& result) {
  diagnosis::BulkOutcome outcome;
  Observation angle;
  angle.kind = ObservableKind::scalar;
  angle.name = "angle_of_repose";
  angle.unit = "deg";
  angle.scalar = result.contains("angle_of_repose") ? result["angle_of_repose"].get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (result.contains("heap")) {
    outcome.observations.push_back(angle);
    Observation profile;
    profile.kind = ObservableKind::profile;
    profile.name = "heap";
    profile.at = result["heap"]["radius"].get<std::vector<double>>();
    profile.value = result["heap"]["height"].get<std::vector<double>>();
    outcome.observations.push_back(std::move(profile));
  }
  for (const json& s : result.value("series", json::array())) {
    Observation series;
    series.kind = ObservableKind::series;
    series.name = s["name"].get<std::string>();
    series.unit = s["unit"].get<std::string>();
    series.time = result["time"].get<std::vector<double>>();
    series.value = s["value"].get<std::vector<double>>();
    outcome.observations.push_back(std::move(series));
  }
  for (const json& s : result.value("surfaces", json::array())) {
    Observation surface;
    surface.kind = ObservableKind::surface;
    surface.name = s["name"].get<std::string>();
    surface.at = s["x"].get<std::vector<double>>();
    surface.at_y = s["y"].get<std::vector<double>>();
    surface.value = with_holes(s["height"]);
    outcome.observations.push_back(std::move(surface));
  }
  if (!result.value("converged", true)) outcome.failure = "fewer than 95 % of the steps converged";
  return outcome;
}

}  // namespace

Bundle only_simulated(Bundle bundle) {
  std::set<std::string> out;
  for (BundleRun& run : bundle.runs)
    std::erase_if(run.observations, [&](const Observation& o) {
      const bool shown = can_be_simulated(bundle.scene, o);
      if (!shown) out.insert(o.name);
      return !shown;
    });
  for (const std::string& name : out)
    bundle.warnings.push_back(fmt::format("`{}` is left out: no simulation of many grains shows it yet", name));
  if (std::any_of(bundle.runs.begin(), bundle.runs.end(), [](const BundleRun& run) { return run.observations.empty(); }))
    throw Error("runs", "a run has nothing that a simulation of many grains shows", "those that are: angle_of_repose, heap, discharged_mass, mass_on_base, surface_angle, roller_force_*; layer_before and layer_after of a scene with a `layer` block");
  if (bundle.scene.layer) doubt_surfaces(bundle);
  return bundle;
}

diagnosis::SimulateBulk simulate_bulk_with(const Backend& backend, const Bundle& bundle, BulkSimulation how) {
  const Shown shown = shown_of(bundle);
  return [&backend, &bundle, how = std::move(how), shown](const std::string& stage,
                                                          const std::vector<diagnosis::BulkRequest>& requests) -> std::optional<std::vector<diagnosis::BulkOutcome>> {
    const std::string build = fmt::format("{} {} {}", version(), commit(), fmt::join(shown.series, " "));
    const auto engine_of = [&](const diagnosis::BulkRequest& request) -> const Backend& { return request.backend.empty() ? backend : find_backend(request.backend); };
    std::vector<Job> jobs;
    for (std::size_t i = 0; i < requests.size(); ++i) jobs.push_back({i, requests[i].seed, job_key(requests[i].scene, requests[i].seed, engine_of(requests[i]).name, build)});
    JobsHooks hooks;
    hooks.interrupted = interrupted;
    hooks.progress = [&](const JobsProgress& p) {
      if (how.progress) how.progress(stage, p);
    };
    std::map<std::string, LayerRuns> layers;
    for (const diagnosis::BulkRequest& request : requests) {
      Options options;
      options.backend = engine_of(request).name;
      options.allow_unsupported = how.allow_unsupported && request.backend.empty();  // an engine that leaves out physics would only seem to explain
      options.force = true;  // a value that is tried may be absurd
      layers.try_emplace(options.backend, options, LayerRuns::Beds::dropped);
    }
    const auto simulate = [&](const Job& job) -> std::optional<json> {
      try {
        Scene scene = parse_scene(requests[job.scene].scene, bundle.scene_file.string(), {}, bundle.scene_file.parent_path());
        scene.solver.threads = 1;
        const Backend& engine = engine_of(requests[job.scene]);
        return scene.layer ? spread_one(layers.at(engine.name), scene, job.seed) : simulate_one(engine, scene, job.seed, shown, how.allow_unsupported && requests[job.scene].backend.empty());
      } catch (const Error& e) {
        if (interrupted()) return std::nullopt;
        // A scene that cannot be built or run with a tried value is a point that failed, not bad input. Of the nominal scene it is told as such.
        throw Error(e.place(), e.problem(), e.remedy(), Error::Kind::simulation);
      }
    };
    const JobsReport report = run_jobs(jobs, how.folder, how.workers, simulate, hooks);
    std::vector<diagnosis::BulkOutcome> outcomes;
    for (const auto& result : report.results) {
      if (!result) return std::nullopt;
      outcomes.push_back(result->failure.empty() ? outcome_of(result->observables) : diagnosis::BulkOutcome{{}, result->failure});
    }
    return outcomes;
  };
}

}  // namespace repose
