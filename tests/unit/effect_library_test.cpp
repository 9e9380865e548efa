#include "core/effect_library.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/error.hpp"
#include "core/scene_yaml.hpp"
#include "tests/support/model_builder.hpp"

namespace repose {
namespace {

// The names and parameters that are fixed outside the project.
TEST(EffectLibrary, HoldsEveryNameAndParameter) {
  const std::map<std::string, std::vector<std::string>> wanted{
      {"linear_drag", {"viscosity"}},
      {"quadratic_drag", {"coefficient", "fluid_density"}},
      {"finite_reynolds_drag", {"viscosity", "fluid_density"}},
      {"magnus", {"lift", "fluid_density"}},
      {"uniform_force", {"force"}},
      {"gravity_tilt", {"x_deg", "y_deg"}},
      {"buoyancy", {"fluid_density"}},
      {"periodic_force", {"amplitude", "frequency", "phase"}},
      {"friction", {"friction"}},
      {"rolling_friction", {"rolling_friction"}},
      {"spinning_friction", {"spinning_friction"}},
      {"restitution", {"restitution"}},
      {"cohesion", {"cohesion"}},
      {"wall_friction", {"friction"}},
      {"rate_dependent_friction", {"slope", "reference_speed"}},
      {"anisotropic_friction", {"ratio", "direction_deg"}},
      {"rate_dependent_restitution", {"exponent", "reference_speed"}},
      {"liquid_bridge", {"force", "rupture"}},
      {"contact_compliance", {"stiffness", "damping"}},
      {"thermal_softening", {"temperature", "scale"}},
      {"base_vibration", {"amplitude", "frequency", "phase"}},
      {"moving_wall_speed", {"factor"}},
      {"grain_shape", {"aspect"}},
      {"size_distribution", {"mean_factor", "sd_factor"}},
      {"inertia", {"factor"}},
      {"center_of_mass_offset", {"offset"}},
      {"length_scale", {"factor"}},
      {"time_scale", {"factor"}},
      {"time_offset", {"offset"}},
      {"frame_tilt", {"x_deg", "y_deg"}},
      {"sensor_bias", {"bias"}},
      {"time_step", {}},
      {"solver_tolerance", {}},
      {"engine_law", {}}};
  std::map<std::string, std::vector<std::string>> found;
  for (const EffectRow& row : effect_library()) {
    EXPECT_FALSE(row.claim.empty() || row.moves.empty()) << row.name;
    EXPECT_EQ(row.keys.empty(), row.site == EffectSite::measurement) << row.name;
    for (const EffectParameter& p : row.parameters) {
      found[row.name].push_back(p.name);
      EXPECT_LT(p.lower, p.upper) << row.name << "." << p.name;
      EXPECT_TRUE(!p.log_scaled || p.lower > 0) << row.name << "." << p.name;
      EXPECT_FALSE(p.unit.empty());
    }
    if (row.parameters.empty()) found[row.name] = {};
    EXPECT_EQ(find_effect(row.name), &row);
  }
  EXPECT_EQ(found, wanted);
  EXPECT_EQ(find_effect("colour"), nullptr);
}

TEST(EffectLibrary, NaturalBoundsFollowTheScene) {
  const Model model = test::ModelBuilder()
                          .material("grain", 1000)
                          .floor("grain")
                          .sphere("grain", 0.01, {.position = {0, 0, 1}})
                          .sphere("grain", 0.03, {.position = {1, 0, 1}})
                          .gravity({0, 0, -2})
                          .build();
  const NaturalScale scale = natural_scale(model);
  EXPECT_DOUBLE_EQ(scale.length, 0.02);
  EXPECT_DOUBLE_EQ(scale.mass, 0.5 * (model.bodies[1].mass + model.bodies[2].mass));
  EXPECT_DOUBLE_EQ(scale.time, 0.1);
  const EffectParameter& force = find_effect("uniform_force")->parameters[0];
  EXPECT_NEAR(bounds_of(force, scale).upper, 2 * scale.mass * 2, 1e-15);
  const EffectParameter& viscosity = find_effect("linear_drag")->parameters[0];
  EXPECT_EQ(bounds_of(viscosity, scale).upper, viscosity.upper);
}

const char* const scene_text = R"(
materials: {grain: {density: 1000}, steel: {density: 7800}, wood: {density: 600}}
pairs: {grain-grain: {friction: 0.5}, grain-steel: {friction: 0.2}, grain-wood: {friction: 0.3}}
shapes: {ball: {type: sphere, radius: 0.01}}
bodies:
  one: {shape: ball, material: grain, position: [0, 0, 1]}
  two: {shape: ball, material: wood, position: [0, 1, 1]}
tools: {floor: {type: floor, material: steel}}
duration: 1
)";

TEST(EffectLibrary, PlacesArePairsOfTheScene) {
  const Scene scene = parse_scene(scene_text, "test");
  EXPECT_EQ(places_of(*find_effect("friction"), scene),
            (std::vector<std::string>{"grain-grain", "grain-steel", "grain-wood"}));
  EXPECT_EQ(places_of(*find_effect("wall_friction"), scene), std::vector<std::string>{"grain-steel"});
  EXPECT_TRUE(places_of(*find_effect("linear_drag"), scene).empty());
}

TEST(EffectLibrary, EditsReadBackExactly) {
  const double odd = 0.1 + 0.2, tiny = 1.0 / 3e9;
  std::vector<Override> changes;
  for (const auto& [path, value] :
       edits(*find_effect("rolling_friction"), std::vector<std::vector<double>>{{odd}}, "grain-steel"))
    changes.push_back({path, value});
  for (const auto& [path, value] :
       edits(*find_effect("uniform_force"), std::vector<std::vector<double>>{{tiny, -odd, 0}}))
    changes.push_back({path, value});
  const Scene scene = parse_scene(scene_text, "test", changes);
  EXPECT_EQ((scene.pairs.at({"grain", "steel"}).rolling_friction), odd);
  ASSERT_EQ(scene.effects.size(), 1u);
  EXPECT_EQ(std::get<UniformForce>(scene.effects[0]).force, Vec3(tiny, -odd, 0));
}

TEST(EffectLibrary, EditsRefuseWhatDoesNotFit) {
  using Values = std::vector<std::vector<double>>;
  EXPECT_THROW(edits(*find_effect("magnus"), Values{{1}}), Error);
  EXPECT_THROW(edits(*find_effect("uniform_force"), Values{{1}}), Error);
  EXPECT_THROW(edits(*find_effect("length_scale"), Values{{1}}), Error);
  EXPECT_THROW(edits(*find_effect("friction"), Values{{1}}), Error);
}

}  // namespace
}  // namespace repose
