#include "core/scene_yaml.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <set>

#include "core/error.hpp"
#include "core/yaml_tree.hpp"

namespace repose {
namespace {

const std::string good = R"(materials: {pa12: {density: 1.02 g/cm3}, steel: {density: 7800}}
pairs:
  pa12-pa12: {friction: 0.52, rolling_friction: 0.05, friction_arm: mean_radius, cohesion: 2 nN, cohesion_range: 0.1 um}
  pa12-steel: {friction: 1.0, restitution: 0.5}
shapes:
  ball: {type: sphere, radius: 2 cm}
  dimer: {type: compound, parts: [{type: sphere, radius: 1}, {type: sphere, radius: 1, position: [1, 0, 0]}]}
  grain: {type: twin, size: 58 um}
  ground: {type: half_space, normal: [0, 0, 2]}
bodies:
  ball: {shape: ball, material: pa12, position: [0, 0, 1], angular_velocity: [0, 60 rpm, 0], mass: 2 g}
  a_floor: {shape: ground, material: steel, fixed: true}
grains:
  powder:
    material: pa12
    count: 1e2
    mix: {sphere: 1, twin: 3}
    size: {normal: [58 um, 15 um], range: [30 um, 100 um]}
    fill: {cylinder: {base: [0, 0, 0], radius: 1 mm, height: 2 mm}, grow: false}
tools:
  funnel: {material: steel, outlet_diameter: 1 mm, top_diameter: 3 mm, thickness: 0.1 mm, opens: 0.1, half_angle_deg: 30}
  left: {type: plate, material: steel, size: [1, 1, 0.1], motion: {velocity: [0, 0, 1], vibration_phase_deg: 90}}
effects: {quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}, gravity_tilt: {x_deg: 5}}
solver: {time_step: 1.0e-4, tolerance: 1.0e-3, method: apgd, law: relaxed, max_iterations: 50}
duration: 2.0
record: {rate: 200, noise: {position: 1.0e-4}, observables: [{kind: trajectory, body: ball}]}
)";

Scene parse(const std::string& text, const std::vector<Override>& overrides = {}) {
  return parse_scene(text, "scene.yaml", overrides);
}

TEST(SceneYaml, ReadsEveryBlock) {
  const Scene scene = parse(good);
  EXPECT_DOUBLE_EQ(scene.materials.at("pa12").density, 1020);
  const PairLaw& law = scene.pairs.at({"pa12", "pa12"});
  EXPECT_EQ(law.friction, 0.52);
  EXPECT_EQ(law.friction_arm, FrictionArm::mean_radius);
  EXPECT_DOUBLE_EQ(law.cohesion, 2e-9);
  EXPECT_EQ(scene.pairs.at({"pa12", "steel"}).restitution, 0.5);

  ASSERT_EQ(scene.bodies.size(), 2U);
  EXPECT_EQ(scene.bodies[0].name, "a_floor");
  EXPECT_TRUE(scene.bodies[0].fixed);
  EXPECT_DOUBLE_EQ(scene.bodies[1].angular_velocity.y(), 2 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(*scene.bodies[1].mass, 2e-3);

  ASSERT_EQ(scene.grains.size(), 1U);
  const GrainPopulation& powder = scene.grains[0];
  EXPECT_EQ(powder.count, 100U);
  EXPECT_EQ(powder.mix.at("twin"), 3);
  EXPECT_DOUBLE_EQ(std::get<NormalSize>(powder.size.law).mean, 58e-6);
  EXPECT_FALSE(powder.fill.grow);
  EXPECT_DOUBLE_EQ(powder.fill.radius_top, 1e-3);

  ASSERT_EQ(scene.tools.size(), 2U);
  const Funnel& funnel = std::get<Funnel>(scene.tools[0].kind);
  EXPECT_DOUBLE_EQ(funnel.outlet_diameter, 1e-3);
  EXPECT_EQ(funnel.half_angle_deg, 30);
  EXPECT_DOUBLE_EQ(scene.tools[1].motion.vibration_phase, std::numbers::pi / 2);

  ASSERT_EQ(scene.effects.size(), 2U);
  EXPECT_EQ(std::get<GravityTilt>(scene.effects[0]).x_deg, 5);
  EXPECT_EQ(scene.solver.kind, SolverKind::apgd);
  EXPECT_EQ(scene.solver.law, ContactLaw::relaxed);
  EXPECT_EQ(scene.solver.max_iterations, 50);
  EXPECT_EQ(scene.duration, 2);
  EXPECT_EQ(scene.frame_interval, 0.02);
}

TEST(SceneYaml, GrainShapesScaleWithTheirSize) {
  const Scene scene = parse(good);
  const double volume = std::numbers::pi / 6 * std::pow(58e-6, 3);
  EXPECT_NEAR(scene.shapes.at("grain").mass.volume / volume, 1, 1e-12);
  EXPECT_EQ(std::get<HalfSpace>(scene.shapes.at("ground").parts[0].primitive).normal, Vec3(0, 0, 1));
}

TEST(SceneYaml, ResolvedTextReadsBackToItself) {
  const Scene scene = parse(good, {{"duration", "3 s"}});
  const Scene again = parse(scene.text);
  EXPECT_EQ(again.duration, 3);
  EXPECT_EQ(again.text, scene.text);
}

TEST(SceneYaml, ResolvedTextCanBeReadInAnyFolder) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "scene_yaml_alone";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "sizes.csv") << "diameter\n58 um\n70 um\n";
  std::ofstream(folder / "tetra.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const Scene scene = parse_scene("materials: {a: {density: 1000}}\nshapes: {m: {type: mesh, file: tetra.obj}}\nbodies: {b: {shape: m, material: a}}\n"
                                  "grains: {g: {material: a, count: 3, mix: {sphere: 1}, size: {table: sizes.csv}, fill: {box: {lower: [0, 0, 0], upper: [1, 1, 1]}}}}\n"
                                  "duration: 1\n", "scene.yaml", {}, folder);
  const Scene again = parse(scene.text);  // from here
  EXPECT_NEAR(again.shapes.at("m").mass.volume, 1.0 / 6, 1e-12);
  EXPECT_EQ(std::get<TableSize>(again.grains.at(0).size.law).values, (std::vector<double>{58e-6, 70e-6}));
  EXPECT_EQ(again.text, scene.text);
}

