#pragma once
/// Everything that is measured on a layer, before and after.
#include <optional>
#include <string>
#include <vector>

#include "analysis/bed_structure.hpp"
#include "analysis/height_grid.hpp"
#include "analysis/roughness.hpp"
#include "core/plausibility.hpp"
#include "core/recording.hpp"
#include "core/scene.hpp"

namespace repose {

/// Of the highest grains of all squares of one size; n = 0, and nothing known, if no square has one.
struct SquareFigures {
  double square = 0;  ///< edge [m]
  HeightFigures centres, tops;
};

/// One state of the bed.
struct BedSurface {
  HeightGrid grid;              ///< with holes where no grain stands
  HeightGrid surface;           ///< the plate in the holes: all figures are of it
  HeightGrid prepared;          ///< plane removed, filtered
  HeightFigures heights;        ///< of the cells
  double coverage = 0;          ///< share of the cells over which a grain stands
  Roughness roughness;
  std::optional<double> Sal;    ///< [m]
  std::optional<RoughnessError> error;  ///< nullopt if the region is too small, or the surface correlates too far, to tell
  HighestGrains highest;
  std::vector<SquareFigures> squares;   ///< of `highest`, then of LayerSetup::further_squares
  Packing packing;
  Segregation segregation;
};

/// The load on the spreader: what the contacts put on it. Steps tell of it if they converged and grains did not overlap deeper than
/// `overlap_allowed` when they began or ended: rigid grains that jam under a rigid spreader overlap, and any force may then satisfy the contact law.
struct SpreaderLoad {
  /// Means over those steps while over the region [N], [N m], world axes. The torque is about the spreader's centre of mass, which travels with it: of a
  /// roller the middle of its axis, of a blade the middle of its body (not its lowest line).
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  std::optional<Vec3> force_se, torque_se;                 ///< standard errors, from ten stretches of time; nullopt if fewer than 20 steps tell
  double largest = 0;       ///< largest force of such a step [N]
  double rise = 0, rise_largest = 0;  ///< mean and largest height of a spreader that yields above its stops [m]
  std::size_t steps = 0, converged = 0, used = 0;  ///< over the region; used: those that tell
  double residual_max = 0;  ///< over the region
  double overlap_allowed = 0;  ///< 1 % of a mean diameter [m]
  double overlap_max = 0;      ///< deepest overlap of any grain in the steps over the region [m]
};

/// Of each step whether it tells of the load.
std::vector<bool> steps_that_tell(const std::vector<StepRecord>& steps, double overlap_allowed);

/// The doubt that a run raises whose grains overlapped deeper than that, in whatever step.
std::optional<Finding> doubt_of_overlap(const SpreaderLoad& load, double max_penetration);

struct LayerMeasurement {
  BedSurface before, after;
  bool at_rest = false;              ///< of the grains after; else the surface is that of grains which still move
  double speed_rms = 0;              ///< of them, in sqrt(g d)
  HeightGrid thickness_map;          ///< after minus before, the plate in the holes of either
  HeightFigures thickness;           ///< of its cells
  std::optional<double> thickness_se;  ///< of its mean: of the difference itself, for before and after hold much of the same
  double solid_per_area = 0;         ///< solid volume that came, per area [m]; negative if more left. It may exceed the thickness, for the spreader compacts the
                                     ///< bed below as well
  std::optional<double> solid_of_gap;  ///< `solid_per_area` over the gap between the mean surface before and the spreader [1]; nullopt without a gap. How densely
                                       ///< a single layer lies, which its packing fraction does not tell
  double passed = 0;                 ///< 99 % quantile of the heights after, against the lowest line of the spreader [m]
  SpreaderLoad load;
  double mass_in_region_before = 0, mass_in_region_after = 0, mass = 0;  ///< [kg]
  std::size_t moved_in = 0;          ///< grains in the region that were outside before
  std::size_t lost = 0;              ///< grains that lie below the plate
  std::optional<Vec2> beside_plate;  ///< a hole after that does not show the plate: its height is not known, and counts as 0
};

/// `from`, `speed`: the path of the lowest line.
LayerMeasurement measure_layer(const LayerSetup& layer, const Model& model, const Snapshot& before, const Snapshot& after,
                               const std::vector<StepRecord>& steps, double lowest, double from);

/// Why figures of a measurement are to be doubted, and what mends it.
struct Doubt {
  std::string what, remedy;
};
std::vector<Doubt> doubts_of(const LayerMeasurement& layer);

}  // namespace repose
