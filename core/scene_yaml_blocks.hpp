#pragma once
/// The blocks of a YAML scene, one reader each. Internal to scene_yaml.cpp; keys and defaults stand beside the code.
#include <filesystem>
#include <string>
#include <vector>

#include "core/scene.hpp"
#include "core/yaml_reader.hpp"

namespace repose {

/// materials: {pa12: {density: 1020}}
void read_materials(const YamlReader& block, Scene& scene);

/// pairs: {pa12-steel: {friction, rolling_friction, spinning_friction, rolling_friction_length,
/// spinning_friction_length, friction_arm, restitution, cohesion, cohesion_range}}; names in alphabetical order.
void read_pairs(const YamlReader& block, Scene& scene);

/// grain_shapes: the fields of GrainProportions, or the name of a YAML file that holds them.
void read_proportions(const YamlReader& block, Scene& scene);

/// shapes: {ball: {type: sphere, radius: 0.02}}; file names relative to `folder`.
void read_shapes(const YamlReader& block, const std::filesystem::path& folder, Scene& scene);

/// bodies: {ball: {shape, material, position, orientation, velocity, angular_velocity, fixed, mass, inertia, motion}}
void read_bodies(const YamlReader& block, Scene& scene);

/// motion: {velocity, angular_velocity, pivot, start, stop, vibration_amplitude, vibration_frequency,
/// vibration_phase_deg}; `pivot` is the default [m].
Motion read_motion(const YamlReader& block, const Vec3& pivot);

/// grains: {powder: {material, count | mass, mix, mix_by, aspect, size, fill, velocity}}
void read_grains(const YamlReader& block, const std::filesystem::path& folder, Scene& scene);

/// tools: {funnel: {type, material, position, motion, yield: {load, mass}, and the fields of its kind in tool.hpp}}
void read_tools(const YamlReader& block, Scene& scene);

/// layer: {spreader, plate, gap, gap_from, speed, rotation, rotation_ratio, from, to, rest, settle, settle_time_step, region,
/// surface, sides}; after the tools.
void read_layer(const YamlReader& block, Scene& scene);

/// effects: {linear_drag: {viscosity: 1.8e-5}}
void read_effects(const YamlReader& block, Scene& scene);

/// One entry of `effects` that changes the set-up (setup_effects.hpp): applied at once, since all other blocks are read
/// before. False: no such effect.
bool read_setup_effect(const std::string& name, const YamlReader& reader, Scene& scene);
std::vector<std::string> setup_effect_names();
/// periodic: {y: [lower, upper]}, x, y or both.
void read_periodic(const YamlReader& block, Scene& scene);

/// solver: {time_step, tolerance, max_iterations, method, law, integration, warm_start, search_margin}
void read_solver(const YamlReader& block, Scene& scene);

/// record: {rate, noise, dropouts, observables, runs, free, calibrate}: checked for unknown keys, otherwise kept as text only.
void check_record(const YamlReader& block);

/// The name of a material of the scene; an unknown one is an error with the nearest.
std::string read_material_name(const YamlReader& owner, const Scene& scene);

/// An OBJ file (v and f lines; polygons become fans of triangles) [m]. Throws Error naming file and line.
TriMesh read_obj(const std::filesystem::path& file);

}  // namespace repose
