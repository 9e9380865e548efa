#include "scenarios/spreading.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/error.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/bed.hpp"
#include "scenarios/layer_json.hpp"
#include "scenarios/layer_measurement.hpp"

namespace repose {
namespace {

constexpr double settled_at = 0.08;  // [s]

std::size_t tool(const Model& model, const std::string& name) {
  const auto found = model.find_body(name);
  EXPECT_GE(found, 0) << name;
  return static_cast<std::size_t>(found);
}

Pose placed(const Model& model, std::size_t body, double t) {
  return pose_at(model.bodies[body].motion, {model.initial.position[body], model.initial.orientation[body]}, t);
}

// A wall that comes down and shakes while the bed settles: when the spreader starts it is where it was, and goes on.
TEST(Spreading, GoesOnFromWhereTheWallsWere) {
  const Scene scene = load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer-quick.yaml",
                                 {{"tools.far_end.motion", "{velocity: [0, 0, -1 mm/s], start: 20 ms, stop: 120 ms, vibration_amplitude: [5 um, 0, 0], vibration_frequency: 30 Hz}"}});
  Options options;
  const Model bed = prepare_quietly(bed_scene(scene), options).model;
  Snapshot settled = bed.initial;
  settled.time = settled_at;
  const Model spread = over_the_bed(scene, bed, settled, options).prepared.model;
  const std::size_t before = tool(bed, "far_end"), after = tool(spread, "far_end");
  for (const double t : {0.0, 0.01, 0.04, 0.2}) EXPECT_TRUE(placed(spread, after, t).position.isApprox(placed(bed, before, settled_at + t).position, 1e-12)) << t;
  EXPECT_EQ(placed(spread, tool(spread, "near_end"), 0.3).position, placed(bed, tool(bed, "near_end"), 0).position);
  // The spreader's own clock begins with the spreading.
  const std::size_t roller = tool(spread, "roller");
  EXPECT_EQ(placed(spread, roller, 0).position, spread.initial.position[roller]);
  EXPECT_NEAR(placed(spread, roller, 0.01).position.x() - spread.initial.position[roller].x(), 0.01 * scene.layer->speed, 1e-12);
}

/// The quick layer with few grains, for what does not depend on them.
Scene few_grains(const std::vector<Override>& overrides = {}) {
  std::vector<Override> all{{"grains.bed.count", "20"}, {"grains.pile.count", "10"}};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer-quick.yaml", all);
}

/// The path over the bed as it was at the start, `time` after.
SpreaderPath path_over(const Scene& scene, double surface, double time = 0) {
  const Model bed = realise(bed_scene(scene), 1);
  Snapshot settled = bed.initial;
  settled.time = time;
  return spreader_path(scene, bed, settled, surface);
}

/// Refused because the spreader would cut into something.
bool refused(const Scene& scene, double surface) {
  try {
    path_over(scene, surface);
    return false;
  } catch (const Error& e) {
    EXPECT_EQ(e.place(), "layer.gap");
    return true;
  }
}

// A plate that comes down while the bed settles is out of the way, one that rises is in it.
TEST(Spreading, IsRefusedWhereWallsAreWhenItStarts) {
  Scene scene = few_grains();
  constexpr double surface = 2e-3;  // [m], above all grains
  scene.layer->from = -1e-3;
  const double lowest = scene.layer->plate + surface + scene.layer->gap;
  for (const double up : {-1.0, 1.0}) {
    Scene with = scene;
    Tool fin{"fin", "steel", Plate{{1e-4, 1e-4, 5e-4}}, {1.5e-3, 0, lowest - up * 2e-4}, {}};
    fin.motion.velocity = Vec3(0, 0, up * 4e-4 / settled_at);
    with.tools.push_back(fin);
    if (up < 0)
      EXPECT_NO_THROW(path_over(with, surface, settled_at));
    else
      EXPECT_THROW(path_over(with, surface, settled_at), Error);
  }
}

// A plate in the way is found however thin it and the spreader are beside the travel.
TEST(Spreading, IsRefusedWhereItWouldCutIntoAThinPlate) {
  Scene scene = few_grains();
  constexpr double surface = 2e-3;  // [m], above all grains
  scene.layer->from = -1e-3;
  const double lowest = scene.layer->plate + surface + scene.layer->gap;
  Tool fin{"fin", "steel", Plate{{2e-6, 1e-4, 5e-4}}, {}, {}};
  const auto cuts = [&](double x, double top) {
    Scene with = scene;
    fin.position = {x, 0, top};
    with.tools.push_back(fin);
    return refused(with, surface);
  };
  for (const bool blade : {false, true}) {
    if (blade) std::find_if(scene.tools.begin(), scene.tools.end(), [](const Tool& t) { return t.name == "roller"; })->kind = Blade{1e-5, 1e-3, 1.1e-3};
    for (const double x : {-0.7e-3, 0.7e-3, 1.03e-3, 2.5e-3}) {
      EXPECT_TRUE(cuts(x, lowest + 1e-6)) << blade << " " << x;
      EXPECT_TRUE(cuts(x, lowest + 2e-4)) << blade << " " << x;
      EXPECT_FALSE(cuts(x, lowest - 1e-6)) << blade << " " << x;
    }
    EXPECT_FALSE(blade && cuts(3e-3, lowest + 1e-4)) << "beyond the end";
  }
}

// A body that does not move is in the way as a tool is; one that moves freely is pushed.
TEST(Spreading, IsRefusedWhereItWouldCutIntoAFixedBody) {
  constexpr double surface = 2e-3;  // [m], above all grains
  Scene scene = few_grains({{"shapes", "{block: {type: box, size: [40 um, 40 um, 100 um]}}"},
                            {"bodies", "{post: {shape: block, material: steel, fixed: true, position: [1.2 mm, 0, 1 mm]}}"}});
  scene.layer->from = -1e-3;
  const double lowest = scene.layer->plate + surface + scene.layer->gap;
  SceneBody& post = scene.bodies.at(0);
  const auto cuts = [&](double top) {
    post.position.z() = top - 5e-5;
    return refused(scene, surface);
  };
  EXPECT_TRUE(cuts(lowest + 1e-5));
  EXPECT_TRUE(cuts(lowest + 7e-5));
  EXPECT_FALSE(cuts(lowest - 1e-6));
  post.fixed = false;
  post.material = "pa12";
  EXPECT_FALSE(cuts(lowest + 1e-5));
}

// The gap is above the bed or above the plate.
TEST(Spreading, KeepsItsGapToWhatTheSceneSays) {
  Scene scene = few_grains({{"layer.plate", "0.05 mm"}, {"layer.gap", "0.7 mm"}});
  const double plate = scene.layer->plate, gap = scene.layer->gap;
  constexpr double surface = 0.4e-3;
  EXPECT_NEAR(path_over(scene, surface).lowest, plate + surface + gap, 1e-15);
  scene.layer->gap_from = LayerSetup::GapFrom::plate;
  const SpreaderPath path = path_over(scene, surface);
  EXPECT_NEAR(path.lowest, plate + gap, 1e-15);
  const Model spread = realise(spreading_scene(scene, path), 1);
  const std::size_t roller = tool(spread, "roller");
  EXPECT_NEAR(spread.initial.position[roller].z() - 0.5 * std::get<Roller>(spreader_of(scene).kind).diameter, plate + gap, 1e-12);
}

// What of the roller is lowest stands still if it rolls, and goes twice as fast as its axis if it counter-rotates.
TEST(Spreading, TurnsTheRollerTheWayThatIsSaid) {
  Scene scene = few_grains();
  scene.layer->from = -1e-3;
  const double speed = scene.layer->speed;
  const auto lowest_moves = [&](LayerSetup::Rotation rotation, double ratio) {
    scene.layer->rotation = rotation;
    scene.layer->rotation_ratio = ratio;
    const SpreaderPath path = path_over(scene, 2e-3);
    const Model spread = realise(spreading_scene(scene, path), 1);
    const std::size_t roller = tool(spread, "roller");
    constexpr double t = 1e-6;  // [s]
    const Pose before = placed(spread, roller, 0), after = placed(spread, roller, t);
    const Vec3 lowest(path.from, before.position.y(), path.lowest);
    const Vec3 own = before.orientation.conjugate() * (lowest - before.position);
    return Vec3((after.to_world(own) - lowest) / t);
  };
  const auto expect = [&](const Vec3& moves, double along) {
    EXPECT_NEAR(moves.x(), along, 1e-4 * speed);
    EXPECT_NEAR(moves.y(), 0, 1e-4 * speed);
    EXPECT_NEAR(moves.z(), 0, 1e-4 * speed);
  };
  expect(lowest_moves(LayerSetup::Rotation::none, 1), speed);
  expect(lowest_moves(LayerSetup::Rotation::rolling, 1), 0);
  expect(lowest_moves(LayerSetup::Rotation::rolling, 3), -2 * speed);
  expect(lowest_moves(LayerSetup::Rotation::counter_rotating, 1), 2 * speed);
  expect(lowest_moves(LayerSetup::Rotation::counter_rotating, 0.5), 1.5 * speed);
}

// A spreader that is faster than prescribed: the way stays.
TEST(Spreading, TakesAnotherTimeAtAnotherSpeed) {
  const Scene plain = few_grains({{"layer.from", "-1 mm"}}),
              faster = few_grains({{"layer.from", "-1 mm"}, {"effects", "{moving_wall_speed: {factor: 1.25}}"}, {"layer.rotation", "rolling"}});
  EXPECT_DOUBLE_EQ(faster.layer->speed, 1.25 * plain.layer->speed);
  const SpreaderPath a = path_over(plain, 2e-3), b = path_over(faster, 2e-3);
  EXPECT_EQ(a.from, b.from);
  EXPECT_DOUBLE_EQ(b.duration, a.duration / 1.25);
  const Scene spreading = spreading_scene(faster, b);
  const Tool& roller = spreader_of(spreading);
  EXPECT_DOUBLE_EQ(roller.motion.velocity.x(), 1.25 * plain.layer->speed);
  EXPECT_DOUBLE_EQ(roller.motion.angular_velocity.y(), roller.motion.velocity.x() / (0.5 * std::get<Roller>(roller.kind).diameter));
  EXPECT_THROW(few_grains({{"effects", "{moving_wall_speed: {factor: 0}}"}}), Error);
}

// What came is what the grains hold that came, whatever became of the pores below.
TEST(Layer, TellsTheSolidVolumeThatCamePerArea) {
  const Scene scene = load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer-quick.yaml", {});
  const LayerSetup& setup = *scene.layer;
  const Model bed = prepare_quietly(bed_scene(scene), {}).model;
  Snapshot fewer = bed.initial;
  double volume = 0;
  for (std::size_t i = 0; i < bed.bodies.size(); ++i) {
    const Body& body = bed.bodies[i];
    const double x = bed.initial.position[i].x();
    if (body.role != BodyRole::grain || x < 0.5e-3 || x > 0.8e-3) continue;
    volume += 4.0 / 3 * std::numbers::pi * std::pow(body.radius, 3);
    fewer.position[i].x() += 1;
  }
  const double per_area = volume / (setup.upper - setup.lower).prod();
  const auto came = [&](const Snapshot& before, const Snapshot& after) { return measure_layer(setup, bed, before, after, {}, 1e-3, -1e-3).solid_per_area; };
  EXPECT_NEAR(came(fewer, bed.initial), per_area, 0.01 * per_area);
  EXPECT_NEAR(came(bed.initial, fewer), -per_area, 0.01 * per_area);
}

/// The scene of a pile beside a bare plate, its grains where they were put.
struct OnAPlate {
  Scene scene = load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer_plate.yaml", {});
  Model bed = prepare_quietly(bed_scene(scene), {}).model;
  const LayerSetup& setup = *scene.layer;
};

// Grains that come onto a bare plate make a layer as thick as their volume and their tops say, however little of the plate they hide.
TEST(Layer, OnABarePlateIsThePlateWhereNoGrainLies) {
  const OnAPlate c;
  Snapshot after = c.bed.initial;
  double volume = 0, came = 0;
  for (std::size_t i = 0; i < c.bed.bodies.size() && came < 24; ++i) {
    const Body& body = c.bed.bodies[i];
    if (body.role != BodyRole::grain) continue;
    after.position[i] = Vec3(c.setup.lower.x() + (0.5 + std::fmod(came, 8)) * 1e-4, -1.2e-4 + std::floor(came / 8) * 1.2e-4, body.radius);
    volume += 4.0 / 3 * std::numbers::pi * std::pow(body.radius, 3);
    came += 1;
  }
  const LayerMeasurement m = measure_layer(c.setup, c.bed, c.bed.initial, after, {}, 110e-6, -1e-3);
  EXPECT_EQ(m.before.coverage, 0);
  EXPECT_EQ(m.before.heights.mean, 0);
  EXPECT_EQ(m.before.roughness.Sz, 0);
  EXPECT_GT(m.after.coverage, 0.1);
  EXPECT_LT(m.after.coverage, 0.4);
  EXPECT_DOUBLE_EQ(m.thickness.mean, m.after.heights.mean);
  EXPECT_EQ(m.thickness.n, m.after.grid.height.size());
  // Under the tops of a ball on a plate lie a cylinder and half a ball: (1 + 2/3) pi r^3 beside the 4/3 pi r^3 of the ball.
  const double per_area = volume / (c.setup.upper - c.setup.lower).prod();
  EXPECT_NEAR(m.solid_per_area, per_area, 0.02 * per_area);
  EXPECT_NEAR(m.thickness.mean, 1.25 * per_area, 0.02 * per_area);
  EXPECT_NEAR(m.solid_of_gap.value(), per_area / 110e-6, 0.02 * per_area / 110e-6);
  ASSERT_TRUE(m.thickness_se);
  EXPECT_DOUBLE_EQ(*m.thickness_se, m.after.error->mean);  // of a difference to nothing
  EXPECT_FALSE(m.beside_plate);

  const nlohmann::json told = layer_json(m, c.setup, {}, {});
  for (const char* key : {"Sa", "Sq", "Sp", "Sv", "Sz"}) EXPECT_EQ(told["surface"]["before"][key], 0) << key;
  for (const char* key : {"Ssk", "Sku", "Sal"}) EXPECT_TRUE(told["surface"]["before"][key].is_null()) << key;
  EXPECT_TRUE(told["surface"]["before"]["highest_grains"]["top"]["mean"].is_null());
  // Squares of other sizes are those that a run with this size would take.
  LayerSetup alone = c.setup, both = c.setup;
  both.further_squares = {alone.square = 200e-6};  // wide enough for more than one of these grains
  const nlohmann::json of_both = layer_json(measure_layer(both, c.bed, c.bed.initial, after, {}, 110e-6, -1e-3), both, {}, {});
  const auto& further = of_both["surface"]["after"]["highest_grains"]["further"];
  ASSERT_EQ(further.size(), 1U);
  const nlohmann::json other = layer_json(measure_layer(alone, c.bed, c.bed.initial, after, {}, 110e-6, -1e-3), alone, {}, {});
  EXPECT_EQ(further[0]["square"], alone.square);
  EXPECT_EQ(further[0]["top"], other["surface"]["after"]["highest_grains"]["top"]);
  EXPECT_NE(further[0]["top"], told["surface"]["after"]["highest_grains"]["top"]);
  EXPECT_TRUE(told["packing_fraction"]["before"].is_null());
  EXPECT_TRUE(told["packing_fraction"]["after"].is_number());
  EXPECT_TRUE(told["thickness"]["se"].is_number());

  // The other way round the layer goes; a layer that stays has no thickness.
  EXPECT_NEAR(measure_layer(c.setup, c.bed, after, c.bed.initial, {}, 110e-6, -1e-3).thickness.mean, -m.thickness.mean, 1e-12 * m.thickness.mean);  // summed in another order
  EXPECT_EQ(measure_layer(c.setup, c.bed, after, after, {}, 110e-6, -1e-3).thickness_se.value_or(0), 0);
}

TEST(Layer, DoubtsASurfaceThatIsNoneOrIsBesideThePlate) {
  OnAPlate c;
  const auto doubts = [&] { return doubts_of(measure_layer(c.setup, c.bed, c.bed.initial, c.bed.initial, {}, 110e-6, -1e-3)); };
  ASSERT_EQ(doubts().size(), 1U);
  EXPECT_NE(doubts().front().what.find("no grain lies over the region"), std::string::npos);
  c.scene.layer->upper.x() = 1.6e-3;  // the plate ends at 1.4 mm
  ASSERT_EQ(doubts().size(), 2U);
  EXPECT_NE(doubts().back().what.find("the plate is not there"), std::string::npos);
}

// The gap counts from the plate where nothing lies on it; a region beside the plate has no surface to count from.
TEST(Spreading, CountsTheGapFromABarePlate) {
  OnAPlate c;
  for (const auto from : {LayerSetup::GapFrom::bed, LayerSetup::GapFrom::plate}) {
    c.scene.layer->gap_from = from;
    EXPECT_NEAR(over_the_bed(c.scene, c.bed, c.bed.initial, {}).path.lowest, c.setup.gap, 1e-15);
  }
  c.scene.layer->upper.x() = 1.6e-3;
  EXPECT_THROW(over_the_bed(c.scene, c.bed, c.bed.initial, {}), Error);
  c.scene.layer->upper.x() = 1.1e-3;
  c.scene.layer->plate = -1e-4;
  EXPECT_THROW(over_the_bed(c.scene, c.bed, c.bed.initial, {}), Error);
}

// Nothing is told of an error that too few steps cannot show.
TEST(Layer, TellsNoErrorOfAForceFromTooFewSteps) {
  const Scene scene = load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer-quick.yaml", {});
  const LayerSetup& setup = *scene.layer;
  const Model bed = prepare_quietly(bed_scene(scene), {}).model;
  const double over_the_region = (setup.lower.x() + 1e-3 + 1e-4) / setup.speed;  // [s], from x = -1 mm
  const auto told = [&](int converged) {
    std::vector<StepRecord> steps(40);
    for (int k = 0; k < 40; ++k) {
      steps[static_cast<std::size_t>(k)].time = over_the_region + 1e-6 * k;
      steps[static_cast<std::size_t>(k)].tool_force = Vec3(k % 3, 0, 1);
      steps[static_cast<std::size_t>(k)].report.converged = k < converged;
    }
    const LayerMeasurement m = measure_layer(setup, bed, bed.initial, bed.initial, steps, 1e-3, -1e-3);
    EXPECT_EQ(m.load.converged, static_cast<std::size_t>(converged));
    return layer_json(m, setup, {}, {})["roller"];
  };
  EXPECT_TRUE(told(0)["force"].is_null());
  EXPECT_TRUE(told(19)["force"].is_array());
  for (const char* se : {"force_se", "torque_se"}) {
    EXPECT_TRUE(told(0)[se].is_null());
    EXPECT_TRUE(told(19)[se].is_null());
    EXPECT_TRUE(told(40)[se].is_array());
  }
  EXPECT_GT(told(40)["force_se"][0], 0);
}

// Grains that jam overlap, though their steps converge: such steps tell no force, nor does the one before, which left the overlap.
TEST(Layer, TellsNoForceFromStepsInWhichGrainsOverlap) {
  const Scene scene = few_grains();
  const LayerSetup& setup = *scene.layer;
  const Model bed = prepare_quietly(bed_scene(scene), {}).model;
  const double over_the_region = (setup.lower.x() + 1e-3 + 1e-4) / setup.speed;  // [s], from x = -1 mm
  double diameter = 0, grains = 0;
  for (const Body& body : bed.bodies)
    if (body.role == BodyRole::grain) {
      diameter += 2 * body.radius;
      grains += 1;
    }
  diameter /= grains;
  const auto load_of = [&](int jammed, double overlap) {
    std::vector<StepRecord> steps(40);
    for (int k = 0; k < 40; ++k) {
      StepRecord& step = steps[static_cast<std::size_t>(k)];
      step.time = over_the_region + 1e-6 * k;
      step.report.converged = true;
      step.report.penetration = k >= 40 - jammed ? overlap : 1e-9;
      step.tool_force = Vec3(0, 0, k >= 39 - jammed ? 1000 : 1);
    }
    return measure_layer(setup, bed, bed.initial, bed.initial, steps, 1e-3, -1e-3).load;
  };
  const SpreaderLoad jammed = load_of(10, 0.6 * diameter);
  EXPECT_EQ(jammed.steps, 40U);
  EXPECT_EQ(jammed.converged, 40U);
  EXPECT_EQ(jammed.used, 29U);
  EXPECT_TRUE(jammed.force.isApprox(Vec3(0, 0, 1), 1e-12));
  EXPECT_EQ(jammed.largest, 1);
  EXPECT_EQ(jammed.overlap_max, 0.6 * diameter);
  EXPECT_EQ(load_of(40, 0.6 * diameter).used, 0U);
  EXPECT_EQ(load_of(10, 0.009 * diameter).used, 40U);
  EXPECT_EQ(load_of(10, 0.011 * diameter).used, 29U);
  EXPECT_FALSE(doubt_of_overlap(jammed, 0.009 * diameter));
  const std::optional<Finding> doubt = doubt_of_overlap(jammed, 0.6 * diameter);
  ASSERT_TRUE(doubt);
  EXPECT_EQ(doubt->level, Finding::Level::warning);
  EXPECT_NE(doubt->message.find("0.6 mean diameters"), std::string::npos) << doubt->message;
}

// A bed depends on what it settles among, not on what will spread it.
TEST(Bed, IsKeptForAllSpreaders) {
  const auto key = [](const std::vector<Override>& overrides) {
    return bed_key(prepare_quietly(bed_scene(few_grains(overrides)), {}, {}, keys_of_bed()), {});
  };
  const std::string bed = key({});
  EXPECT_EQ(key({{"pairs.pa12-steel.friction", "0.41"}}), bed);
  EXPECT_EQ(key({{"materials.steel.density", "7000"}}), bed);
  EXPECT_EQ(key({{"layer.gap", "80 um"}, {"layer.speed", "100 mm/s"}, {"layer.rotation", "rolling"}}), bed);
  EXPECT_EQ(key({{"tools.roller.diameter", "40 mm"}}), bed);
  EXPECT_EQ(key({{"effects", "{moving_wall_speed: {factor: 1.5}}"}}), bed);
  EXPECT_NE(key({{"pairs.pa12-pa12.friction", "0.51"}}), bed);
  EXPECT_NE(key({{"pairs.aluminium-pa12.friction", "0.9"}}), bed);
  EXPECT_NE(key({{"layer.plate", "10 um"}}), bed);
  EXPECT_NE(key({{"layer.settle_time_step", "9.0e-5"}}), bed);
  EXPECT_NE(key({{"tools.far_end.material", "steel"}}), bed);
}

// A material that something else is made of, too, stays with its laws.
TEST(Bed, KeepsTheLawsOfWhatStays) {
  const Scene plain = bed_scene(few_grains()), mixed = bed_scene(few_grains({{"tools.far_end.material", "steel"}}));
  EXPECT_EQ(plain.materials.count("steel"), 0U);
  EXPECT_EQ(plain.pairs.count({"pa12", "steel"}), 0U);
  EXPECT_EQ(plain.pairs.count({"aluminium", "pa12"}), 1U);
  EXPECT_EQ(mixed.materials.count("steel"), 1U);
  EXPECT_EQ(mixed.pairs.count({"pa12", "steel"}), 1U);
}

// Grains that hang in the air are slow too, until they have fallen for a while.
TEST(Bed, DoesNotRestBeforeItCouldFall) {
  const Scene scene = load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer-quick.yaml", {});
  const Model bed = prepare_quietly(bed_scene(scene), {}).model;
  Snapshot state = bed.initial;
  EXPECT_TRUE(grains_rest(bed, state, 0));
  for (const double t : {0.0, 1e-4, 0.01}) {
    state.time = t;
    EXPECT_FALSE(bed_rests(bed, state, 0)) << t;
  }
  state.time = 0.02;  // 5 sqrt(d/g) = 12 ms for 58 um
  EXPECT_TRUE(bed_rests(bed, state, 0));
  state.velocity.back() = Vec3(0, 0, -1);  // one that has fallen off the plate
  state.position.back().z() = -0.05;
  EXPECT_TRUE(bed_rests(bed, state, 0));
  for (Vec3& v : state.velocity) v = Vec3(0, 0, -1e-3);  // sqrt(g d) = 24 mm/s
  EXPECT_FALSE(bed_rests(bed, state, 0));
}

}  // namespace
}  // namespace repose
