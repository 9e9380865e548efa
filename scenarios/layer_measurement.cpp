#include "scenarios/layer_measurement.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/statistics.hpp"
#include "scenarios/bed.hpp"

namespace repose {
namespace {

constexpr double overlap_share = 0.01;  // of a mean diameter

/// Blocks of three diameters are several autocorrelation lengths wide; where that length was not found none is known to be wide enough. A flat surface has
/// no scatter at any width.
std::optional<RoughnessError> error_of(const HeightGrid& surface, const HeightGrid& prepared, const std::optional<double>& Sal, double diameter) {
  if (!Sal && roughness(prepared).Sq > 0) return std::nullopt;
  return block_bootstrap(surface, prepared, std::max(3 * diameter, 4 * Sal.value_or(0)));
}

BedSurface measure_surface(const LayerSetup& layer, const Model& model, const Snapshot& state) {
  const SurfaceRegion region{layer.lower, layer.upper, layer.plate};
  const double diameter = mean_diameter(model);
  BedSurface s;
  s.grid = height_grid(model, state, region, layer.cell);
  s.coverage = coverage(s.grid);
  s.surface = on_plate(s.grid);
  s.prepared = prepared_surface(s.surface, {layer.s_filter, layer.l_filter});
  s.heights = height_figures(s.surface);
  s.roughness = roughness(s.prepared);
  s.Sal = autocorrelation_length(s.prepared);
  s.error = error_of(s.surface, s.prepared, s.Sal, diameter);
  s.highest = highest_grains(model, state, region, layer.square);
  s.squares.push_back({layer.square, height_figures(s.highest.centre), height_figures(s.highest.top)});
  for (const double square : layer.further_squares) {
    const HighestGrains further = highest_grains(model, state, region, square);
    s.squares.push_back({square, height_figures(further.centre), height_figures(further.top)});
  }
  const double spacing = std::min(std::max(layer.cell, diameter / 12), (layer.upper - layer.lower).minCoeff());
  s.packing = packing_of_bed(model, state, region, spacing, diameter / 4, 3 * diameter);
  s.segregation = segregation(model, state, region, diameter);
  return s;
}

/// A step tells how deep grains overlapped when it began; how deep when it ended, the next.
double overlap_of(const std::vector<StepRecord>& steps, std::size_t k) {
  return std::max(steps[k].report.penetration, k + 1 < steps.size() ? steps[k + 1].report.penetration : 0.0);
}

SpreaderLoad measure_load(const std::vector<StepRecord>& steps, double overlap_allowed, double enters, double leaves) {
  SpreaderLoad load;
  load.overlap_allowed = overlap_allowed;
  const std::vector<bool> tells = steps_that_tell(steps, overlap_allowed);
  std::vector<const StepRecord*> used;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const StepRecord& step = steps[k];
    if (step.time < enters || step.time > leaves) continue;
    ++load.steps;
    load.residual_max = std::max(load.residual_max, step.report.residual);
    load.overlap_max = std::max(load.overlap_max, overlap_of(steps, k));
    load.converged += step.report.converged;
    if (!tells[k]) continue;
    used.push_back(&step);
    load.largest = std::max(load.largest, step.tool_force.norm());
    load.rise_largest = std::max(load.rise_largest, step.tool_rise);
  }
  load.used = used.size();
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

std::vector<bool> steps_that_tell(const std::vector<StepRecord>& steps, double overlap_allowed) {
  std::vector<bool> tells(steps.size());
  for (std::size_t k = 0; k < steps.size(); ++k) tells[k] = steps[k].report.converged && overlap_of(steps, k) <= overlap_allowed;
  return tells;
}

std::optional<Finding> doubt_of_overlap(const SpreaderLoad& load, double max_penetration) {
  constexpr double um = 1e6;
  if (!(max_penetration > load.overlap_allowed)) return std::nullopt;
  return Finding{Finding::Level::warning, "layer.gap",
                 fmt::format("grains overlapped by up to {:.3g} um, {:.2g} mean diameters: rigid grains that jam under a rigid spreader do, and then neither "
                             "surface nor force is that of the powder ({} of {} steps over the region left out of the force for it)",
                             max_penetration * um, overlap_share * max_penetration / load.overlap_allowed, load.converged - load.used, load.steps),
                 "make `gap` larger than the largest grain, let the spreader give way (`yield` of its tool), or make solver.time_step smaller"};
}

LayerMeasurement measure_layer(const LayerSetup& layer, const Model& model, const Snapshot& before, const Snapshot& after,
                               const std::vector<StepRecord>& steps, double lowest, double from) {
  LayerMeasurement m;
  m.before = measure_surface(layer, model, before);
  m.after = measure_surface(layer, model, after);
  m.at_rest = grains_rest(model, after, layer.plate);
  m.speed_rms = speed_of_grains(model, after, layer.plate);
  m.thickness_map = m.after.surface;
  std::vector<double> thickness;
  for (std::size_t k = 0; k < m.after.surface.height.size(); ++k) {
    thickness.push_back(static_cast<double>(m.after.surface.height[k]) - m.before.surface.height[k]);
    m.thickness_map.height[k] -= m.before.surface.height[k];
  }
  m.thickness = height_figures(std::move(thickness));
  const HeightGrid uneven = prepared_surface(m.thickness_map, {});
  if (const auto error = error_of(m.thickness_map, uneven, autocorrelation_length(uneven), mean_diameter(model))) m.thickness_se = error->mean;
  m.beside_plate = hole_beside_plate(model, after, m.after.grid);
  m.solid_per_area = (m.after.packing.solid_volume - m.before.packing.solid_volume) / m.after.packing.area;
  if (const double gap = lowest - layer.plate - m.before.heights.mean; gap > 0) m.solid_of_gap = m.solid_per_area / gap;
  m.passed = m.after.heights.quantile[7] - (lowest - layer.plate);
  // Over the region, while it moves.
  m.load = measure_load(steps, overlap_share * mean_diameter(model), (layer.lower.x() - from) / layer.speed, (std::min(layer.upper.x(), layer.to) - from) / layer.speed);
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

std::vector<Doubt> doubts_of(const LayerMeasurement& m) {
  std::vector<Doubt> doubts;
  if (!m.at_rest)
    doubts.push_back({fmt::format("the grains were not at rest when the surface after was measured (root mean square speed {:.2g} sqrt(g d))", m.speed_rms),
                      "make layer.rest longer"});
  if (m.after.coverage == 0) doubts.push_back({"no grain lies over the region after the spreading", "move layer.region to where the powder comes, or make the pile larger"});
  if (m.beside_plate)
    doubts.push_back({fmt::format("no grain lies over x = {:.4g} m, y = {:.4g} m after the spreading, and the plate is not there either; such places count as height 0", m.beside_plate->x(),
                                  m.beside_plate->y()),
                      "make layer.region smaller, or layer.plate the height of the solid under it"});
  return doubts;
}

}  // namespace repose
