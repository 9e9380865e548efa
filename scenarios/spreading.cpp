#include "scenarios/spreading.hpp"

#include <numbers>

#include <fmt/format.h>

#include "analysis/height_grid.hpp"
#include "analysis/roughness.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

/// Walls that moved while the bed settled, and gates that opened, go on from there: the clock of `model` begins at `time` of theirs. The spreader's
/// motion is told on the new clock.
void go_on_from(double time, const std::string& spreader, Model& model) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    Body& body = model.bodies[i];
    if (body.dynamic || (body.name >= 0 && model.names[static_cast<std::size_t>(body.name)] == spreader)) continue;
    Pose initial{model.initial.position[i], model.initial.orientation[i]};
    set_clock_to_zero_at(time, body.motion, initial);
    model.initial.position[i] = initial.position;
    model.initial.orientation[i] = initial.orientation;
    for (Interval& interval : body.active) {
      interval.from -= time;
      interval.to -= time;
    }
  }
  for (Effect& effect : model.effects)
    if (auto* force = std::get_if<PeriodicForce>(&effect)) force->phase += 2 * std::numbers::pi * force->frequency * time;
}

/// The free bodies of `to` stand as those of `from` do: the same ones in the same order, around other tools.
void take_over(const Model& from, const Snapshot& state, Model& to) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < to.bodies.size(); ++i) {
    if (!to.bodies[i].dynamic) continue;
    while (!from.bodies[k].dynamic) ++k;
    to.initial.position[i] = state.position[k];
    to.initial.orientation[i] = state.orientation[k];
    to.initial.velocity[i] = state.velocity[k];
    to.initial.angular_velocity[i] = state.angular_velocity[k];
    ++k;
  }
}

}  // namespace

void demand_layer(const Scene& scene, const std::string& place) {
  if (scene.layer) return;
  throw Error(place.empty() ? "layer" : place + ": layer", "the scene has no `layer` block",
              "say what spreads and where it is measured; see scenarios/configs/layer-quick.yaml");
}

KeyNames keys_of_bed() { return {{"duration", "layer.settle"}, {"solver.time_step", "layer.settle_time_step"}}; }
KeyNames keys_of_spreading() { return {{"duration", "layer.to"}}; }

Prepared prepare_bed(const Scene& scene, const Options& options) { return prepare_quietly(bed_scene(scene), options, {}, keys_of_bed()); }

Scene spreading_above_all(const Scene& scene) {
  constexpr double above_all = 1;  // [m]
  const LayerSetup& setup = *scene.layer;
  SpreaderPath path;
  path.lowest = setup.plate + above_all;
  path.from = setup.from.value_or(setup.lower.x());
  path.duration = (setup.to - path.from) / setup.speed;
  if (!(path.duration > 0)) throw Error("layer.to", "the spreader arrives before it starts, or does not reach the region", "make `to` larger");
  return spreading_scene(scene, path);
}

std::vector<Finding> check_spreading(const Scene& scene, const Options& options) {
  return prepare_quietly(spreading_above_all(scene), options, {}, keys_of_spreading()).findings;
}

Spreading over_the_bed(const Scene& scene, const Model& bed, const Snapshot& settled, const Options& options) {
  const LayerSetup& setup = *scene.layer;
  const SurfaceRegion region{setup.lower, setup.upper, setup.plate};
  const HeightGrid grid = height_grid(bed, settled, region, setup.cell);
  if (const auto at = hole_beside_plate(bed, settled, grid))
    throw Error("layer.region",
                fmt::format("no grain lies over x = {:.4g} m, y = {:.4g} m, and no fixed solid has its top at layer.plate = {:.4g} m there: the height of the surface is not known",
                            at->x(), at->y(), setup.plate),
                "move the region to where the bed or the plate is, or make layer.plate the height of the solid under it");
  const HeightFigures heights = height_figures(on_plate(grid));
  Spreading ready;
  ready.path = spreader_path(scene, bed, settled, heights.mean);
  ready.prepared = prepare_quietly(spreading_scene(scene, ready.path), options, [&](Model& model) {
    take_over(bed, settled, model);
    go_on_from(settled.time, setup.spreader, model);
  }, keys_of_spreading());
  return ready;
}

}  // namespace repose
