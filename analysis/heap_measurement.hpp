#pragma once
/// Everything that is measured on a poured heap, in one go.
#include <optional>

#include "analysis/discharge.hpp"
#include "analysis/heap_profile.hpp"
#include "analysis/packing.hpp"
#include "analysis/repose_angle.hpp"
#include "analysis/rest.hpp"
#include "core/scene.hpp"

namespace repose {

struct HeapMeasurement {
  ReposeMeasurement repose;            ///< angle, grains, radial profile
  std::optional<SolidFraction> solid;  ///< of the heap's interior
  double volume = 0;                   ///< between plate and surface [m^3]
  RestReport rest;
  std::optional<Displacement> moved;   ///< of the heap's grains since the frame before
  DischargeCurve discharge;
  std::optional<DischargeRate> rate;
  std::optional<double> beverloo;      ///< [kg/s], for the outlet, the mean grain and the bulk density of this heap
};

/// `before`: the frame before the final one, if there is one. `discharge`: from all frames; may be empty.
/// Throws Error if the scene has no base tool.
HeapMeasurement measure_heap(const Scene& scene, const Model& model, const Snapshot& state, const Snapshot* before,
                             DischargeCurve discharge);

}  // namespace repose
