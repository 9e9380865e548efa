/// Series that a simulation of many grains tells.
#include <gtest/gtest.h>

#include <cmath>

#include "backends/backends.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/history.hpp"

namespace repose {
namespace {

/// Thirty pellets on one side of a drum about y, for one step so short that they stay.
HistoryRun drum_with(const std::string& motion, const std::string& name = "drum") {
  const Scene scene = parse_scene(
      "materials: {pellet: {density: 1580}, steel: {density: 7800}}\n"
      "pairs: {pellet-pellet: {friction: 0.5}, pellet-steel: {friction: 0.5}}\n"
      "grains: {pellets: {material: pellet, count: 30, size: 2 mm, fill: {box: {lower: [-20 mm, -9 mm, -25 mm], upper: [-4 mm, 9 mm, -5 mm]}, grow: false}}}\n"
      "tools: {" + name + ": {type: drum, material: steel, position: [1 mm, 0, 2 mm], inner_diameter: 84 mm, inner_width: 20 mm, thickness: 3 mm" + motion + "}}\n"
      "solver: {time_step: 1.0e-9}\nduration: 1.0e-9\n",
      "drum");
  SimulationRequest request;
  request.scene = &scene;
  request.series = {"surface_angle"};
  return run_history(find_backend("dvi"), request, false);
}

TEST(BulkSeries, SurfaceAngleInADrumIsTheDirectionOfTheGrainsFromItsAxis) {
  for (const bool back : {false, true}) {
    const HistoryRun run = drum_with(back ? ", motion: {angular_velocity: [0, -1, 0]}" : ", motion: {angular_velocity: [0, 1, 0]}");
    double x = 0, z = 0, mass = 0;
    for (std::size_t i = 0; i < run.model.bodies.size(); ++i) {
      if (run.model.bodies[i].role != BodyRole::grain) continue;
      mass += run.model.bodies[i].mass;
      x += run.model.bodies[i].mass * run.final_state.position[i].x();
      z += run.model.bodies[i].mass * run.final_state.position[i].z();
    }
    // A drum that turns about +y lifts its grains on the side of -x.
    const double angle = std::atan2(0.001 - x / mass, 0.002 - z / mass) * 180 / M_PI;
    EXPECT_GT(angle, 10);
    EXPECT_NEAR(run.history.series.at("surface_angle").back(), back ? -angle : angle, 1e-9);
  }
}

TEST(BulkSeries, SurfaceAngleNeedsADrumThatTurns) {
  EXPECT_THROW(drum_with(""), Error);
  EXPECT_NO_THROW(drum_with(", motion: {angular_velocity: [0, 1, 0]}", "mill"));
}

}  // namespace
}  // namespace repose
