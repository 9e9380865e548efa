#pragma once
/// Where grains are and how fast, as a film of cells that runs of one scene share.
#include <string>
#include <vector>

#include "core/model.hpp"
#include "core/scene.hpp"

namespace repose {

/// Rings about a vertical axis, cut into layers of height. The outermost ring and the lowest and highest layer hold what lies
/// beyond them too, so that no grain is lost.
struct FieldGrid {
  Vec3 origin = Vec3::Zero();  ///< of the axis, at the lower end of the lowest layer [m]
  double ring = 0;             ///< width [m], > 0
  double layer = 0;            ///< height [m], > 0
  int rings = 0, layers = 0;

  std::size_t cells() const { return static_cast<std::size_t>(rings) * static_cast<std::size_t>(layers); }
  /// Index of the cell of a place: layer * rings + ring.
  std::size_t cell(const Vec3& place) const;
  /// Radii and heights above the origin that bound a cell [m].
  struct Bounds { double inner = 0, outer = 0, lower = 0, upper = 0; };
  Bounds bounds(std::size_t cell) const;
};

/// The grid of a scene: about its base, from the plate up to the highest grain at the start; without a base about the grains'
/// centre at the start, half as wide again as they are. No cell is narrower than a mean diameter. Throws Error if the model has no grains.
FieldGrid field_grid(const Scene& scene, const Model& model);

/// Per cell the share of the grains' mass [1], then per cell their kinetic energy of translation [J].
std::vector<double> motion_field(const FieldGrid& grid, const Model& model, const Snapshot& state);

/// 0 for cells of mass, 1 for cells of energy: `kind` of first_parting.
std::vector<int> motion_field_kinds(const FieldGrid& grid);

/// Mean diameter of equal volume of the grains [m]; 0 if there are none.
double mean_grain_diameter(const Model& model);

}  // namespace repose
