#pragma once
/// Where the spreader of a layer scene starts and how it moves.
#include "core/scene.hpp"

namespace repose {

/// The scene as the bed settles in it: without rollers and blades and the materials and laws that only they have, for the time and with the step
/// that `layer` gives. So a bed serves all spreaders, whatever they are made of.
Scene bed_scene(const Scene& scene);

/// The way of the spreader.
struct SpreaderPath {
  double lowest = 0;    ///< world z of its lowest line [m]
  double from = 0;      ///< x of its lowest line at the start [m]
  double duration = 0;  ///< of the travel [s]
};

/// `model`: of bed_scene(scene). `surface`: mean height of the settled surface above the plate [m]. The start is where the scene says, or else as near to
/// the powder of `model` in `settled` as the spreader can stand, moving along +x, without touching a grain (grains taken as their
/// bounding balls, plus a hundredth of a mean diameter). Throws Error if a given start is inside the powder, or the spreader
/// would cut into another tool or a fixed body on its way.
SpreaderPath spreader_path(const Scene& scene, const Model& model, const Snapshot& settled, double surface);

/// The scene in which the spreader travels along the path, and the time after it. Other rollers and blades are left out.
Scene spreading_scene(const Scene& scene, const SpreaderPath& path);

/// The tool that spreads.
const Tool& spreader_of(const Scene& scene);

}  // namespace repose