TEST(YamlTree, APathMayHoldTheIndexOfASequence) {
  const YamlNode tree = parse_yaml("gravity: [0, 1, -9.81]\nbodies: {a: {mass: 2}}\n", "tree");
  ASSERT_NE(node_at(tree, "gravity.2"), nullptr);
  EXPECT_EQ(node_at(tree, "gravity.2")->text, "-9.81");
  EXPECT_EQ(node_at(tree, "gravity.3"), nullptr);
  EXPECT_EQ(node_at(tree, "gravity.x"), nullptr);
  EXPECT_EQ(node_at(tree, "bodies.a.mass.0"), nullptr);
}

TEST(YamlTree, KeysAreTheSameForEqualTreesAlone) {
  const auto key = [](const std::string& text) { return tree_key(parse_yaml(text, "text")); };
  EXPECT_EQ(key("a: [1, 2]\nb: 3\n"), key("# moved down\n\na: [1, 2]\nb: 3\n"));
  std::set<std::string> keys;
  const std::vector<std::string> texts{"a: [1, 2]\nb: 3", "a: [1]\nb: 3", "a: [[1, 2]]\nb: 3", "a: [12]\nb: 3", "a: {1: 2}\nb: 3",
                                       "a: \nb: 3",        "a: ''\nb: 3",  "b: 3\na: [1, 2]",   "ab: 3",          "a: [1, 2, b, 3]"};
  for (const std::string& text : texts) keys.insert(key(text));
  EXPECT_EQ(keys.size(), texts.size());
}

TEST(SceneYaml, OverridesReplaceAndAdd) {
  const Scene scene = parse(good, {{"pairs.pa12-pa12.rolling_friction", "0.1"},
                                   {"bodies.ball.position", "[0, 0, 2]"},
                                   {"bodies.ball.position.0", "5 cm"},
                                   {"effects.linear_drag.viscosity", "1.8e-5"},
                                   {"pairs.steel-steel.friction", "0.3"}});
  EXPECT_EQ(scene.pairs.at({"pa12", "pa12"}).rolling_friction, 0.1);
  EXPECT_EQ(scene.bodies[1].position, Vec3(0.05, 0, 2));
  EXPECT_EQ(scene.effects.size(), 3U);
  EXPECT_EQ(scene.pairs.at({"steel", "steel"}).friction, 0.3);
}

