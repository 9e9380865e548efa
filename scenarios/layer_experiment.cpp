#include <fmt/core.h>

#include <mutex>

#include "core/error.hpp"
#include "scenarios/experiment.hpp"
#include "scenarios/layer_run.hpp"

namespace repose {
namespace {

using nlohmann::json;

constexpr double um = 1e6;

void tell_surface(json& o, const std::string& when, const BedSurface& s) {
  const std::pair<const char*, std::optional<double>> values[] = {
      {"Sa", s.roughness.Sa},       {"Sq", s.roughness.Sq},           {"Sz", s.roughness.Sz},     {"Ssk", s.roughness.Ssk},
      {"mean", s.heights.mean},     {"p0.1", s.heights.quantile.front()}, {"p99.9", s.heights.quantile.back()},
      {"packing", s.packing.fraction}, {"coverage", s.coverage}};
  for (const auto& [name, value] : values) o[name + ("_" + when)] = value ? json(*value) : json(nullptr);
  for (const SquareFigures& squares : s.squares) {
    const std::string size = &squares == &s.squares.front() ? "" : fmt::format("_{:g}um", squares.square * um);
    for (const auto& [of, f] : {std::pair{"centres", &squares.centres}, {"tops", &squares.tops}}) {
      const auto told = [&](const char* name, auto&& value) { o[std::string(name) + "_" + of + size + "_" + when] = f->n > 0 ? json(value()) : json(nullptr); };
      told("sd", [&] { return f->sd; });
      told("min", [&] { return f->min; });
      told("p0.1", [&] { return f->quantile.front(); });
      told("p99.9", [&] { return f->quantile.back(); });
      told("max", [&] { return f->max; });
    }
  }
}

json observables_of(const SpreadLayer& layer, const LayerSetup& setup) {
  const LayerMeasurement& m = layer.measured;
  const RunReport& report = layer.report;
  const Model& model = layer.spreading.prepared.model;
  json o;
  tell_surface(o, "before", m.before);
  tell_surface(o, "after", m.after);
  o["Sa_ratio"] = m.before.roughness.Sa > 0 ? json(m.after.roughness.Sa / m.before.roughness.Sa) : json(nullptr);
  o["Sa_error_within"] = m.after.error ? json(m.after.error->Sa) : json(nullptr);
  o["thickness"] = m.thickness.mean;
  o["solid_per_area"] = m.solid_per_area;
  const bool loaded = m.load.used > 0;
  o["force_along"] = loaded ? json(m.load.force.x()) : json(nullptr);
  o["force_up"] = loaded ? json(m.load.force.z()) : json(nullptr);
  o["torque"] = loaded ? json(m.load.torque.y()) : json(nullptr);
  o["force_largest"] = loaded ? json(m.load.largest) : json(nullptr);
  o["rise"] = loaded ? json(m.load.rise) : json(nullptr);
  o["spreader_above_surface"] = layer.spreading.path.lowest - setup.plate - m.before.heights.mean;
  o["grains_moved_in"] = m.moved_in;
  o["grains_below_plate"] = m.lost;
  o["at_rest"] = layer.bed->at_rest && m.at_rest ? 1 : 0;
  o["bed_converged_contacts"] = layer.bed->converged_contacts;
  o["converged_fraction"] = report.converged_fraction;
  o["iterations_mean"] = report.iterations_mean;
  o["residual_max"] = report.residual_max;
  const double grains = static_cast<double>(model.grain_count());
  if (grains > 0) {
    o["contacts_per_grain"] = report.contacts_mean / grains;
    o["penetration_diameters"] = report.max_penetration / mean_diameter(model);
  }
  o["wall_s"] = report.wall_s;
  o["bed_wall_s"] = layer.bed->wall_s;
  return o;
}

class LayerExperiment : public Experiment {
 public:
  explicit LayerExperiment(const Options& options) : options_(options), runs_(options, LayerRuns::Beds::kept) {}

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
    std::vector<Finding> findings = prepare_bed(scene, options_).findings;
    add_missing(check_spreading(scene, options_), findings);
    tell(findings);
  }
  std::optional<json> run(const Scene& scene, std::uint64_t seed) override;

 private:
  const Options options_;
  LayerRuns runs_;
  std::once_flag told_;
};

std::optional<json> LayerExperiment::run(const Scene& scene, std::uint64_t seed) {
  std::optional<SpreadLayer> layer;
  try {
    layer = runs_.run(scene, seed);
    if (layer) demand_converged(*layer);
  } catch (const Error& e) {
    // What check() let pass is wrong over this bed alone, such as a spreader that would cut into a wall: a point that failed, not the study.
    throw Error(e.place(), e.problem(), e.remedy(), Error::Kind::simulation);
  }
  if (!layer) return std::nullopt;
  std::call_once(told_, [&] { tell(layer->spreading.prepared.findings); });  // the points differ in little
  return observables_of(*layer, *scene.layer);
}

}  // namespace

std::unique_ptr<Experiment> layer_experiment(const Options& options) { return std::make_unique<LayerExperiment>(options); }

}  // namespace repose
