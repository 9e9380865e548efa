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

// A plate that comes down while the bed settles is out of the way, one that rises is in it.
TEST(Spreading, IsRefusedWhereWallsAreWhenItStarts) {
  Scene scene = load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer-quick.yaml", {});
  const Model bed = prepare_quietly(bed_scene(scene), {}).model;
  Snapshot settled = bed.initial;
  settled.time = settled_at;
  constexpr double surface = 2e-3;  // [m], above all grains
  scene.layer->from = -1e-3;
  const double lowest = scene.layer->plate + surface + scene.layer->gap;
  for (const double up : {-1.0, 1.0}) {
    Scene with = scene;
    Tool fin{"fin", "steel", Plate{{1e-4, 1e-4, 5e-4}}, {1.5e-3, 0, lowest - up * 2e-4}, {}};
    fin.motion.velocity = Vec3(0, 0, up * 4e-4 / settled_at);
    with.tools.push_back(fin);
    if (up < 0)
      EXPECT_NO_THROW(spreader_path(with, bed, settled, surface));
    else
      EXPECT_THROW(spreader_path(with, bed, settled, surface), Error);
  }
}

// A plate in the way is found however thin it and the spreader are beside the travel.
TEST(Spreading, IsRefusedWhereItWouldCutIntoAThinPlate) {
  Scene scene = load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer-quick.yaml", {});
  const Model bed = prepare_quietly(bed_scene(scene), {}).model;
  constexpr double surface = 2e-3;  // [m], above all grains
  scene.layer->from = -1e-3;
  const double lowest = scene.layer->plate + surface + scene.layer->gap;
  Tool fin{"fin", "steel", Plate{{2e-6, 1e-4, 5e-4}}, {}, {}};
  const auto refused = [&](double x, double top) {
    Scene with = scene;
    fin.position = {x, 0, top};
    with.tools.push_back(fin);
    try {
      spreader_path(with, bed, bed.initial, surface);
      return false;
    } catch (const Error& e) {
      EXPECT_EQ(e.place(), "layer.gap");
      return true;
    }
  };
  for (const bool blade : {false, true}) {
    if (blade) std::find_if(scene.tools.begin(), scene.tools.end(), [](const Tool& t) { return t.name == "roller"; })->kind = Blade{1e-5, 1e-3, 1.1e-3};
    for (const double x : {-0.7e-3, 0.7e-3, 1.03e-3, 2.5e-3}) {
      EXPECT_TRUE(refused(x, lowest + 1e-6)) << blade << " " << x;
      EXPECT_TRUE(refused(x, lowest + 2e-4)) << blade << " " << x;
      EXPECT_FALSE(refused(x, lowest - 1e-6)) << blade << " " << x;
    }
    EXPECT_FALSE(blade && refused(3e-3, lowest + 1e-4)) << "beyond the end";
  }
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
