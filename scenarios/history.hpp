#pragma once
/// Runs a scene on a backend and keeps what its bodies did: the function that analyses are handed.
#include <functional>
#include <memory>

#include "analysis/history.hpp"
#include "core/run.hpp"
#include "core/world.hpp"

namespace repose {

/// Simulates with `backend`, in memory. `interrupted` is polled every step; then Error (Kind::simulation) is thrown.
/// Throws Error (Kind::input) for physics that the backend lacks, unless `allow_unsupported`; always where the request names another backend.
Simulate simulate_with(const Backend& backend, bool allow_unsupported);

/// All but the own one that can be expected to solve so many grains: what a diagnosis may suspect of having made the recordings.
std::vector<std::string> backends_beside(const Backend& own, std::size_t grains = 0);

/// A drum with an angular velocity: what the series `surface_angle` needs.
bool has_turning_drum(const Scene& scene);

/// As above with the model and its final state: for measurements of a heap.
struct HistoryRun {
  Model model;
  History history;
  Snapshot final_state;
};
HistoryRun run_history(const Backend& backend, const SimulationRequest& request, bool allow_unsupported,
                       const std::function<void(const Progress&)>& progress = {});

}  // namespace repose
