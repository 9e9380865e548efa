#pragma once
/// The angle of repose, measured as the experiment did it: from side views of the heap, both flanks of each.
///
/// In a view along one azimuth the outline z(s) is the highest point of the heap in each column s of the picture, by the
/// exact shapes of the grains. A flank is the outline between 20 % and 80 % of the way from the axis to the foot (the rim, if
/// the heap covers its base; else the radius where the mean height falls below half a diameter): apex and toe are out. The
/// limits are distances, not heights, because a selection by the fitted quantity itself would bias the slope. Its angle is
/// the arctangent of the slope of the least-squares line z(s).
///
/// Depth of view. An outline is the maximum over everything behind a column, and the extreme of many rough places stands
/// higher than that of few. Seen along its whole depth, a cone offers about sqrt(2 s delta / tan a) of its ridge at a
/// distance s from the axis (delta: roughness), so the outline rises outwards and reads too flat: on synthetic cones of 20
/// grain diameters by half a degree, on the experiment's 470 diameters by a few hundredths. So a flank is looked at with
/// a depth of view that is the same all along it: only grains whose centres lie within the arc length `half_depth` of its
/// azimuth, each seen along the tangent at its own place (which keeps its distance from the axis). The number that
/// compete is then constant, the extreme is a constant offset, and the slope is that of the surface
/// (tests/unit/repose_angle_test.cpp). The value of the whole-depth outlines is given beside it.
#include <optional>
#include <string>
#include <vector>

#include "analysis/heap_profile.hpp"

namespace repose {

struct ReposeOptions {
  int azimuths = 18;                ///< views over 180 degrees, >= 1
  double from = 0.2, to = 0.8;      ///< part of the flank that is fitted, shares of the way from axis to foot
  double half_depth = 2;            ///< of the view of a flank, in mean grain diameters, > 0
  double columns_per_diameter = 8;  ///< of the picture, > 0
};

/// One flank of one view.
struct Flank {
  double azimuth_deg = 0;  ///< direction from the axis down the flank, in [0, 360)
  double angle_deg = 0;
  double upper_deg = 0, lower_deg = 0;  ///< of the half near the apex and of the half near the foot
  double rms = 0;          ///< of the residual, in mean grain diameters
};

struct ReposeAngle {
  double value = 0;       ///< mean over all flanks [deg]
  double sd = 0;          ///< over azimuths and flanks [deg]
  double se = 0;          ///< of the mean: flanks averaged in six sectors of 60 degrees, sd of these / sqrt(6) [deg]
  double rms = 0;         ///< mean residual of the flanks, in grain diameters
  double concavity = 0;   ///< mean of upper minus lower angle [deg]; > 0: flanks get flatter downwards
  double whole_depth = 0; ///< the same with an unlimited depth of view [deg]: reads too flat on small heaps
  double radial = 0;      ///< from the slope of the mean radial profile over the same stretch [deg]
  double radial_se = 0;   ///< of that fit [deg]
  double foot = 0;        ///< [m]
  double apex = 0;        ///< height of the flanks' lines at the axis, mean, above the plate [m]
  std::vector<Flank> flanks;  ///< ascending in azimuth
};

/// Either an angle or the reason why there is none.
struct ReposeMeasurement {
  std::optional<ReposeAngle> angle;
  std::string message;        ///< empty if there is an angle
  HeapGrains grains;
  RadialProfile profile;
};

/// Throws Error for options out of range. A heap of fewer than 100 grains, with a fitted stretch shorter than four diameters or
/// lower than two diameters has no angle.
ReposeMeasurement measure_repose_angle(const Model& model, const Snapshot& state, const HeapSite& site,
                                       const ReposeOptions& options = {});

/// One outline: heights above the plate at screen coordinates (left to right); columns without a grain are left out.
struct Outline {
  std::vector<double> s, z;  ///< [m]
};

/// The flank at one azimuth with the limited depth of view: s >= 0 is the distance from the axis.
Outline flank_outline(const Model& model, const Snapshot& state, const HeapGrains& grains, const HeapSite& site,
                      double azimuth_deg, const ReposeOptions& options = {});

/// The outline of the whole heap as a camera sees it, with the flank at `azimuth_deg` on the right.
Outline heap_outline(const Model& model, const Snapshot& state, const HeapGrains& grains, const HeapSite& site,
                     double azimuth_deg, const ReposeOptions& options = {});

}  // namespace repose
