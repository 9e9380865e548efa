#include "scenarios/spreading.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/scene_yaml.hpp"
#include "scenarios/bed.hpp"

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
                                 {{"tools.far_end.motion", "{velocity: [0, 0, -1 mm/s], start: 20 ms, stop: 120 ms, vibration_amplitude: [0, 5 um, 0], vibration_frequency: 30 Hz}"}});
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

// Grains that hang in the air are slow too, until they have fallen for a while.
TEST(Bed, DoesNotRestBeforeItCouldFall) {
  const Scene scene = load_scene(std::filesystem::path(REPOSE_CONFIGS) / "layer-quick.yaml", {});
  const Model bed = prepare_quietly(bed_scene(scene), {}).model;
  Snapshot state = bed.initial;
  EXPECT_TRUE(grains_rest(bed, state));
  for (const double t : {0.0, 1e-4, 0.01}) {
    state.time = t;
    EXPECT_FALSE(bed_rests(bed, state)) << t;
  }
  state.time = 0.02;  // 5 sqrt(d/g) = 12 ms for 58 um
  EXPECT_TRUE(bed_rests(bed, state));
  for (Vec3& v : state.velocity) v = Vec3(0, 0, -1e-3);  // sqrt(g d) = 24 mm/s
  EXPECT_FALSE(bed_rests(bed, state));
}

}  // namespace
}  // namespace repose
