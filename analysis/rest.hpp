#pragma once
/// How we know that a heap is at rest.
///
/// The scale of speed is sqrt(g d), d the mean grain diameter: what a grain gains in falling over d/2. At rest means
///   - a heap is there, and no grain falls onto it: nothing over the base is loose but what stands still in the funnel;
///   - every grain of the heap, on the rim and in the funnel moves slower than 0.05 sqrt(g d): its kinetic energy lifts it
///     by d/800, too little to leave its seat between neighbours;
///   - their root mean square speed is below 0.01 sqrt(g d).
/// Grains in the trench do not count. All of it is seen in one state, so that a resumed run ends where an
/// uninterrupted one does; the displacement between two states is a second, independent witness.
#include <optional>
#include <string>

#include "analysis/discharge.hpp"
#include "analysis/heap_profile.hpp"

namespace repose {

struct RestLimits {
  double speed_max = 0.05;  ///< in sqrt(g d)
  double speed_rms = 0.01;  ///< in sqrt(g d)
};

struct RestReport {
  bool at_rest = false;
  std::string reason;        ///< why not; empty at rest
  double speed_scale = 0;    ///< sqrt(g d) [m/s]
  double speed_max = 0;      ///< of the grains that count, in sqrt(g d)
  double speed_rms = 0;      ///< in sqrt(g d)
  std::size_t falling = 0;   ///< grains over the base, below the outlet, that are not part of the heap
  std::size_t in_funnel = 0; ///< grains above the outlet
};

/// `outlet`: the funnel's, if there is one. Not at rest before it opens.
RestReport assess_rest(const Model& model, const Snapshot& state, const HeapSite& site,
                       const std::optional<Outlet>& outlet, const RestLimits& limits = {});

/// How far grains moved between two states.
struct Displacement {
  double interval = 0;  ///< [s]
  double max = 0;       ///< in mean grain diameters
  double rms = 0;       ///< in mean grain diameters
};

/// Of the heap's grains. Throws Error if the states differ in size.
Displacement heap_displacement(const Snapshot& before, const Snapshot& after, const HeapGrains& grains);

}  // namespace repose