/// The message for `good` with `from` replaced by `to`; "accepted" if it has none.
std::string message(const std::string& from, const std::string& to) {
  std::string text = good;
  const std::size_t at = text.find(from);
  if (at == std::string::npos) return "nothing to replace: " + from;
  text.replace(at, from.size(), to);
  try {
    parse(text);
  } catch (const Error& error) {
    EXPECT_FALSE(error.remedy().empty()) << to;
    EXPECT_EQ(error.kind(), Error::Kind::input);
    return error.what();
  }
  return "accepted";
}

TEST(SceneYaml, MessagesNameLineKeyAndNearestKey) {
  EXPECT_EQ(message("    size: {", "    siez: {"),
            "scene.yaml:18: grains.powder.siez: unknown key; did you mean `size`?\n"
            "  keys here: material, count, mass, mix, mix_by, aspect, size, fill, velocity");
  const struct {
    const char *from, *to, *part;
  } cases[] = {
      {"count: 1e2", "count: 1.5", "scene.yaml:16: grains.powder.count: is `1.5`; expected a whole number"},
      {"count: 1e2", "count: -5", "must be positive"},
      {"count: 1e2", "count: [1]", "is a list of 1; expected a number"},
      {"count: 1e2", "count:", "empty; expected a number"},
      {"count: 1e2", "mass: 1 m", "is in m; expected kg"},
      {"radius: 2 cm", "radius: .nan", "`.nan` is not a finite number"},
      {"radius: 2 cm", "radius: -2 cm", "must be positive"},
      {"radius: 2 cm", "radius: two", "`two` is not a number"},
      {"radius: 2 cm", "radius: 1, radius: 2", "key `radius` is given twice"},
      {"type: sphere, radius: 2 cm", "type: shpere, radius: 2 cm", "did you mean `sphere`?"},
      {"type: sphere, radius: 2 cm", "type: sphere", "key `radius` is missing"},
      {"shape: ball,", "shape: bal,", "no such shape: `bal`; did you mean `ball`?"},
      {"material: pa12, position", "material: pa21, position", "did you mean `pa12`?"},
      {"position: [0, 0, 1]", "position: [0, 0]", "is a list of 2; expected a list of 3 numbers"},
      {"pa12-steel:", "steel-pa12:", "write `pa12-steel`"},
      {"pa12-steel:", "pa12-stel:", "did you mean `pa12-steel`?"},
      {"restitution: 0.5", "restitution: 1.5", "at least 0 and at most 1"},
      {"fixed: true", "fixed: maybe", "expected true or false"},
      {", fixed: true", "", "is infinite"},
      {"{quadratic_drag:", "{length_scale: {}, quadratic_drag:", "known, but not available"},
      {"{quadratic_drag:", "{friction: 1, quadratic_drag:", "under `pairs:"},
      {"{quadratic_drag:", "{quadratic_darg:", "did you mean `quadratic_drag`?"},
      {"30 um, 100 um", "100 um, 30 um", "smallest size is not below the largest"},
      {"30 um, 100 um", "30 mm, 100 mm", "outside this range"},
      {"top_diameter: 3 mm", "top_diameter: 0.5 mm", "is not above `outlet_diameter`"},
      {"half_angle_deg: 30", "half_angle_deg: 95", "below 90 deg"},
      {"top_diameter: 3 mm", "yield: {load: 1 N, mass: 1 g}, top_diameter: 3 mm", "pieces cannot yield as one"},
      {"  left: {type: plate", "  left: {yield: {load: 1 N}, type: plate", "key `mass` is missing"},
      {"  left: {type: plate", "  left: {yield: {load: -1 N, mass: 1 g}, type: plate", "tools.left.yield.load"},
      {"  left: {type: plate", "  left: {yield: {load: 1 N, mass: 1 N}, type: plate", "is in N; expected kg"},
      {"  left: {type: plate", "  left: {type: plat", "did you mean `plate`?"},
      {"  left: {type: plate, ", "  left: {", "needs `type: ...`"},
      {"method: apgd", "method: agpd", "did you mean `apgd`?"},
      {"duration: 2.0", "", "key `duration` is missing"},
      {"duration: 2.0", "durration: 2.0", "did you mean `duration`?"},
      {"duration: 2.0", "duration: 0", "must be positive"},
      {"duration: 2.0", "duration: 2 s\n---\nduration: 2", "second YAML document"},
      {"rate: 200", "rates: 200", "did you mean `rate`?"},
      {"duration: 2.0", "duration: 2.0\ngrain_shapes: {twin_distance: 2.5}", "grain_shapes"},
      {"  ball: {shape", "  left: {shape", "same name"},
      {"velocity: [0, 0, 1], ", "velocity: [0, 0, 1], vibration_amplitude: [0, 0, 1 um], ", "needs its frequency"},
      {"pairs:\n", "pairs: [\n", "not valid YAML"},
  };
  for (const auto& c : cases) EXPECT_NE(message(c.from, c.to).find(c.part), std::string::npos) << message(c.from, c.to);
}

