#include "analysis/heap_measurement.hpp"

#include "core/error.hpp"

namespace repose {
namespace {

// Mean density of the grains' solid [kg/m^3].
double solid_density(const Model& model) {
  double mass = 0, volume = 0;
  for (const Body& body : model.bodies) {
    if (body.role != BodyRole::grain) continue;
    mass += body.mass;
    volume += body.volume;
  }
  return volume > 0 ? mass / volume : 0;
}

}  // namespace

HeapMeasurement measure_heap(const Scene& scene, const Model& model, const Snapshot& state, const Snapshot* before,
                             DischargeCurve discharge) {
  const std::optional<HeapSite> site = heap_site(scene);
  if (!site) throw Error("tools", "the scene has no base to measure a heap on", "add a tool of kind base");
  const std::optional<Outlet> outlet = funnel_outlet(scene);
  HeapMeasurement result;
  result.repose = measure_repose_angle(model, state, *site);
  const HeapGrains& grains = result.repose.grains;
  result.rest = assess_rest(model, state, *site, outlet);
  if (before) result.moved = heap_displacement(*before, state, grains);
  if (!grains.heap.empty()) {
    const HeightMap map = height_map(model, state, grains, *site);
    result.solid = heap_solid_fraction(model, state, grains, *site, map);
    result.volume = heap_volume(map);
  }
  result.discharge = std::move(discharge);
  result.rate = steady_rate(result.discharge);
  const double gravity = model.gravity.norm();
  if (outlet && result.solid && result.solid->value > 0 && gravity > 0 && grains.diameter > 0)
    result.beverloo = beverloo_rate(result.solid->value * solid_density(model), gravity, outlet->diameter, grains.diameter);
  return result;
}

}  // namespace repose
