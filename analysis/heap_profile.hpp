#pragma once
/// The heap on its base: which grains belong to it, how high its surface stands, and its mean radial profile.
#include <optional>
#include <vector>

#include "core/model.hpp"
#include "core/scene.hpp"

namespace repose {

/// The plate that the heap stands on, its axis vertical.
struct HeapSite {
  Vec3 centre = Vec3::Zero();  ///< of the plate's top face [m]
  double radius = 0;           ///< inside the rim [m], > 0
  double rim_height = 0;       ///< above the plate [m], >= 0
};

/// The scene's base tool; nullopt if it has none. The first by name if it has several.
std::optional<HeapSite> heap_site(const Scene& scene);

/// Where each grain is.
struct HeapGrains {
  std::vector<int> heap;      ///< bodies that rest on the plate, directly or through others, centre inside the rim
  std::vector<int> loose;     ///< over the plate but not part of the heap: falling, or in the funnel
  std::vector<int> rim;       ///< beyond the inner edge of the rim and not below the plate
  std::vector<int> trench;    ///< beyond the rim's inner edge and below the plate (whatever has left the base)
  double diameter = 0;        ///< mean diameter of equal volume of all grains of the model [m]
  double heap_mass = 0;       ///< [kg]
  double trench_mass = 0;     ///< [kg]
};

/// Sorts the grains. A grain belongs to the heap if a chain of neighbours leads to the plate. Neighbours are grains whose
/// bounding balls, with 5 % of a mean diameter added, overlap: a necessary condition of contact, exact for spheres. The
/// chain does not pass through grains faster than sqrt(g d), the speed of a free fall over d/2: they are falling.
HeapGrains find_heap(const Model& model, const Snapshot& state, const HeapSite& site);

/// Height of the heap's upper surface over a square grid of columns, from the exact shapes. Heights are above the plate; a
/// column without grains has height 0. Columns lie at origin + pixel (i + 1/2, j + 1/2).
struct HeightMap {
  Vec2 origin = Vec2::Zero();  ///< corner of the map [m], world
  double pixel = 0;            ///< [m]
  int size = 0;                ///< columns along each axis
  std::vector<double> height;  ///< [m], size * size, row by row: j * size + i

  Vec2 column(int i, int j) const { return origin + pixel * Vec2(i + 0.5, j + 0.5); }
  double at(int i, int j) const { return height[static_cast<std::size_t>(j) * static_cast<std::size_t>(size) + static_cast<std::size_t>(i)]; }
};

/// The map covers the square around the plate. `columns_per_diameter` > 0.
HeightMap height_map(const Model& model, const Snapshot& state, const HeapGrains& grains, const HeapSite& site,
                     double columns_per_diameter = 8);

/// Mean height of the surface in rings about the plate's axis.
struct RadialProfile {
  std::vector<double> radius;   ///< mean radius of the columns of the ring [m], ascending
  std::vector<double> height;   ///< mean [m], above the plate
  std::vector<double> sd;       ///< of the height within the ring [m]
  double ring = 0;              ///< width of a ring [m]
  double coverage = 0;          ///< share of the plate's area that has a grain over it [1]
  double foot = 0;              ///< radius where the mean height falls below half a diameter; the plate's if it never does [m]
  bool covers_base = false;     ///< the heap reaches the rim all round: the outermost ring is covered to 90 %
};

/// `ring_in_diameters` > 0: width of the rings.
RadialProfile radial_profile(const HeightMap& map, const HeapSite& site, double diameter, double ring_in_diameters = 1);

}  // namespace repose
