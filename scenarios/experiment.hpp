#pragma once
/// What a study does at each of its points: one simulated experiment, and the observables that it tells of it.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "analysis/reference.hpp"
#include "core/scene.hpp"
#include "scenarios/command_line.hpp"

namespace repose {

/// An observable as a report tells it: its value in SI units times `factor` is in `unit`.
struct ToldObservable {
  std::string name;          ///< of the observable in study.json
  std::string label, unit;   ///< unit may be empty
  double factor = 1;
};

class Experiment {
 public:
  virtual ~Experiment() = default;

  /// In words, plural: "heaps".
  virtual std::string called() const = 0;
  /// What tables and charts show. The first is the principal one, whose slopes are told.
  virtual const std::vector<ToldObservable>& told() const = 0;
  /// Name of the observable that is the scatter of the principal one within a run; empty if there is none.
  virtual std::string scatter_within() const = 0;
  /// Measured values of the same powder, by name of the observable.
  virtual std::map<std::string, ReferenceValue> measured() const = 0;
  /// Throws Error if the scene lacks what is to be measured, or what `repose check` would refuse. `place`: names the scene.
  virtual void check(const Scene& scene, const std::string& place) const = 0;
  /// Simulates it: one number per observable, null for what could not be measured; nullopt if it was interrupted. May be
  /// called from several threads at once.
  virtual std::optional<nlohmann::json> run(const Scene& scene, std::uint64_t seed) = 0;
};

/// Heaps poured on a base: their angle of repose, rate of discharge and packing.
std::unique_ptr<Experiment> heap_experiment(const Options& options);

/// Layers spread over a bed: roughness and packing. Points whose scenes differ in the spreader alone share the bed of each seed.
std::unique_ptr<Experiment> layer_experiment(const Options& options);

}  // namespace repose
