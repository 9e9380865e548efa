#pragma once
/// Everything that is measured on a layer, before and after.
#include <optional>
#include <vector>

#include "analysis/bed_structure.hpp"
#include "analysis/height_grid.hpp"
#include "analysis/roughness.hpp"
#include "core/recording.hpp"
#include "core/scene.hpp"

namespace repose {

/// One state of the bed.
struct BedSurface {
  HeightGrid grid;
  HeightGrid prepared;          ///< plane removed, filtered
  HeightFigures heights;        ///< of the cells
  double coverage = 0;          ///< share of the cells that are no holes
  Roughness roughness;
  std::optional<double> Sal;    ///< [m]
  std::optional<RoughnessError> error;
  HighestGrains highest;
  HeightFigures centres, tops;  ///< of the highest grains
  Packing packing;
  Segregation segregation;
};

/// The load on the spreader.
struct SpreaderLoad {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();        ///< means over converged steps while over the region [N], [N m]
  std::optional<Vec3> force_se, torque_se;                 ///< standard errors, from ten stretches of time; nullopt if fewer than 20 steps converged
  double largest = 0;       ///< largest force of a converged step [N]
  double rise = 0, rise_largest = 0;  ///< mean and largest height of a spreader that yields above its stops [m]
  std::size_t steps = 0, converged = 0;  ///< over the region
  double residual_max = 0;  ///< over the region
};

struct LayerMeasurement {
  BedSurface before, after;
  bool at_rest = false;              ///< of the grains after; else the surface is that of grains which still move
  double speed_rms = 0;              ///< of them, in sqrt(g d)
  HeightFigures thickness;           ///< after minus before, cell by cell
  double solid_per_area = 0;         ///< solid volume that came, per area [m]; negative if more left. It may exceed the thickness, for the spreader compacts the
                                     ///< bed below as well
  double passed = 0;                 ///< 99 % quantile of the heights after, against the lowest line of the spreader [m]
  SpreaderLoad load;
  double mass_in_region_before = 0, mass_in_region_after = 0, mass = 0;  ///< [kg]
  std::size_t moved_in = 0;          ///< grains in the region that were outside before
  std::size_t lost = 0;              ///< grains that lie below the plate
};

/// `from`, `speed`: the path of the lowest line.
LayerMeasurement measure_layer(const LayerSetup& layer, const Model& model, const Snapshot& before, const Snapshot& after,
                               const std::vector<StepRecord>& steps, double lowest, double from);

}  // namespace repose
