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

/// The bed ready to settle; its findings name the keys of `layer`, and are not told.
Prepared prepare_bed(const Scene& scene, const Options& options);

/// The keys that stand for those of bed_scene and of spreading_scene.
KeyNames keys_of_bed();
KeyNames keys_of_spreading();

/// The spreading scene before its bed is known: the spreader travels high above all. Throws Error if it arrives before it starts.
Scene spreading_above_all(const Scene& scene);

/// Before a bed has settled for hours: throws Error for a spreading scene that would be refused wherever its spreader begins, and gives what is
/// doubtful in it.
std::vector<Finding> check_spreading(const Scene& scene, const Options& options);

/// Tells no findings; they are in the result. `bed`: the model of bed_scene(scene), and `settled` its state at rest; a bare plate is a bed too. Throws
/// Error if neither a grain nor the plate is somewhere under the region, and what spreader_path and prepare throw.
Spreading over_the_bed(const Scene& scene, const Model& bed, const Snapshot& settled, const Options& options);

}  // namespace repose
