#pragma once
/// The grains of every population of a scene, drawn and placed.
#include <cstdint>
#include <vector>

#include "core/scene.hpp"

namespace repose {

struct PlacedGrain {
  int population = 0;  ///< index into Scene::grains
  int shape = 0;       ///< index into GrainSet::shapes
  double size = 0;     ///< diameter of the sphere of equal volume [m]: the scale of the shape
  Placement placement; ///< of the body frame
};

struct GrainSet {
  std::vector<Shape> shapes;        ///< of unit size, each needed by at least one population
  std::vector<PlacedGrain> grains;  ///< by population, in the order drawn
  double mean_size = 0;             ///< [m], 0 without grains
};

/// Draws and places all grains, without overlap between any two. Each population draws from a stream of its own, seeded by
/// its name: adding another one does not change it. Populations that name the same fill region are mixed in it. Throws
/// Error, naming the key, if grains do not fit, or if those of two different regions would overlap.
GrainSet make_grains(const Scene& scene, std::uint64_t seed);

}  // namespace repose
