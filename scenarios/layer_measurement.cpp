#include "scenarios/layer_measurement.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/statistics.hpp"
#include "scenarios/bed.hpp"

namespace repose {
namespace {

double mean_diameter(const Model& model) {
  double sum = 0, n = 0;
  for (const Body& body : model.bodies)
    if (body.role == BodyRole::grain) {
      sum += 2 * body.radius;
      n += 1;
    }
  return n > 0 ? sum / n : 0;
}

BedSurface measure_surface(const LayerSetup& layer, const Model& model, const Snapshot& state) {
  const SurfaceRegion region{layer.lower, layer.upper, layer.plate};
  const double diameter = mean_diameter(model);
  BedSurface s;
  s.grid = height_grid(model, state, region, layer.cell);
  s.prepared = prepared_surface(s.grid, {layer.s_filter, layer.l_filter});
  s.heights = height_figures(s.grid);
  s.coverage = static_cast<double>(s.heights.n) / static_cast<double>(s.grid.height.size());
  s.roughness = roughness(s.prepared);
  s.Sal = autocorrelation_length(s.prepared);
  // Blocks of three diameters are several autocorrelation lengths wide.
  s.error = block_bootstrap(s.grid, s.prepared, std::max(3 * diameter, 4 * s.Sal.value_or(0)));
  s.highest = highest_grains(model, state, region, layer.square);
  s.centres = height_figures(s.highest.centre);
  s.tops = height_figures(s.highest.top);
  s.packing = packing_of_bed(model, state, region, std::max(layer.cell, diameter / 12), diameter / 4, 3 * diameter);
  s.segregation = segregation(model, state, region, diameter);
  return s;
}

SpreaderLoad measure_load(const std::vector<StepRecord>& steps, double enters, double leaves) {
  SpreaderLoad load;
  std::vector<const StepRecord*> used;
  for (const StepRecord& step : steps) {
    if (step.time < enters || step.time > leaves) continue;
    ++load.steps;
    load.residual_max = std::max(load.residual_max, step.report.residual);
    if (!step.report.converged) continue;
    used.push_back(&step);
    load.largest = std::max(load.largest, step.tool_force.norm());
    load.rise_largest = std::max(load.rise_largest, step.tool_rise);
  }
  load.converged = used.size();
  if (used.empty()) return load;
  constexpr std::size_t stretches = 10;
  for (const StepRecord* step : used) load.rise += step->tool_rise / static_cast<double>(used.size());
  if (used.size() >= 2 * stretches) load.force_se = load.torque_se = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> force(stretches, 0), torque(stretches, 0), count(stretches, 0);
    for (std::size_t k = 0; k < used.size(); ++k) {
      const std::size_t s = k * stretches / used.size();
      force[s] += used[k]->tool_force[axis];
      torque[s] += used[k]->tool_torque[axis];
      count[s] += 1;
    }
    for (const StepRecord* step : used) {
      load.force[axis] += step->tool_force[axis] / static_cast<double>(used.size());
      load.torque[axis] += step->tool_torque[axis] / static_cast<double>(used.size());
    }
    if (!load.force_se) continue;
    for (std::size_t s = 0; s < stretches; ++s) {
      force[s] /= count[s];
      torque[s] /= count[s];
    }
    (*load.force_se)[axis] = summarise(force).se;
    (*load.torque_se)[axis] = summarise(torque).se;
  }
  return load;
}

}  // namespace

LayerMeasurement measure_layer(const LayerSetup& layer, const Model& model, const Snapshot& before, const Snapshot& after,
                               const std::vector<StepRecord>& steps, double lowest, double from) {
  LayerMeasurement m;
  m.before = measure_surface(layer, model, before);
  m.after = measure_surface(layer, model, after);
  m.at_rest = grains_rest(model, after, layer.plate);
  m.speed_rms = speed_of_grains(model, after, layer.plate);
  std::vector<double> thickness;
  for (std::size_t k = 0; k < m.after.grid.height.size(); ++k)
    thickness.push_back(static_cast<double>(m.after.grid.height[k]) - m.before.grid.height[k]);
  m.thickness = height_figures(std::move(thickness));
  m.solid_per_area = (m.after.packing.solid_volume - m.before.packing.solid_volume) / m.after.packing.area;
  m.passed = m.after.heights.quantile[7] - (lowest - layer.plate);
  // Over the region, while it moves.
  m.load = measure_load(steps, (layer.lower.x() - from) / layer.speed, (std::min(layer.upper.x(), layer.to) - from) / layer.speed);
  const auto within = [&](const Vec3& at) {
    return (at.head<2>().array() >= layer.lower.array()).all() && (at.head<2>().array() < layer.upper.array()).all();
  };
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (body.role != BodyRole::grain) continue;
    const bool was = within(before.position[i]), is = within(after.position[i]);
    m.mass += body.mass;
    m.mass_in_region_before += was ? body.mass : 0;
    m.mass_in_region_after += is ? body.mass : 0;
    m.moved_in += is && !was;
    m.lost += after.position[i].z() < layer.plate;
  }
  return m;
}

}  // namespace repose
