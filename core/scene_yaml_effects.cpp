#include <algorithm>

#include <fmt/format.h>

#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

struct Kind {
  std::string name;
  Effect (*read)(const YamlReader&);
};

Effect read_tilt(const YamlReader& reader) {
  reader.only({"x_deg", "y_deg"});
  GravityTilt tilt;
  reader.read("x_deg", tilt.x_deg, degrees(-180, 180));
  reader.read("y_deg", tilt.y_deg, degrees(-180, 180));
  return tilt;
}

Effect read_uniform(const YamlReader& reader) {
  reader.only({"force"});
  UniformForce force;
  reader.require("force", force.force, any(dimension::force));
  return force;
}

Effect read_linear_drag(const YamlReader& reader) {
  reader.only({"viscosity"});
  LinearDrag drag;
  reader.require("viscosity", drag.viscosity, positive(dimension::viscosity));
  return drag;
}

Effect read_quadratic_drag(const YamlReader& reader) {
  reader.only({"coefficient", "fluid_density"});
  QuadraticDrag drag;
  reader.require("coefficient", drag.coefficient, non_negative(dimension::none));
  reader.require("fluid_density", drag.fluid_density, positive(dimension::density));
  return drag;
}

Effect read_finite_reynolds_drag(const YamlReader& reader) {
  reader.only({"viscosity", "fluid_density"});
  FiniteReynoldsDrag drag;
  reader.require("viscosity", drag.viscosity, positive(dimension::viscosity));
  reader.require("fluid_density", drag.fluid_density, positive(dimension::density));
  return drag;
}

Effect read_buoyancy(const YamlReader& reader) {
  reader.only({"fluid_density"});
  Buoyancy buoyancy;
  reader.require("fluid_density", buoyancy.fluid_density, positive(dimension::density));
  return buoyancy;
}

Effect read_magnus(const YamlReader& reader) {
  reader.only({"lift", "fluid_density"});
  Magnus magnus;
  reader.require("lift", magnus.lift, any(dimension::none));
  reader.require("fluid_density", magnus.fluid_density, positive(dimension::density));
  return magnus;
}

Effect read_periodic_force(const YamlReader& reader) {
  reader.only({"amplitude", "frequency", "phase"});
  PeriodicForce force;
  reader.require("amplitude", force.amplitude, any(dimension::acceleration));
  reader.require("frequency", force.frequency, non_negative(dimension::frequency));
  reader.read("phase", force.phase, any(dimension::angle));
  return force;
}

ContactEffect read_rate_dependent_friction(const YamlReader& reader) {
  reader.only({"slope", "reference_speed"});
  RateDependentFriction effect;
  reader.require("slope", effect.slope, any(dimension::none));
  reader.require("reference_speed", effect.reference_speed, positive(dimension::velocity));
  return effect;
}

ContactEffect read_anisotropic_friction(const YamlReader& reader) {
  reader.only({"ratio", "direction_deg"});
  AnisotropicFriction effect;
  reader.require("ratio", effect.ratio, positive(dimension::none));
  reader.read("direction_deg", effect.direction_deg, degrees(-360, 360));
  return effect;
}

ContactEffect read_rate_dependent_restitution(const YamlReader& reader) {
  reader.only({"exponent", "reference_speed"});
  RateDependentRestitution effect;
  reader.require("exponent", effect.exponent, any(dimension::none));
  reader.require("reference_speed", effect.reference_speed, positive(dimension::velocity));
  return effect;
}

ContactEffect read_liquid_bridge(const YamlReader& reader) {
  reader.only({"force", "rupture"});
  LiquidBridge effect;
  reader.require("force", effect.force, non_negative(dimension::force));
  reader.require("rupture", effect.rupture, positive(dimension::length));
  return effect;
}

ContactEffect read_contact_compliance(const YamlReader& reader) {
  reader.only({"stiffness", "damping"});
  ContactCompliance effect;
  reader.require("stiffness", effect.stiffness, positive(dimension::stiffness));
  reader.read("damping", effect.damping, non_negative(dimension::damping));
  return effect;
}

struct ContactKind {
  std::string name;
  ContactEffect (*read)(const YamlReader&);
};

const std::vector<ContactKind>& contact_kinds() {
  static const std::vector<ContactKind> table{{"rate_dependent_friction", read_rate_dependent_friction},
                                              {"anisotropic_friction", read_anisotropic_friction},
                                              {"rate_dependent_restitution", read_rate_dependent_restitution},
                                              {"liquid_bridge", read_liquid_bridge},
                                              {"contact_compliance", read_contact_compliance}};
  return table;
}

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> table{{"gravity_tilt", read_tilt},
                                       {"uniform_force", read_uniform},
                                       {"linear_drag", read_linear_drag},
                                       {"quadratic_drag", read_quadratic_drag},
                                       {"finite_reynolds_drag", read_finite_reynolds_drag},
                                       {"buoyancy", read_buoyancy},
                                       {"magnus", read_magnus},
                                       {"periodic_force", read_periodic_force}};
  return table;
}

// Names of the library of effects that no block of this version can hold, each with what to do instead.
struct Unavailable {
  std::string name, instead;
};

const std::vector<Unavailable>& unavailable() {
  const std::string remove = "remove it; this version cannot simulate it";
  const std::string pair = "write it under `pairs: {a-b: {...}}`";
  static const std::vector<Unavailable> table{
      {"friction", pair},
      {"rolling_friction", pair},
      {"spinning_friction", pair},
      {"restitution", pair},
      {"cohesion", pair},
      {"length_scale", remove},
      {"time_scale", remove},
      {"time_offset", remove},
      {"frame_tilt", remove},
      {"sensor_bias", remove},
      {"time_step", "write it under `solver`"},
      {"solver_tolerance", "write `tolerance` under `solver`"},
      {"engine_law", "write `law` under `solver`"}};
  return table;
}

/// Reads one entry of the block into the scene.
void read_effect(const std::string& name, const YamlReader& reader, Scene& scene) {
  std::vector<std::string> names;
  for (const Kind& kind : kinds()) {
    if (kind.name == name) return scene.effects.push_back(kind.read(reader));
    names.push_back(kind.name);
  }
  for (const ContactKind& kind : contact_kinds()) {
    if (kind.name == name) return scene.contact_effects.push_back(kind.read(reader));
    names.push_back(kind.name);
  }
  if (read_setup_effect(name, reader, scene)) return;
  for (const std::string& setup : setup_effect_names()) names.push_back(setup);
  for (const Unavailable& other : unavailable())
    if (other.name == name)
      reader.fail(fmt::format("effect `{}` is known, but not available under `effects` in this version", name),
                  other.instead);
  const Suggestion suggestion = suggest("unknown effect", name, names);
  reader.fail(suggestion.problem, suggestion.remedy);
}

}  // namespace

void read_effects(const YamlReader& block, Scene& scene) {
  std::vector<std::pair<std::string, YamlReader>> entries = block.named();
  // The order of effects is that of their names: it must not depend on how the file was written.
  std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [name, reader] : entries) read_effect(name, reader, scene);
}

}  // namespace repose
