/// Series that a simulation of many grains tells.
#include <gtest/gtest.h>

#include <cmath>

#include "backends/backends.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/bulk_simulation.hpp"
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

/// A flat surface at the middles of cells.
Observation surface(double from, double to, double cell) {
  Observation o;
  o.kind = ObservableKind::surface;
  o.name = "layer_after";
  for (double y = 0.5 * cell; y < 1e-4; y += cell)
    for (double x = from + 0.5 * cell; x < to; x += cell) {
      o.at.push_back(x);
      o.at_y.push_back(y);
      o.value.push_back(0);
    }
  return o;
}

TEST(BulkSurface, OtherCellsOrAnotherRegionAreTold) {
  Bundle bundle;
  bundle.scene.layer = LayerSetup{};
  bundle.scene.layer->cell = 5e-6;
  bundle.scene.layer->upper = {3e-4, 1e-4};
  const auto told = [&](const Observation& o) {
    Bundle recorded = bundle;
    BundleRun run;
    run.id = "layer";
    run.observations = {o};
    recorded.runs = {run, run};
    return only_simulated(std::move(recorded)).warnings;
  };
  EXPECT_TRUE(told(surface(0, 3e-4, 5e-6)).empty());
  const std::vector<std::string> coarse = told(surface(0, 3e-4, 2e-5)), elsewhere = told(surface(1e-4, 4e-4, 5e-6));
  ASSERT_EQ(coarse.size(), 1u);
  EXPECT_NE(coarse.front().find("in cells of 2e-05 m"), std::string::npos) << coarse.front();
  EXPECT_EQ(elsewhere.size(), 1u);
}

}  // namespace
}  // namespace repose
