#pragma once
/// How fast a funnel empties: mass below the outlet against time, its steady rate, and the law of Beverloo.
#include <optional>
#include <span>
#include <vector>

#include "core/model.hpp"
#include "core/scene.hpp"

namespace repose {

/// The outlet of a funnel.
struct Outlet {
  double height = 0;    ///< of its plane [m], world z
  double diameter = 0;  ///< [m]
  double opens = 0;     ///< [s]
};

/// The scene's funnel, the first by name; nullopt if it has none.
std::optional<Outlet> funnel_outlet(const Scene& scene);

/// Mass of the grains whose centres are below `height` [kg].
double mass_below(const Model& model, const Snapshot& state, double height);

struct DischargeCurve {
  std::vector<double> time;  ///< [s], ascending
  std::vector<double> mass;  ///< below the outlet [kg]
  void add(const Model& model, const Snapshot& state, const Outlet& outlet);
};

DischargeCurve discharge_curve(const Model& model, std::span<const Snapshot> frames, const Outlet& outlet);

struct DischargeRate {
  double rate = 0;             ///< [kg/s]
  double se = 0;               ///< of the regression [kg/s]: a lower bound, residuals of a flow are correlated
  double from = 0, to = 0;     ///< the stretch of time used [s]
  double discharged = 0;       ///< mass that has gone through in the end [kg]
  std::size_t samples = 0;
};

/// Slope of the least-squares line through the samples between 20 % and 80 % of the discharged mass; nullopt with fewer
/// than four samples there.
std::optional<DischargeRate> steady_rate(const DischargeCurve& curve);

/// Beverloo, Leniger & van de Velde (1961): W = C rho_b sqrt(g) (D - k d)^{5/2} [kg/s], for D above about 6 d.
///   bulk_density rho_b [kg/m^3] of the flowing powder, gravity g [m/s^2] > 0, outlet D [m], grain diameter d [m].
/// 0 if D <= k d. Defaults for spheres; k reaches 2.9 for angular grains. Throws Error unless all are positive.
double beverloo_rate(double bulk_density, double gravity, double outlet, double grain, double c = 0.58, double k = 1.4);

}  // namespace repose
