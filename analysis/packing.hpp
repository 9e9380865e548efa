#pragma once
/// How densely a heap is packed: the share of a region that lies inside grains.
///
/// Points of a low-discrepancy sequence (Kronecker sequence of the root of x^4 = x + 1) are spread over the region, and
/// each is tested against the exact shapes: overlaps and shapes of any kind are counted right, once. With n points the error
/// of the sampling is below sqrt(phi (1 - phi) / n), 0.0035 for 20,000; that of the heap itself is larger and estimated
/// from eight sectors. In a periodic cell grains are counted with their images, and a region may reach across the seam or
/// be wider than the cell (its mean is then that of the images that it covers).
#include <optional>
#include <vector>

#include "analysis/heap_profile.hpp"

namespace repose {

struct SolidFraction {
  double value = 0;   ///< volume of grains / volume of the region [1]
  double sd = 0;      ///< between eight sectors of equal azimuth [1]
  double se = 0;      ///< sd / sqrt(8) [1]
  double volume = 0;  ///< of the region [m^3]
};

/// The interior of a heap: farther than `margin` mean diameters from the plate, from the rim and (vertically) from the
/// surface, which is the height map averaged over a square of twice that width. nullopt if nothing, or less than a
/// thousandth of the cylinder over the plate, is left. `points`: in the region, > 0.
std::optional<SolidFraction> heap_solid_fraction(const Model& model, const Snapshot& state, const HeapGrains& grains,
                                                 const HeapSite& site, const HeightMap& map, double margin = 2,
                                                 int points = 20000);

/// Over an upright cylinder: `base` is the centre of its lower disc. All given bodies count. Throws Error unless radius,
/// height and points are positive.
SolidFraction solid_fraction_in_cylinder(const Model& model, const Snapshot& state, const std::vector<int>& bodies,
                                         const Vec3& base, double radius, double height, int points = 20000);

/// Volume between the plate and the surface [m^3].
double heap_volume(const HeightMap& map);

}  // namespace repose
