#pragma once
/// Heaps of grains that several tests share.
#include <string>
#include <vector>

#include "core/fill.hpp"
#include "core/grain_shape.hpp"
#include "tests/support/model_builder.hpp"

namespace repose::test {

/// Grains above the floor of a square box without lid (half-spaces), on a jittered lattice, at random orientations.
struct Pile {
  int count = 100;
  std::vector<std::string> kinds = {"sphere"};  ///< taken in turn
  PairLaw law;                                  ///< between grains
  PairLaw wall_law{.friction = 0.3};            ///< between grains and walls
  double diameter = 0.02;                       ///< of the sphere of equal volume [m]
  double spread = 0.2;                          ///< diameters lie in diameter * (1 +- spread)
  int across = 4;                               ///< lattice cells along each side of the box
  double fall = 0.3;                            ///< speed towards the floor at the start [m/s]
  unsigned seed = 1;
};

/// Bodies 0 to 4 are the floor and the walls at -x, +x, -y, +y; then the grains.
Model pile(const Pile& pile);

/// Touching equal spheres of `diameter` on a floor, on a cubic lattice of `across` x `across` x `layers`. Body 0 is the
/// floor.
Model lattice(int across, int layers, double diameter, const PairLaw& law);

/// Adds `count` equal spheres of `material` to `builder`, at rest and at random places of the region, none touching.
void rain(ModelBuilder& builder, const std::string& material, const FillRegion& region, int count, double diameter,
          unsigned seed);

/// A vertical tube around z between two heights, `thickness` thick, as one solid of revolution; with `outlet` > 0 it
/// has a floor of that thickness below `bottom`, with a round hole of diameter `outlet`.
Shape tube(double inner_radius, double bottom, double top, double thickness, double outlet = 0);

}  // namespace repose::test
