#pragma once
/// One run of a comparison: everything that is measured on it, as JSON that can be kept and taken up again.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/motion_field.hpp"
#include "core/scene.hpp"

namespace repose {

/// What all runs of a comparison share, so that they can be laid beside each other. Times are those of the coarse step.
struct CompareFrames {
  double interval = 0;     ///< between frames [s], a whole number of time steps of every variant
  std::size_t count = 0;   ///< frames of the film, the start included; each `stride` frames apart
  std::size_t stride = 1;
};

/// The frames of a scene: the interval rounded to whole steps, at most 41 frames in the film.
CompareFrames compare_frames(const Scene& scene);

/// `grid`: the cells of the film, the same for every seed of a comparison although each makes its own grains; none without grains.
/// Runs a scene to its duration, or until its heap is at rest; nullopt if interrupted (Ctrl-C). Keys of the result:
///   observables {name: {value (null: could not be measured), unit, kind, scale}}; kind: "physics", what engines must agree
///     about; "quality", how well an engine did; "cost" (processor time with one thread only). `scale`: the magnitude that a relative tolerance refers to.
///   run {steps, wall_s, contacts_mean, iterations_mean, residual_max, converged_fraction, cycling_fraction, max_penetration, time}
///   curves {time, kinetic_energy, discharged_mass (with a funnel), radius and height (with a heap)}
///   film [cells * frames] (with grains); bodies {name: {x: [..], y: [..], z: [..]}} (dynamic bodies that are no grains, at the times)
/// After an early end the last state stands for the frames that remain.
std::optional<nlohmann::json> compare_run(const Backend& backend, const Scene& scene, std::uint64_t seed, const CompareFrames& frames,
                                          const std::optional<FieldGrid>& grid);

}  // namespace repose
