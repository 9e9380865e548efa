#include <future>
#include <mutex>

#include "core/error.hpp"
#include "core/run.hpp"
#include "backends/backends.hpp"
#include "scenarios/bed.hpp"
#include "scenarios/experiment.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/layer_measurement.hpp"
#include "scenarios/spreading.hpp"

namespace repose {
namespace {

using nlohmann::json;

constexpr double um = 1e6;

/// A bed at the end of its settling, kept in memory for all layers that are spread over it.
struct SettledBed {
  Model model;
  Snapshot state;
  double wall_s = 0;
};

/// Runs what was prepared without frames; nullopt if it was interrupted.
std::optional<RunReport> simulated(const Prepared& p, RunHooks hooks, const std::string& tracked = "") {
  const std::unique_ptr<World> world = p.backend->make(p.model, p.scene.solver);
  hooks.interrupted = interrupted;
  const Schedule schedule{p.scene.solver.time_step, p.scene.duration, p.scene.frame_interval, 1e9, false, tracked};
  RunReport report = run(*world, p.model, schedule, nullptr, hooks);
  if (report.end == RunReport::End::interrupted) return std::nullopt;
  return report;
}

void tell_surface(json& o, const std::string& when, const BedSurface& s) {
  const std::pair<const char*, double> values[] = {
      {"Sa", s.roughness.Sa},       {"Sq", s.roughness.Sq},           {"Sz", s.roughness.Sz},     {"Ssk", s.roughness.Ssk},
      {"mean", s.heights.mean},     {"p0.1", s.heights.quantile.front()}, {"p99.9", s.heights.quantile.back()},
      {"packing", s.packing.fraction}, {"coverage", s.coverage},      {"sd_centres", s.centres.sd}, {"sd_tops", s.tops.sd}};
  for (const auto& [name, value] : values) o[name + ("_" + when)] = value;
}

json observables_of(const LayerMeasurement& m, const RunReport& report, const Model& model, const LayerSetup& setup,
                    const SpreaderPath& path, const SettledBed& bed) {
  json o;
  tell_surface(o, "before", m.before);
  tell_surface(o, "after", m.after);
  o["Sa_ratio"] = m.before.roughness.Sa > 0 ? json(m.after.roughness.Sa / m.before.roughness.Sa) : json(nullptr);
  o["Sa_error_within"] = m.after.error ? json(m.after.error->Sa) : json(nullptr);
  o["thickness"] = m.thickness.mean;
  o["layer_packing"] = m.layer_packing > 0 ? json(m.layer_packing) : json(nullptr);
  const bool loaded = m.load.converged > 0;
  o["force_along"] = loaded ? json(m.load.force.x()) : json(nullptr);
  o["force_up"] = loaded ? json(m.load.force.z()) : json(nullptr);
  o["torque"] = loaded ? json(m.load.torque.y()) : json(nullptr);
  o["force_largest"] = loaded ? json(m.load.largest) : json(nullptr);
  o["rise"] = loaded ? json(m.load.rise) : json(nullptr);
  o["spreader_above_surface"] = path.lowest - setup.plate - m.before.heights.mean;
  o["grains_moved_in"] = m.moved_in;
  o["grains_below_plate"] = m.lost;
  o["at_rest"] = bed_rests(model, report.final_state) ? 1 : 0;
  o["converged_fraction"] = report.converged_fraction;
  o["iterations_mean"] = report.iterations_mean;
  o["residual_max"] = report.residual_max;
  double diameters = 0;
  for (const Body& body : model.bodies) diameters += body.role == BodyRole::grain ? 2 * body.radius : 0;
  const double grains = static_cast<double>(model.grain_count());
  if (grains > 0) {
    o["contacts_per_grain"] = report.contacts_mean / grains;
    o["penetration_diameters"] = report.max_penetration / (diameters / grains);
  }
  o["wall_s"] = report.wall_s;
  o["bed_wall_s"] = bed.wall_s;
  return o;
}

class LayerExperiment : public Experiment {
 public:
  explicit LayerExperiment(const Options& options) : options_(options) {}

  std::string called() const override { return "layers"; }
  const std::vector<ToldObservable>& told() const override {
    static const std::vector<ToldObservable> list{{"Sa_after", "Sa after", "µm", um},
                                                  {"packing_after", "packing fraction after", ""},
                                                  {"thickness", "mean thickness of the layer", "µm", um},
                                                  {"Sa_before", "Sa before", "µm", um},
                                                  {"packing_before", "packing fraction before", ""}};
    return list;
  }
  std::string scatter_within() const override { return "Sa_error_within"; }
  std::map<std::string, ReferenceValue> measured() const override { return {}; }
  void check(const Scene& scene, const std::string& place) const override {
    demand_layer(scene, place);
    prepare(bed_scene(scene), options_);
  }
  std::optional<json> run(const Scene& scene, std::uint64_t seed) override;

 private:
  using BedInMemory = std::shared_ptr<const SettledBed>;
  /// Null if it was interrupted.
  BedInMemory bed_of(const Scene& scene, const Options& options);

  const Options options_;
  std::mutex mutex_;
  std::map<std::string, std::shared_future<BedInMemory>> beds_;  // by bed_key
};

LayerExperiment::BedInMemory LayerExperiment::bed_of(const Scene& scene, const Options& options) {
  Prepared prepared = prepare(bed_scene(scene), options);
  std::promise<BedInMemory> promise;
  std::shared_future<BedInMemory> future;
  bool mine = false;
  {
    const std::scoped_lock lock(mutex_);  // the key is made with HDF5, which one thread at a time may use
    auto [entry, added] = beds_.try_emplace(bed_key(prepared, options));
    if (added) entry->second = promise.get_future().share();
    future = entry->second;
    mine = added;
  }
  if (!mine) return future.get();
  try {
    RunHooks hooks;
    hooks.finished = [&](const Snapshot& state, const StepReport&) { return bed_rests(prepared.model, state); };
    const std::optional<RunReport> report = simulated(prepared, hooks);
    BedInMemory bed;
    if (report) bed = std::make_shared<SettledBed>(SettledBed{std::move(prepared.model), report->final_state, report->wall_s});
    promise.set_value(std::move(bed));
  } catch (...) {
    promise.set_exception(std::current_exception());
  }
  return future.get();
}

std::optional<json> LayerExperiment::run(const Scene& scene, std::uint64_t seed) {
  Options options = options_;
  options.seed = seed;
  const BedInMemory bed = bed_of(scene, options);
  if (!bed) return std::nullopt;
  const Spreading spreading = over_the_bed(scene, bed->model, bed->state, options);
  const Prepared& p = spreading.prepared;
  const LayerSetup& setup = *scene.layer;
  std::vector<StepRecord> steps;
  RunHooks hooks;
  hooks.logged = [&](const StepRecord& step) { steps.push_back(step); };
  const std::optional<RunReport> report = simulated(p, hooks, setup.spreader);
  if (!report) return std::nullopt;
  const LayerMeasurement layer =
      measure_layer(setup, p.model, p.model.initial, report->final_state, steps, spreading.path.lowest, spreading.path.from);
  return observables_of(layer, *report, p.model, setup, spreading.path, *bed);
}

}  // namespace

std::unique_ptr<Experiment> layer_experiment(const Options& options) { return std::make_unique<LayerExperiment>(options); }

}  // namespace repose
