#pragma once
/// The settled bed of a layer scene, kept so that other spreader settings can use it.
#include <filesystem>
#include <optional>

#include "scenarios/simulate.hpp"

namespace repose {

struct Bed {
  Snapshot state;          ///< of the bed scene's model, in double
  bool reused = false;     ///< it was there already
  bool at_rest = false;    ///< see bed_rests; else the time that `settle` gives ran out
  double time = 0;         ///< simulated [s]
  double wall_s = 0;       ///< that making it took, then [s]
  double speed_rms = 0;    ///< of the grains, in sqrt(g d)
  double converged_contacts = 1;  ///< see RunReport: steps in mid-air, where few grains touch, say little of the packing
  double residual_max = 0;
  std::filesystem::path folder;
};

/// Root mean square speed of the grains in sqrt(g d), d their mean diameter; 0 without gravity. Those below `plate` [m] have fallen off it and do not count.
double speed_of_grains(const Model& model, const Snapshot& state, double plate);

/// At rest: that speed is below 0.01.
bool grains_rest(const Model& model, const Snapshot& state, double plate);

/// Of grains that were let go at time 0: at rest, and 5 sqrt(d/g) have passed. Before, those that hang in the air have not gained speed.
bool bed_rests(const Model& model, const Snapshot& state, double plate);

/// What a bed depends on, as a file name: the model without the spreader (grains, shapes, laws, tools, effects), solver, times, the height of the
/// plate (see bed_rests), backend and the build. Threads do not count, nor what the spreader is made of.
std::string bed_key(const Prepared& bed, const Options& options);

/// Takes the bed from `folder`/KEY, or makes it there (frames, checkpoints and bed.h5, which is written last). nullopt if it was interrupted: a run with --resume goes on.
std::optional<Bed> make_bed(const Prepared& bed, const Options& options, const std::filesystem::path& folder);

}  // namespace repose
