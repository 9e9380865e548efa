#include "core/error.hpp"
#include "core/scene_yaml_blocks.hpp"
#include "core/setup_effects.hpp"

namespace repose {
namespace {

struct SetupKind {
  std::string name;
  void (*read)(const YamlReader&, Scene&);
};

void read_base_vibration(const YamlReader& reader, Scene& scene) {
  reader.only({"amplitude", "frequency", "phase"});
  BaseVibration effect;
  reader.require("amplitude", effect.amplitude, non_negative(dimension::length));
  reader.require("frequency", effect.frequency, non_negative(dimension::frequency));
  reader.read("phase", effect.phase, any(dimension::angle));
  apply(effect, scene);
}

void read_moving_wall_speed(const YamlReader& reader, Scene& scene) {
  reader.only({"factor"});
  MovingWallSpeed effect;
  reader.require("factor", effect.factor, any(dimension::none));
  apply(effect, scene);
}

void read_grain_shape(const YamlReader& reader, Scene& scene) {
  reader.only({"aspect"});
  GrainShapeFactor effect;
  reader.require("aspect", effect.aspect, positive(dimension::none));
  apply(effect, scene);
}

void read_size_distribution(const YamlReader& reader, Scene& scene) {
  reader.only({"mean_factor", "sd_factor"});
  SizeDistributionFactors effect;
  reader.read("mean_factor", effect.mean_factor, positive(dimension::none));
  reader.read("sd_factor", effect.sd_factor, positive(dimension::none));
  apply(effect, scene);
}

void read_inertia(const YamlReader& reader, Scene& scene) {
  reader.only({"factor"});
  InertiaFactor effect;
  const YamlReader factor = reader.at("factor");
  if (factor.node().kind == YamlNode::Kind::sequence) {
    effect.factor = factor.vector(positive(dimension::none));
  } else {
    effect.factor = Vec3::Constant(factor.number(positive(dimension::none)));
  }
  apply(effect, scene);
}

void read_center_of_mass_offset(const YamlReader& reader, Scene& scene) {
  reader.only({"offset"});
  CenterOfMassOffset effect;
  reader.require("offset", effect.offset, any(dimension::length));
  apply(effect, scene);
}

void read_thermal_softening(const YamlReader& reader, Scene& scene) {
  reader.only({"temperature", "scale"});
  ThermalSoftening effect;
  reader.require("temperature", effect.temperature, positive(dimension::temperature));
  reader.require("scale", effect.scale, any(dimension::temperature));
  if (effect.scale == 0) reader.at("scale").fail("a scale of zero", "give the rise in K that changes cohesion e-fold");
  apply(effect, scene);
}

void read_wall_friction(const YamlReader& reader, Scene& scene) {
  reader.only({"friction"});
  WallFriction effect;
  reader.require("friction", effect.friction, non_negative(dimension::none));
  apply(effect, scene);
}

const std::vector<SetupKind>& setup_kinds() {
  static const std::vector<SetupKind> table{{"base_vibration", read_base_vibration},
                                            {"moving_wall_speed", read_moving_wall_speed},
                                            {"grain_shape", read_grain_shape},
                                            {"size_distribution", read_size_distribution},
                                            {"inertia", read_inertia},
                                            {"center_of_mass_offset", read_center_of_mass_offset},
                                            {"thermal_softening", read_thermal_softening},
                                            {"wall_friction", read_wall_friction}};
  return table;
}

}  // namespace

std::vector<std::string> setup_effect_names() {
  std::vector<std::string> names;
  for (const SetupKind& kind : setup_kinds()) names.push_back(kind.name);
  return names;
}

bool read_setup_effect(const std::string& name, const YamlReader& reader, Scene& scene) {
  for (const SetupKind& kind : setup_kinds()) {
    if (kind.name != name) continue;
    try {
      kind.read(reader, scene);
    } catch (const Error& error) {
      // What `apply` refuses gets the place in the file; what the reader refused has it.
      if (error.place().starts_with("effects.")) reader.fail(error.problem(), error.remedy());
      throw;
    }
    return true;
  }
  return false;
}

}  // namespace repose
