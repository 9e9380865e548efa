/// A ball falls on a floor and rests there: the least program that uses an installed Repose.
#include <cmath>
#include <cstdio>

#include "backends/backends.hpp"
#include "core/error.hpp"
#include "core/run.hpp"
#include "core/scene.hpp"
#include "core/scene_yaml.hpp"

constexpr auto scene_text = R"(
materials: {rubber: {density: 1100}, stone: {density: 2600}}
pairs:
  rubber-stone: {friction: 0.5}
shapes:
  ball: {type: sphere, radius: 20 mm}
  floor: {type: half_space, normal: [0, 0, 1]}
bodies:
  ball: {shape: ball, material: rubber, position: [0, 0, 0.1]}
  floor: {shape: floor, material: stone, fixed: true}
solver: {time_step: 1 ms}
duration: 0.5
)";

int main() try {
  const repose::Scene scene = repose::parse_scene(scene_text, "ball.yaml");
  const repose::Model model = repose::realise(scene, 1);
  const repose::Backend& backend = repose::find_backend("dvi");
  const auto world = backend.make(model, scene.solver);

  repose::Schedule schedule;
  schedule.time_step = scene.solver.time_step;
  schedule.duration = scene.duration;
  schedule.frame_interval = scene.duration;
  const repose::RunReport report = repose::run(*world, model, schedule, nullptr, {});

  const auto ball = static_cast<std::size_t>(model.find_body("ball"));
  const double radius = 0.02;
  const double height = report.final_state.position[ball].z();
  const double speed = report.final_state.velocity[ball].norm();
  std::printf("height %.6g m, speed %.3g m/s\n", height, speed);
  const bool rests = std::abs(height - radius) < 1e-3 * radius && speed < 1e-6;
  return rests ? 0 : 1;
} catch (const repose::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
