#pragma once
/// What a bed is like inside and on top, grain by grain: the highest grains, packing by depth, pores, segregation.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/height_grid.hpp"
#include "analysis/roughness.hpp"

namespace repose {

/// Of all grains, each as the sphere of its volume [m]; 0 without grains.
double mean_diameter(const Model& model);

/// The measure of the source study: the region in squares, the highest grain of each. Heights are above the plate [m]; NaN: no grain has its centre, or its
/// top, in the square. Such a square is left out, not taken for bare plate: a grain of the next square may cover it.
struct HighestGrains {
  double square = 0;            ///< edge [m]
  int nx = 0, ny = 0;
  std::vector<double> centre;   ///< of mass; of the grains whose centre lies in the square, the highest
  std::vector<double> top;      ///< highest point; of the grains whose highest point lies in the square, the highest
};
HighestGrains highest_grains(const Model& model, const Snapshot& state, const SurfaceRegion& region, double square);

/// The highest point of a grain [m], exact.
Vec3 highest_point(const Model& model, const Snapshot& state, int body);

/// Along upright lines over the middles of the cells of a grid, every grain cuts an exact stretch; stretches that overlap
/// (parts of one grain) count once. From these: what is solid at each height, and how long the pores between them are.
struct Packing {
  double slab = 0;                    ///< thickness of a slab [m]
  std::vector<double> solid;          ///< share of slab k, heights k to k + 1 slabs above the plate, that is solid [1]
  std::vector<double> below_surface;  ///< share of it that lies below the surface (under some grain's top) [1]
  /// Solid share of the volume between plate and tops (holes: none) [1]; nullopt where there is no grain. Of one layer of grains it tells their shape, not
  /// how densely they lie: see `solid_volume` over `area`.
  std::optional<double> fraction;
  std::optional<double> se;           ///< of `fraction`, from blocks of the region; nullopt if fewer than eight
  double solid_volume = 0, volume = 0;  ///< [m^3]
  double area = 0;                    ///< that the lines stand for [m^2]
  double pore_mean = 0, pore_median = 0, pore_p95 = 0;  ///< lengths of upright chords through pores below the surface [m]
  std::size_t pores = 0;              ///< how many chords
};
/// `spacing` of the lines and `slab` [m], > 0; blocks of edge `block` [m].
Packing packing_of_bed(const Model& model, const Snapshot& state, const SurfaceRegion& region, double spacing, double slab, double block);

/// Means over grains of the region in bins along one direction.
struct SegregationBin {
  double from = 0, to = 0;    ///< [m]: height above the plate, or x
  std::size_t grains = 0;
  double size = 0, size_se = 0;         ///< mean diameter of equal volume, and its standard error [m]
  std::vector<double> share, share_se;  ///< of each shape kind, by number; binomial standard error
};
struct Segregation {
  std::vector<std::string> kinds;  ///< shape kinds, in the order of `share`
  std::vector<SegregationBin> by_height, by_x;
};
/// `bin`: thickness of the bins of height [m]; ten bins along x.
Segregation segregation(const Model& model, const Snapshot& state, const SurfaceRegion& region, double bin);

}  // namespace repose
