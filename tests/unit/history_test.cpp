/// The function by which an analysis asks for a simulation.
#include "scenarios/history.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "backends/backends.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"

namespace repose {
namespace {

Scene dropped(const std::string& pair, const std::string& effects = "") {
  return parse_scene(
      "materials: {ball: {density: 1000}, floor: {density: 2500}}\n"
      "pairs: {ball-floor: {friction: 0.3" + pair + "}}\n"
      "shapes: {ball: {type: sphere, radius: 1 cm}, floor: {type: half_space}}\n"
      "bodies:\n"
      "  ball: {shape: ball, material: ball, position: [0, 0, 2 cm], velocity: [0.3, 0, 0]}\n"
      "  floor: {shape: floor, material: floor, fixed: true}\n" +
          effects + "solver: {time_step: 1.0e-3}\nduration: 0.2\n",
      "dropped");
}

TEST(Simulate, RunsOnTheBackendThatTheRequestNames) {
  const Scene scene = dropped(", restitution: 0.5");
  SimulationRequest request;
  request.scene = &scene;
  const Simulate simulate = simulate_with(find_backend("dvi"), false);
  const auto end_of = [](const History& history) { return history.bodies.at("ball").position.back(); };
  EXPECT_EQ(end_of(simulate(request)), end_of(run_history(find_backend("dvi"), request, false).history));
  for (const std::string& name : backends_beside(find_backend("dvi"))) {
    request.backend = name;
    EXPECT_EQ(end_of(simulate(request)), end_of(run_history(find_backend(name), request, false).history)) << name;
  }
  request.backend = "no such engine";
  EXPECT_THROW(simulate(request), Error);
}

TEST(Simulate, OnAnotherBackendTakesNothingThatItLacks) {
  const Scene scene = dropped("", "effects: {liquid_bridge: {force: 1 mN, rupture: 1 mm}}\n");
  SimulationRequest request;
  request.scene = &scene;
  request.backend = "bullet";
  EXPECT_THROW(simulate_with(find_backend("dvi"), true)(request), Error);
  request.backend.clear();
  EXPECT_NO_THROW(simulate_with(find_backend("dvi"), true)(request));
}

TEST(Simulate, InSecondOrderForcesAreThoseOfTheSpinHalfWay) {
  // A ball whose spin decays bends its path less and less: the error falls with the square of the step.
  const auto end = [](double h) {
    const Scene scene = parse_scene(
        "materials: {ball: {density: 1000}}\npairs: {}\nshapes: {ball: {type: sphere, radius: 2 cm}}\n"
        "bodies: {ball: {shape: ball, material: ball, position: [0, 0, 0], velocity: [2, 0, 0], angular_velocity: [0, 0, 30]}}\n"
        "gravity: [0, 0, 0]\neffects: {linear_drag: {viscosity: 0.05}, magnus: {lift: 1, fluid_density: 100}}\n"
        "solver: {time_step: " + std::to_string(h) + ", integration: second_order}\nduration: 1\n",
        "spinning");
    SimulationRequest request;
    request.scene = &scene;
    return run_history(find_backend("dvi"), request, false).final_state.position[0];
  };
  const Vec3 exact = end(2e-4);
  const double coarse = (end(2e-2) - exact).norm(), fine = (end(1e-2) - exact).norm();
  EXPECT_GT(coarse, 1e-6);
  EXPECT_GT(coarse / fine, 3.5);
  EXPECT_LT(coarse / fine, 4.5);
}

TEST(Simulate, AllBackendsButTheOwn) {
  const std::vector<std::string> beside = backends_beside(find_backend("dvi"));
  EXPECT_EQ(beside.size() + 1, backends().size());
  EXPECT_EQ(std::count(beside.begin(), beside.end(), "dvi"), 0);
}

}  // namespace
}  // namespace repose
