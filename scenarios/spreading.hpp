#pragma once
/// The spreader ready over its settled bed.
#include "scenarios/simulate.hpp"
#include "scenarios/spreader.hpp"

namespace repose {

struct Spreading {
  SpreaderPath path;
  Prepared prepared;  ///< the spreading scene; its model starts as the bed settled
};

/// Throws Error if the scene has no `layer` block. `place`: names the scene; may be empty.
void demand_layer(const Scene& scene, const std::string& place);

/// Before a bed has settled for hours: throws Error for a spreading scene that would be refused wherever its spreader begins.
void check_spreading(const Scene& scene, const Options& options);

/// Tells no findings; they are in the result. `bed`: the model of bed_scene(scene), and `settled` its state at rest. Throws Error if no
/// grain lies over the region, and what spreader_path and prepare throw.
Spreading over_the_bed(const Scene& scene, const Model& bed, const Snapshot& settled, const Options& options);

}  // namespace repose
