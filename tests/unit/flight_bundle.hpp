#pragma once
/// Test support: recordings of a ball in flight, and an integrator without contacts that is exact enough to be their truth.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"
#include "analysis/bundle/sensor.hpp"
#include "analysis/history.hpp"
#include "core/effect.hpp"
#include "core/model.hpp"
#include "core/random.hpp"
#include "core/scene_yaml.hpp"

namespace repose {

/// Runge-Kutta steps of the scene's step under gravity, the scene's effects on bodies and the window loads. Turns by the mean spin.
inline History fly(const SimulationRequest& request) {
  const Scene& scene = *request.scene;
  const Model model = realise(scene, 1);
  Snapshot state = model.initial;
  History history;
  history.gravity = tilted_gravity(model.gravity, model.effects);
  const auto ball = static_cast<std::size_t>(model.find_body("ball"));
  history.radius["ball"] = model.bodies[ball].radius;
  history.mass["ball"] = model.bodies[ball].mass;
  BodyTrack& track = history.bodies["ball"];
  const double h = scene.solver.time_step, until = request.until > 0 ? request.until : scene.duration;
  BodyLoads loads;
  const auto acceleration = [&](const Vec3& x, const Vec3& v, double t, const Vec3& extra) {
    Snapshot at = state;
    at.time = t;
    at.position[ball] = x;
    at.velocity[ball] = v;
    evaluate_loads(model, at, loads);
    return Vec3((loads.force[ball] - loads.linear_damping[ball] * v + extra) / model.bodies[ball].mass);
  };
  const int steps = static_cast<int>(std::lround(until / h));
  for (int n = 0; n <= steps; ++n) {
    const double t = n * h;
    history.time.push_back(t);
    track.position.push_back(state.position[ball]);
    track.orientation.push_back(state.orientation[ball]);
    track.velocity.push_back(state.velocity[ball]);
    track.spin.push_back(state.angular_velocity[ball]);
    track.normal_force.push_back(0);
    track.slip_speed.push_back(0);
    track.approach.push_back(0);
    Vec3 extra = Vec3::Zero();
    for (const WindowLoad& load : request.loads)
      if (load.body == "ball" && t + 0.5 * h >= load.from && t + 0.5 * h < load.to) extra += load.force;
    const Vec3 x = state.position[ball], v = state.velocity[ball];
    const Vec3 a1 = acceleration(x, v, t, extra), v2 = v + 0.5 * h * a1;
    const Vec3 a2 = acceleration(x + 0.5 * h * v, v2, t + 0.5 * h, extra), v3 = v + 0.5 * h * a2;
    const Vec3 a3 = acceleration(x + 0.5 * h * v2, v3, t + 0.5 * h, extra), v4 = v + h * a3;
    const Vec3 a4 = acceleration(x + h * v3, v4, t + h, extra);
    state.position[ball] = x + h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    state.velocity[ball] = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    state.orientation[ball] = (rotation_of(h * state.angular_velocity[ball]) * state.orientation[ball]).normalized();
  }
  return history;
}

/// As fly(), with an error in proportion to the step that no start value imitates, unless the scene is solved to second order:
/// from 0.3 s on the ball is too fast by `rate` [1/s^2 m] times the step.
inline Simulate fly_late_by(double rate) {
  return [rate](const SimulationRequest& request) {
    History history = fly(request);
    if (request.scene->solver.integration == Integration::second_order) return history;
    for (std::size_t i = 0; i < history.time.size(); ++i)
      history.bodies["ball"].position[i].x() += rate * request.scene->solver.time_step * std::max(0.0, history.time[i] - 0.3);
    return history;
  };
}

/// A light ball of 2 cm; `effects`: YAML of the block.
inline std::string ball_scene(const std::string& effects = "{}") {
  return "materials: {foam: {density: 50}, stone: {density: 2500}}\n"
         "pairs: {foam-stone: {friction: 0.5}}\n"
         "shapes: {ball: {type: sphere, radius: 0.02}, floor: {type: half_space}}\n"
         "bodies:\n"
         "  ball: {shape: ball, material: foam, position: [0, 0, 10], velocity: [1, 0, 0]}\n"
         "  floor: {shape: floor, material: stone, fixed: true}\n"
         "effects: " + effects + "\n"
         "solver: {time_step: 1.0e-2, tolerance: 1.0e-6}\nduration: 0.6\n";
}

struct Flights {
  std::vector<Vec3> velocities = {{3, 0, 2}, {2, 1, 3}, {4, -1, 1}, {1, 2, 4}};
  double noise = 1e-3;     ///< [m]
  double rate = 50;        ///< [Hz]
  double duration = 0.6;   ///< [s]
  std::uint64_t seed = 1;
  std::vector<WindowLoad> loads = {};  ///< of the truth
  std::string truth = "{}";       ///< effects of the recorded world
  std::string nominal = "{}";     ///< effects of the scene that goes with the recordings
};

inline Flights six(std::uint64_t seed = 1, const std::string& truth = "{}") {
  Flights f;
  f.velocities = {{3, 0, 2}, {2, 1, 3}, {4, -1, 1}, {1, 2, 4}, {0.5, 0, 0}, {3, 3, 3}};
  f.seed = seed;
  f.truth = truth;
  return f;
}

/// The run's trajectory, at the times that it has, as `engine` flies the scene and a sensor with the flights' noise sees it.
inline void record_anew(BundleRun& run, const Simulate& engine, const Scene& scene, const Flights& f, Random& random) {
  SimulationRequest request;
  request.scene = &scene;
  request.until = f.duration;
  Observation& o = run.observations[0];
  o.position.clear();
  observe(engine(request), o.time, o);
  o.orientation.clear();
  for (Vec3& x : o.position)
    for (double& c : x) c += f.noise * normal(random);
}

/// Indices of all its runs.
inline std::vector<std::size_t> all(const Bundle& bundle) {
  std::vector<std::size_t> runs(bundle.runs.size());
  std::iota(runs.begin(), runs.end(), std::size_t{0});
  return runs;
}

/// Trajectories of the ball with free start velocities; without `noise` in the bundle, so that it is estimated.
inline Bundle flights(const Flights& f) {
  Bundle bundle;
  bundle.title = "Flights";
  bundle.scene = parse_scene(ball_scene(f.nominal), "nominal");
  bundle.scene_file = "nominal.yaml";
  Random random(f.seed, 3);
  for (std::size_t i = 0; i < f.velocities.size(); ++i) {
    const Vec3& v = f.velocities[i];
    BundleRun run;
    run.id = "flight-" + std::to_string(i + 1);
    run.set = {{"bodies.ball.velocity", "[" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " + std::to_string(v.z()) + "]"}};
    run.free = {"bodies.ball.velocity"};
    const Scene truth = parse_scene(ball_scene(f.truth), "truth", run.set);
    SimulationRequest request;
    request.scene = &truth;
    request.until = f.duration;
    request.loads = f.loads;
    Observation o;
    o.name = "position";
    o.body = "ball";
    o.file = run.id + ".csv";
    std::vector<double> times;
    for (int n = 0; n <= static_cast<int>(f.duration * f.rate); ++n) times.push_back(n / f.rate);
    observe(fly(request), times, o);
    o.orientation.clear();
    for (Vec3& x : o.position)
      for (double& c : x) c += f.noise * normal(random);
    run.observations = {o};
    bundle.runs.push_back(run);
  }
  return bundle;
}

}  // namespace repose
