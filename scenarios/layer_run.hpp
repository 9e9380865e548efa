#pragma once
/// Layers in memory, from the scene to the measurement: for studies and diagnoses, which spread many. `repose layer` is the one that keeps
/// frames and beds on disk.
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/layer_measurement.hpp"
#include "scenarios/spreading.hpp"

namespace repose {

/// A bed at the end of its settling.
struct SettledBed {
  Model model;
  Snapshot state;
  double wall_s = 0;
  double converged_contacts = 1, residual_max = 0;
  bool at_rest = false;  ///< else the time that `settle` gives ran out
};

struct SpreadLayer {
  std::shared_ptr<const SettledBed> bed;
  Spreading spreading;
  RunReport report;               ///< of the spreading
  std::vector<StepRecord> steps;  ///< of the spreading, with the loads on the spreader
  LayerMeasurement measured;
  bool converged() const;         ///< at least 95 % of the contacts of the bed and of the steps of the spreading
};

/// Throws Error (Kind::simulation) that says what did not converge.
void demand_converged(const SpreadLayer& layer);

/// Runs what was prepared, solved with these options, without frames on disk; nullopt if it was interrupted. `tracked`: see Schedule.
std::optional<RunReport> simulate_in_memory(const Prepared& prepared, const SolverOptions& solver, RunHooks hooks, const std::string& tracked = "");

class LayerRuns {
 public:
  enum class Beds {
    kept,     ///< scenes that differ in the spreader alone share the bed of each seed
    dropped,  ///< for runs that all have other grains or laws
  };

  /// Backend, threads and what is allowed are those of `options`.
  LayerRuns(const Options& options, Beds beds) : options_(options), keep_(beds == Beds::kept) {}

  /// nullopt if it was interrupted. May be called from several threads at once. Throws Error if the scene has no `layer` block, and what the run
  /// throws.
  std::optional<SpreadLayer> run(const Scene& scene, std::uint64_t seed);

 private:
  using BedInMemory = std::shared_ptr<const SettledBed>;
  /// Null if it was interrupted.
  BedInMemory bed_of(const Scene& scene, const Options& options);

  const Options options_;
  const bool keep_;
  std::mutex mutex_;
  std::map<std::string, std::shared_future<BedInMemory>> beds_;  // by bed_key
};

}  // namespace repose
