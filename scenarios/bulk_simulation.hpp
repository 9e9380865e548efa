#pragma once
/// Simulations of many grains for a diagnosis: batches side by side, each result kept in a file of its own.
#include <filesystem>
#include <functional>

#include "analysis/diagnosis/bulk_model.hpp"
#include "backends/backends.hpp"
#include "scenarios/jobs.hpp"

namespace repose {

struct BulkSimulation {
  std::filesystem::path folder;       ///< results go to FOLDER/jobs, by a checksum of scene, seed, backend and build
  int workers = 1;
  bool allow_unsupported = false;
  std::function<void(const std::string& stage, const JobsProgress&)> progress;
};

/// Takes out of the bundle what a simulation cannot show beside it (unknown names, surfaces of scenes without a `layer` block, the angle in a drum that does not turn), with a warning
/// for each. Surfaces that were recorded over another region or in other cells than the scene's `layer` block says stay, with a warning.
Bundle only_simulated(Bundle bundle);

/// Shows angle_of_repose (if the heap has one), heap and discharged_mass of every scene with a base and a funnel; both surfaces and the loads on the
/// spreader of every scene with a `layer` block, whose bed is settled anew each time; and the other series that the bundle's first run has. Heaps
/// are simulated until they rest. `backend` and `bundle` must outlive the result.
diagnosis::SimulateBulk simulate_bulk_with(const Backend& backend, const Bundle& bundle, BulkSimulation how);

}  // namespace repose
