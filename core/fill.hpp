#pragma once
/// Where grains are put at the start: random positions without overlap.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/math.hpp"
#include "core/periodic.hpp"

namespace repose {

/// The region that grains are put in; no grain reaches out of it. A frustum is a cylinder when both radii are equal.
struct FillRegion {
  enum class Kind { box, frustum } kind = Kind::box;
  Vec3 lower = Vec3::Zero(), upper = Vec3::Zero();  ///< box corners [m]
  Vec3 base = Vec3::Zero();     ///< frustum: centre of its lower disc [m]; the axis is z
  double radius_bottom = 0, radius_top = 0, height = 0;  ///< frustum [m]
  /// If true the region may grow upward (box: upper.z, frustum: height at its top radius) until all grains fit.
  bool grow = true;
};

struct Placement {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
};

/// Puts balls of the given radii (the bounding radii of the grains [m]) into the region without overlap, by random
/// sequential addition from the largest to the smallest, over a cell grid: linear in the number of grains. Orientations are
/// uniform over all rotations. The order of the result is that of `radii`. Throws Error if they do not fit; the message
/// states how much room is missing.
///
/// In a periodic cell the region must lie within it. A box that spans the cell from side to side along a periodic axis has
/// no walls there: balls lie across the seam, their centres in the cell, none overlapping an image of another.
std::vector<Placement> place_balls(const FillRegion& region, std::span<const double> radii, std::uint64_t seed,
                                   const PeriodicCell& cell = {});

}  // namespace repose
