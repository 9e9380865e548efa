#pragma once
/// A heap that costs nothing: smooth laws of the coefficients in the scene, and scatter that depends on the seed alone. What a diagnosis finds
/// on it is known beforehand.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "analysis/bundle/sensor.hpp"
#include "analysis/diagnosis/bulk_diagnose.hpp"
#include "core/random.hpp"
#include "core/scene_yaml.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {

inline const std::string heap_scene = R"(materials: {grain: {density: 1000}, plate: {density: 2700}, wall: {density: 7800}}
pairs:
  grain-grain: {friction: 0.5, rolling_friction: 0, restitution: 0}
  grain-plate: {friction: 1}
  grain-wall: {friction: 0.3}
grains:
  powder:
    material: grain
    count: 12
    mix: {sphere: 1, ellipsoid: 1}
    size: {normal: [58 um, 15 um], range: [30 um, 100 um]}
    fill: {frustum: {base: [0, 0, 1 mm], radius_bottom: 0.21 mm, radius_top: 0.75 mm, height: 0.935 mm}}
tools:
  funnel: {material: wall, position: [0, 0, 1 mm], outlet_diameter: 0.42 mm, half_angle_deg: 30, top_diameter: 1.5 mm, wall_height: 1 mm, thickness: 0.1 mm, opens: 0.01 s}
  base: {material: plate, diameter: 1.2 mm, rim_height: 0.06 mm, rim_width: 0.06 mm, trench_width: 0.8 mm, trench_depth: 0.4 mm, trench_wall: 0.6 mm}
solver: {time_step: 1.0e-4, tolerance: 1.0e-3}
duration: 0.1
frame_interval: 5 ms
)";

/// The number at a path of a scene; `otherwise` where it is absent.
inline double number_at(const YamlNode& tree, const std::string& path, double otherwise) {
  const YamlNode* node = &tree;
  for (std::size_t from = 0; node != nullptr && from <= path.size();) {
    const std::size_t dot = std::min(path.find('.', from), path.size());
    node = node->find(path.substr(from, dot - from));
    from = dot + 1;
  }
  return node == nullptr ? otherwise : std::stod(node->text);
}

inline constexpr double flow_of_the_other = 0.3;  ///< by which an engine called "other" flows faster; one called "lacking" solves nothing

/// What the stand-in does beside its laws; `recorded` things are true of a recording and unknown to the scene.
struct StandIn {
  double hidden_flow = 0;        ///< [share] of the discharge, beyond any effect
  double length_factor = 1;      ///< of the recorded profile
  double late = 0;               ///< [s] of the recorded flow
  double protractor = 0;         ///< [deg] by which the angle is read too large
  double by_step = 0, by_tolerance = 0;  ///< [share] by which it flows faster where step or tolerance is a tenth of the scene's
};

/// Angle, profile and discharge of one pour.
inline std::vector<Observation> stand_in_pour(const YamlNode& scene, std::uint64_t seed, const StandIn& how = {}) {
  const double mu = number_at(scene, "pairs.grain-grain.friction", 0), rho = number_at(scene, "pairs.grain-grain.rolling_friction", 0),
               aspect = number_at(scene, "effects.grain_shape.aspect", 1), e = number_at(scene, "pairs.grain-grain.restitution", 0),
               weight = number_at(scene, "pairs.grain-grain.cohesion", 0) / 1e-9, wall = number_at(scene, "pairs.grain-wall.friction", 0.3);
  Random random(seed, 3);
  const double elongation = std::log(aspect);
  const double steeper = 12 * (1 - std::exp(-rho / 0.08)) + 8 * elongation + 4 * std::log1p(weight);
  Observation angle;
  angle.kind = ObservableKind::scalar;
  angle.name = "angle_of_repose";
  angle.unit = "deg";
  angle.scalar = 10 + 20 * mu + steeper - e + 0.8 * normal(random);
  const double slope = std::tan(angle.scalar * std::numbers::pi / 180);
  angle.scalar += how.protractor;
  Observation profile;
  profile.kind = ObservableKind::profile;
  profile.name = "heap";
  const double apex = 2e-4 * (1 + steeper / 40 + 0.02 * normal(random));
  for (int i = 0; i < 20; ++i) {
    const double r = (i + 0.5) * 3e-5;
    profile.at.push_back(how.length_factor * r);
    profile.value.push_back(how.length_factor * (apex - slope * r * 0.5));
  }
  Observation flow;
  flow.kind = ObservableKind::series;
  flow.name = "discharged_mass";
  flow.unit = "kg";
  double rate = 1e-5 * (1 - 0.3 * rho - 0.1 * std::log1p(weight) + 0.02 * normal(random)) * (1 + how.hidden_flow);
  rate *= (1 - 0.4 * elongation) * (1 - 0.5 * (wall - 0.3));
  rate *= 1 + how.by_step * std::log10(1e-4 / number_at(scene, "solver.time_step", 1e-4)) + how.by_tolerance * std::log10(1e-3 / number_at(scene, "solver.tolerance", 1e-3));
  const double begins = 0.012 + how.late + 2e-4 * normal(random);
  for (int i = 0; i <= 200; ++i) {
    flow.time.push_back(5e-4 * i);
    flow.value.push_back(std::clamp(rate * (flow.time.back() - begins), 0.0, 4e-7));
  }
  return {angle, profile, flow};
}

inline SimulateBulk stand_in(const StandIn& how = {}) {
  return [how](const std::string&, const std::vector<BulkRequest>& requests) {
    std::vector<BulkOutcome> outcomes;
    for (const BulkRequest& r : requests) {
      if (r.backend == "lacking") {
        outcomes.push_back({{}, "it lacks rolling friction"});
        continue;
      }
      StandIn as = how;
      if (r.backend == "other") as.hidden_flow += flow_of_the_other;
      outcomes.push_back({stand_in_pour(parse_yaml(r.scene, "scene"), r.seed, as), ""});
    }
    return std::optional(std::move(outcomes));
  };
}

/// Recordings of the world that `truth` makes of the scene; the bundle's scene knows nothing of it.
inline Bundle recorded_heaps(int runs, std::uint64_t first_seed, const std::vector<Override>& truth, const StandIn& how = {}) {
  Bundle bundle;
  bundle.title = "heaps";
  bundle.scene = parse_scene(heap_scene, "scene");
  YamlNode world = parse_yaml(heap_scene, "scene");
  for (const Override& change : truth) set_path(world, change.path, change.value);
  for (int i = 0; i < runs; ++i) {
    BundleRun run;
    run.id = "pour-" + std::to_string(i + 1);
    run.observations = stand_in_pour(world, first_seed + static_cast<std::uint64_t>(i), how);
    bundle.runs.push_back(std::move(run));
  }
  return bundle;
}

}  // namespace repose::diagnosis