TEST(SceneYaml, BadOverridesNameThemselves) {
  const struct {
    const char *path, *value, *part;
  } cases[] = {
      {"grains.powdr.count", "5", "--set grains.powdr.count: `grains` has no `powdr`; did you mean `powder`?"},
      {"grains.powder.cuont", "5", "--set grains.powder.cuont: unknown key; did you mean `count`?"},
      {"grains.powder.count", "five", "--set grains.powder.count: `five` is not a number"},
      {"bodies.ball.position.3", "5", "not an index of a list of 3"},
      {"duration.x", "5", "inside a plain value"},
      {"a..b", "5", "empty part"},
      {"duration", "", "--set duration: empty"},
      {"duration", "[1", "not valid YAML"},
  };
  for (const auto& c : cases) {
    try {
      parse(good, {{c.path, c.value}});
      ADD_FAILURE() << c.path;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(c.part), std::string::npos) << error.what();
    }
  }
}

TEST(SceneYaml, TextsThatAreNoScenesAreRefused) {
  for (const std::string& text :
       {std::string(), std::string("\n\n"), std::string("# only a comment\n"), std::string("hello"),
        std::string("[1, 2]"), std::string("\0\0", 2), std::string("a: &x [*x]"), std::string(100000, '['),
        std::string(100000, '{'), std::string("%PDF-1.4"), std::string("? [a, b] : 1"), std::string("a: *nobody"),
        std::string("\t- x"), std::string("materials: 3\nduration: 1")})
    EXPECT_THROW(parse(text), Error) << text.substr(0, 40);
}

TEST(SceneYaml, AliasesCannotBlowUp) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 10; ++k) text += (k > 0 ? ", *a" : "*a") + std::to_string(i - 1);
    text += "]\n";
  }
  EXPECT_THROW(parse_yaml(text, "bomb"), Error);
}

TEST(SceneYaml, FilesAreNamedInMessages) {
  EXPECT_THROW(load_scene("no_such_scene.yaml"), Error);
  EXPECT_THROW(load_scene("."), Error);
}

TEST(SceneYaml, SidesOfALayerArePeriodicOrWalls) {
  const auto layer = [](const std::string& sides, const std::string& more = "") {
    return parse("materials: {a: {density: 1000}}\nbodies: {}\ngrains: {p: {material: a, count: 1, size: 50 um, fill: {box: {lower: [0, 0, 0], upper: "
                 "[1 mm, 1 mm, 1 mm]}}}}\ntools: {r: {type: roller, material: a, diameter: 10 mm, width: 1 mm}}\nduration: 1\nlayer: {spreader: r, gap: "
                 "50 um, speed: 1 mm/s, to: 1 mm, settle: 1, settle_time_step: 1.0e-4, region: {lower: [0, 0], upper: [1 mm, 1 mm]}, surface: {cell: 5 um, "
                 "square: 50 um}, sides: " + sides + "}\n" + more);
  };
  const Scene cell = layer("{kind: periodic, y: [-1 mm, 2 mm]}");
  EXPECT_FALSE(cell.periodic.along(0));
  EXPECT_DOUBLE_EQ(cell.periodic.lower.y(), -1e-3);
  EXPECT_DOUBLE_EQ(cell.periodic.length(1), 3e-3);
  EXPECT_EQ(cell.tools.size(), 1U);
  EXPECT_TRUE(layer("{kind: periodic, y: [-1 mm, 2 mm]}", "periodic: {x: [0, 1]}\n").periodic.along(0));
  EXPECT_THROW(layer("{kind: periodic, y: [-1 mm, 2 mm]}", "periodic: {y: [0, 1]}\n"), Error);
  EXPECT_THROW(layer("{kind: periodic, y: [2 mm, -1 mm]}"), Error);
  EXPECT_THROW(layer("{kind: periodic, material: a, y: [-1 mm, 2 mm]}"), Error);
  EXPECT_THROW(layer("{kind: periodic, y: [0.1 mm, 2 mm]}"), Error);  // narrower than the region
  const Scene walls = layer("{kind: walls, material: a, x: [0, 1 mm], y: [0, 1 mm], z: [0, 1 mm]}");
  EXPECT_FALSE(walls.periodic.any());
  EXPECT_EQ(walls.tools.size(), 3U);
}

