#pragma once
/// The surface of a bed as heights over a regular grid, and as an OpenVDB file.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analysis/silhouette.hpp"
#include "core/model.hpp"

namespace repose {

/// Heights [m] above `plate`, sampled at the middles of the cells; NaN is a hole: no grain stands over that point.
/// Single precision keeps 0.03 nm of half a millimetre.
struct HeightGrid {
  Vec2 origin = Vec2::Zero();  ///< corner of cell (0, 0) [m], world
  double plate = 0;            ///< world z of height 0 [m]
  double cell = 0;             ///< edge of a cell [m]
  int nx = 0, ny = 0;          ///< cells along x and y
  std::vector<float> height;   ///< nx * ny, row by row: j * nx + i

  static constexpr float hole = std::numeric_limits<float>::quiet_NaN();
  Vec2 middle(int i, int j) const { return origin + cell * Vec2(i + 0.5, j + 0.5); }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  float at(int i, int j) const { return height[index(i, j)]; }
  bool is_hole(int i, int j) const { return std::isnan(at(i, j)); }
};

/// Where a surface is looked at: the cells fill the rectangle from `lower` on, as many as fit.
struct SurfaceRegion {
  Vec2 lower = Vec2::Zero(), upper = Vec2::Zero();  ///< (x, y) [m]
  double plate = 0;                                 ///< [m]
};

/// The grid without any grain. Throws Error unless the cell is positive and fits into the region.
HeightGrid empty_grid(const SurfaceRegion& region, double cell);

/// The parts of all grains that may reach over the region; in a periodic cell also those of their images. Throws Error if the
/// region reaches out of the cell, or the state is of another model.
std::vector<GrainPart> grain_parts_over(const Model& model, const Snapshot& state, const SurfaceRegion& region);

/// Height of the highest grain surface over the middle of each cell, in closed form for every grain shape (silhouette.hpp).
HeightGrid height_grid(const Model& model, const Snapshot& state, const SurfaceRegion& region, double cell);

/// fn(i, j, top): the cells whose middles the part stands over, and how high it reaches there [m, world].
template <class Fn>
void for_each_cell_under(const GrainPart& part, const HeightGrid& grid, Fn fn) {
  const double reach = part.reach();
  const Vec2 at = part.centre.head<2>() - grid.origin;
  const auto first = [&](double x, int n) { return std::clamp(static_cast<int>(std::floor((x - reach) / grid.cell)), 0, n); };
  const auto last = [&](double x, int n) { return std::clamp(static_cast<int>(std::ceil((x + reach) / grid.cell)), 0, n); };
  for (int j = first(at.y(), grid.ny); j < last(at.y(), grid.ny); ++j)
    for (int i = first(at.x(), grid.nx); i < last(at.x(), grid.nx); ++i)
      if (const double top = top_over_point(part, grid.middle(i, j)); std::isfinite(top)) fn(i, j, top);
}

/// Share of the cells that are no holes [1].
double coverage(const HeightGrid& grid);

/// The surface as one who looks down sees it: where no grain stands the build plate shows, which is height 0. What is told of heights, their
/// differences and roughness is told of this surface; the grid with holes says where it is powder. Right only where the plate is: see
/// hole_beside_plate.
HeightGrid on_plate(HeightGrid grid);

/// A hole under which the plate is not: no fixed or driven solid has its top at height 0 there, to a tenth of a cell. The middle of the first such cell [m];
/// nullopt if there is none, as where there are no holes. Throws Error if the state is of another model.
std::optional<Vec2> hole_beside_plate(const Model& model, const Snapshot& state, const HeightGrid& grid);

/// A surface with its name in the file.
struct NamedGrid {
  std::string name;
  HeightGrid grid;
};

/// surface.vdb: one FloatGrid per surface. Voxel (i, j, 0) holds the height of cell (i, j) [m]; holes are inactive voxels. The
/// transform takes an index to the middle of its cell in the world, at the height of the plate, in micrometres (OpenVDB takes a
/// voxel of 5e-6 for one without volume). Metadata: `cells` (nx, ny, 1), `origin` and `cell` [m]. Equal surfaces give
/// equal bytes. Written aside and renamed. Throws Error.
void write_vdb(const std::filesystem::path& file, const std::vector<NamedGrid>& grids);

/// What write_vdb wrote, bit for bit, in the order of the names. Throws Error naming the file.
std::vector<NamedGrid> read_vdb(const std::filesystem::path& file);

}  // namespace repose
