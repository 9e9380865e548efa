#include "analysis/heap_measurement.hpp"
#include "backends/backends.hpp"
#include "core/error.hpp"
#include "core/run.hpp"
#include "scenarios/experiment.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/reference_file.hpp"
#include "scenarios/simulate.hpp"

namespace repose {
namespace {

using nlohmann::json;

json observables_of(const Model& model, const RunReport& run, const HeapMeasurement& heap) {
  const HeapGrains& grains = heap.repose.grains;
  const double count = static_cast<double>(model.grain_count());
  json o = {{"grains_on_base", grains.heap.size()},
            {"heap_mass", grains.heap_mass},
            {"coverage", heap.repose.profile.coverage},
            {"at_rest", heap.rest.at_rest ? 1 : 0},
            {"time_at_end", run.final_state.time},
            {"converged_fraction", run.converged_fraction},
            {"cycling_fraction", run.cycling_fraction},
            {"iterations_mean", run.iterations_mean},
            {"residual_max", run.residual_max},
            {"contacts_per_grain", count > 0 ? run.contacts_mean / count : 0},
            {"penetration_diameters", grains.diameter > 0 ? run.max_penetration / grains.diameter : 0},
            {"wall_s", run.wall_s}};
  const auto optional = [&](const char* name, bool there, double value) { o[name] = there ? json(value) : json(nullptr); };
  const ReposeAngle angle = heap.repose.angle.value_or(ReposeAngle{});
  const bool has_angle = heap.repose.angle.has_value();
  optional("angle_of_repose", has_angle, angle.value);
  optional("sd_azimuth", has_angle, angle.sd);
  optional("angle_radial", has_angle, angle.radial);
  optional("angle_whole_depth", has_angle, angle.whole_depth);
  optional("concavity", has_angle, angle.concavity);
  optional("apex_diameters", has_angle && grains.diameter > 0, angle.apex / grains.diameter);
  optional("solid_fraction", heap.solid.has_value(), heap.solid ? heap.solid->value : 0);
  optional("discharge_rate", heap.rate.has_value(), heap.rate ? heap.rate->rate : 0);
  optional("discharge_over_beverloo", heap.rate && heap.beverloo && *heap.beverloo > 0,
           heap.rate && heap.beverloo ? heap.rate->rate / *heap.beverloo : 0);
  return o;
}

class HeapExperiment : public Experiment {
 public:
  explicit HeapExperiment(const Options& options) : options_(options), backend_(find_backend(options.backend)) {}

  std::string called() const override { return "heaps"; }
  const std::vector<ToldObservable>& told() const override {
    static const std::vector<ToldObservable> list{{"angle_of_repose", "angle of repose", "°"},
                                                  {"solid_fraction", "solid fraction", ""},
                                                  {"grains_on_base", "grains on the base", ""}};
    return list;
  }
  std::string scatter_within() const override { return "sd_azimuth"; }
  std::map<std::string, ReferenceValue> measured() const override {
    std::map<std::string, ReferenceValue> values;
    for (const auto& [name, file] : {std::pair{"angle_of_repose", "pa650/table1.yaml"}, {"solid_fraction", "pa650/powder.yaml"}})
      if (const auto value = load_reference(reference_file(file)).single(name)) values[name] = *value;
    return values;
  }
  void check(const Scene& scene, const std::string& place) const override {
    prepare(scene, options_);
    if (!heap_site(scene)) throw Error(place + ": tools", "the scene has no base to measure a heap on", "add a tool of kind base");
  }
  std::optional<json> run(const Scene& scene, std::uint64_t seed) override;

 private:
  const Options options_;
  const Backend& backend_;
};

std::optional<json> HeapExperiment::run(const Scene& scene, std::uint64_t seed) {
  const Model model = realise(scene, seed);
  const std::unique_ptr<World> world = backend_.make(model, scene.solver);
  const std::optional<HeapSite> site = heap_site(scene);
  const std::optional<Outlet> outlet = funnel_outlet(scene);
  DischargeCurve discharge;
  if (outlet) discharge.add(model, model.initial, *outlet);
  Snapshot before = model.initial, latest = model.initial;
  RunHooks hooks;
  hooks.interrupted = interrupted;
  hooks.finished = [&](const Snapshot& state, const StepReport&) {
    if (outlet) discharge.add(model, state, *outlet);
    before = std::exchange(latest, state);
    return assess_rest(model, state, *site, outlet).at_rest;
  };
  const Schedule schedule{scene.solver.time_step, scene.duration, scene.frame_interval, 1e9};
  const RunReport report = repose::run(*world, model, schedule, nullptr, hooks);
  if (report.end == RunReport::End::interrupted) return std::nullopt;
  demand_converged(report.converged_fraction, report.residual_max, "the steps", "make solver.time_step smaller or solver.max_iterations larger");
  return observables_of(model, report, measure_heap(scene, model, report.final_state, &before, std::move(discharge)));
}

}  // namespace

std::unique_ptr<Experiment> heap_experiment(const Options& options) { return std::make_unique<HeapExperiment>(options); }

}  // namespace repose
