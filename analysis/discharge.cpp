#include "analysis/discharge.hpp"

#include <cmath>

#include "analysis/statistics.hpp"
#include "core/error.hpp"

namespace repose {

std::optional<Outlet> funnel_outlet(const Scene& scene) {
  for (const Tool& tool : scene.tools)
    if (const auto* funnel = std::get_if<Funnel>(&tool.kind))
      return Outlet{tool.position.z(), funnel->outlet_diameter, funnel->opens};
  return std::nullopt;
}

double mass_below(const Model& model, const Snapshot& state, double height) {
  if (state.size() != model.bodies.size())
    throw Error("discharge", "the state has another number of bodies than the model", "read both from the same run");
  double mass = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].role == BodyRole::grain && state.position[i].z() < height) mass += model.bodies[i].mass;
  return mass;
}

void DischargeCurve::add(const Model& model, const Snapshot& state, const Outlet& outlet) {
  time.push_back(state.time);
  mass.push_back(mass_below(model, state, outlet.height));
}

DischargeCurve discharge_curve(const Model& model, std::span<const Snapshot> frames, const Outlet& outlet) {
  DischargeCurve curve;
  for (const Snapshot& frame : frames) curve.add(model, frame, outlet);
  return curve;
}

std::optional<DischargeRate> steady_rate(const DischargeCurve& curve) {
  if (curve.time.size() != curve.mass.size()) throw Error("discharge", "as many times as masses are needed", "");
  if (curve.time.empty()) return std::nullopt;
  const double start = curve.mass.front(), total = curve.mass.back() - start;
  if (!(total > 0)) return std::nullopt;
  std::vector<double> t, m;
  for (std::size_t i = 0; i < curve.time.size(); ++i) {
    const double share = (curve.mass[i] - start) / total;
    if (share < 0.2 || share > 0.8) continue;
    t.push_back(curve.time[i]);
    m.push_back(curve.mass[i]);
  }
  if (t.size() < 4) return std::nullopt;
  const Line line = fit_line(t, m);
  return DischargeRate{line.slope, line.slope_se, t.front(), t.back(), total, t.size()};
}

double beverloo_rate(double bulk_density, double gravity, double outlet, double grain, double c, double k) {
  for (double x : {bulk_density, gravity, outlet, grain, c, k})
    if (!(x > 0) || !std::isfinite(x)) throw Error("discharge", "Beverloo's law needs positive, finite quantities", "");
  const double free = outlet - k * grain;
  return free > 0 ? c * bulk_density * std::sqrt(gravity) * std::pow(free, 2.5) : 0;
}

}  // namespace repose
