#include "scenarios/layer_run.hpp"

#include "backends/backends.hpp"
#include "core/run.hpp"
#include "scenarios/bed.hpp"
#include "scenarios/interrupt.hpp"

namespace repose {

std::optional<RunReport> simulate_in_memory(const Prepared& p, const SolverOptions& solver, RunHooks hooks, const std::string& tracked) {
  const std::unique_ptr<World> world = p.backend->make(p.model, solver);
  hooks.interrupted = interrupted;
  const Schedule schedule{solver.time_step, p.scene.duration, p.scene.frame_interval, 1e9, solver.integration == Integration::second_order, tracked};
  RunReport report = run(*world, p.model, schedule, nullptr, hooks);
  if (report.end == RunReport::End::interrupted) return std::nullopt;
  return report;
}

LayerRuns::BedInMemory LayerRuns::bed_of(const Scene& scene, const Options& options) {
  Prepared prepared = prepare_bed(scene, options);
  const std::string key = bed_key(prepared, options);
  std::promise<BedInMemory> promise;
  std::shared_future<BedInMemory> future;
  bool mine = false;
  {
    const std::scoped_lock lock(mutex_);
    auto [entry, added] = beds_.try_emplace(key);
    if (added) entry->second = promise.get_future().share();
    future = entry->second;
    mine = added;
  }
  if (!mine) return future.get();
  try {
    RunHooks hooks;
    hooks.finished = [&](const Snapshot& state, const StepReport&) { return bed_rests(prepared.model, state, scene.layer->plate); };
    const std::optional<RunReport> report = simulate_in_memory(prepared, prepared.scene.solver, hooks);
    BedInMemory bed;
    if (report) {
      const bool rests = bed_rests(prepared.model, report->final_state, scene.layer->plate);
      bed = std::make_shared<SettledBed>(
          SettledBed{std::move(prepared.model), report->final_state, report->wall_s, report->converged_contacts, report->residual_max, rests});
    }
    promise.set_value(std::move(bed));
  } catch (...) {
    promise.set_exception(std::current_exception());
  }
  if (!keep_) {
    const std::scoped_lock lock(mutex_);
    beds_.erase(key);
  }
  return future.get();
}

std::optional<SpreadLayer> LayerRuns::run(const Scene& scene, std::uint64_t seed) {
  demand_layer(scene, "");
  Options options = options_;
  options.seed = seed;
  SpreadLayer layer;
  layer.bed = bed_of(scene, options);
  if (!layer.bed) return std::nullopt;
  layer.spreading = over_the_bed(scene, layer.bed->model, layer.bed->state, options);
  const Prepared& p = layer.spreading.prepared;
  RunHooks hooks;
  hooks.logged = [&](const StepRecord& step) { layer.steps.push_back(step); };
  std::optional<RunReport> report = simulate_in_memory(p, p.scene.solver, hooks, scene.layer->spreader);
  if (!report) return std::nullopt;
  layer.report = *std::move(report);
  const SpreaderPath& path = layer.spreading.path;
  layer.measured = measure_layer(*scene.layer, p.model, p.model.initial, layer.report.final_state, layer.steps, path.lowest, path.from);
  return layer;
}

bool SpreadLayer::converged() const { return bed->converged_contacts >= least_converged && report.converged_fraction >= least_converged; }

void demand_converged(const SpreadLayer& layer) {
  demand_converged(layer.bed->converged_contacts, layer.bed->residual_max, "the contacts of the settling bed",
                   "make layer.settle_time_step smaller or solver.max_iterations larger");
  demand_converged(layer.report.converged_fraction, layer.report.residual_max, "the steps of the spreading",
                   "make solver.time_step smaller or solver.max_iterations larger");
}

}  // namespace repose