// A filter that the grid cannot hold makes a roughness of nothing: refused before anything is simulated, with what mends it.
TEST(SceneYaml, FiltersOfALayerFitItsGrid) {
  const auto layer = [](const std::string& filters) {
    return parse("materials: {a: {density: 1000}}\nbodies: {}\ngrains: {p: {material: a, count: 1, size: 50 um, fill: {box: {lower: [0, 0, 0], upper: "
                 "[1 mm, 1 mm, 1 mm]}}}}\ntools: {r: {type: roller, material: a, diameter: 10 mm, width: 1 mm}}\nduration: 1\nlayer: {spreader: r, gap: "
                 "50 um, speed: 1 mm/s, to: 1 mm, settle: 1, settle_time_step: 1.0e-4, region: {lower: [0, 0], upper: [1 mm, 1 mm]}, surface: {cell: 5 um, "
                 "square: 50 um, " + filters + "}}\n");
  };
  const Scene scene = layer("s_filter: 15 um, l_filter: 500 um");
  EXPECT_DOUBLE_EQ(scene.layer->s_filter, 15e-6);
  EXPECT_DOUBLE_EQ(scene.layer->l_filter, 500e-6);
  EXPECT_NO_THROW(layer("s_filter: 0, l_filter: 0"));
  const std::vector<double> further = layer("further_squares: [0.1 mm, 200 um]").layer->further_squares;
  ASSERT_EQ(further.size(), 2U);
  EXPECT_DOUBLE_EQ(further[0], 1e-4);
  EXPECT_DOUBLE_EQ(further[1], 2e-4);
  EXPECT_THROW(layer("further_squares: [2 mm]"), Error);
  EXPECT_THROW(layer("further_squares: 0.1 mm"), Error);
  EXPECT_THROW(layer("further_squares: [50 um]"), Error);
  EXPECT_THROW(layer("further_squares: [0.1 mm, 100 um]"), Error);
  for (const char* nonsense : {"s_filter: 14 um", "l_filter: 1 um", "l_filter: 14 um", "s_filter: 50 um, l_filter: 50 um", "s_filter: 1.1 mm", "s_filter: -20 um", "l_filter: 1 s"}) {
    try {
      layer(nonsense);
      ADD_FAILURE() << nonsense;
    } catch (const Error& e) {
      EXPECT_NE(e.place().find("_filter"), std::string::npos) << nonsense << ": " << e.place();
      EXPECT_FALSE(e.remedy().empty()) << nonsense;
    }
  }
}

TEST(SceneYaml, ReadsMeshesAndRefusesBrokenOnes) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "scene_yaml_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "tetra.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1/1 4/2 3/3\nf -3 -2 -1\n";
  std::ofstream(folder / "bad.obj") << "v 0 0 0\nv 1 0 0\nf 1 2 9\n";
  const auto scene = [&](const std::string& file) {
    return parse_scene("materials: {a: {density: 1000}}\nshapes: {m: {type: mesh, file: " + file +
                           "}}\nbodies: {b: {shape: m, material: a}}\nduration: 1\n",
                       "scene.yaml", {}, folder);
  };
  EXPECT_NEAR(scene("tetra.obj").shapes.at("m").mass.volume, 1.0 / 6, 1e-12);
  try {
    scene("bad.obj");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("bad.obj:3"), std::string::npos) << error.what();
  }
  EXPECT_THROW(scene("absent.obj"), Error);
}

}  // namespace
}  // namespace repose
