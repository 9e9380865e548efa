#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "analysis/diagnosis/fit.hpp"
#include "analysis/diagnosis/locate.hpp"
#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

Fit nominal_fit(const Problem& problem) { return minimise(problem, start_of(problem, problem.layout({}), all(problem.bundle())), {}); }

Places places_of(const Problem& problem) {
  const Fit fit = nominal_fit(problem);
  return locate(problem, fit, Nuisance(problem, fit), 4, 499, 1);
}

TEST(Locate, FindsTheWindowOfAForce) {
  Flights f{.noise = 2e-4, .rate = 100, .duration = 0.8};
  const double from = 0.3, to = 0.5;
  f.loads = {{"ball", from, to, Vec3(0.003, 0, 0), Vec3::Zero()}};
  const Bundle bundle = flights(f);
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  const std::vector<Located> where = locate(problem, fit, Nuisance(problem, fit), 4, 499, 1).stretches;
  ASSERT_FALSE(where.empty());
  const Segment& s = where.front().segment;
  EXPECT_LE(where.front().p, 0.01);
  EXPECT_EQ(where.front().observable, "position");
  EXPECT_EQ(s.phase, Phase::flight);
  const double both = std::min(s.to, to) - std::max(s.from, from), either = std::max(s.to, to) - std::min(s.from, from);
  EXPECT_GE(both / either, 0.6) << s.from << " .. " << s.to;
  // Pieces that reach over the edges of the window share its push.
  EXPECT_NEAR(where.front().force.x() * (s.to - s.from), 0.003 * (to - from), 0.2 * 0.003 * (to - from));
}

TEST(Locate, AForceThatActsAllAlongAPhaseIsOneStretch) {
  const Bundle bundle = flights({.noise = 2e-4, .rate = 100, .duration = 0.8, .truth = "{uniform_force: {force: [0.002, 0, 0]}}"});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  const Places places = locate(problem, fit, Nuisance(problem, fit), 4, 499, 1);
  const Located& first = places.stretches.front();
  EXPECT_LE(first.p, 0.01);
  EXPECT_GE(first.segment.to - first.segment.from, 0.6 * 0.8);
  EXPECT_GT(places.pieces.size(), places.stretches.size());
  // Disjoint, and all of each path.
  for (std::size_t run = 0; run < 4; ++run) {
    double covered = 0;
    for (const Located& l : places.stretches)
      if (l.run == run) covered += l.segment.to - l.segment.from;
    EXPECT_NEAR(covered, 0.8, 0.02) << run;
  }
}

TEST(Locate, FindsNothingInNoise) {
  const Bundle bundle = flights({.seed = 4});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  for (const Located& l : locate(problem, fit, Nuisance(problem, fit), 4, 199, 1).pieces) EXPECT_GT(l.p, 0.01);
}

/// Two balls without gravity that hit each other, at the moment when they do: the normal impulse with the pair's restitution, no friction, and drag of
/// `drag` times the square of the speed [1/m] on the light one, which leaves with a spin about x of `grip` times the approach [rad/m].
struct Collisions {
  double restitution = 0.9, drag = 0, grip = 0;
  std::vector<WindowLoad> loads = {};

  History operator()(const SimulationRequest& request) const {
    const Scene& scene = *request.scene;
    const Model model = realise(scene, 1);
    const std::array<std::string, 2> names{"light", "heavy"};
    History history;
    std::array<Vec3, 2> x, v, spin{Vec3::Zero(), Vec3::Zero()};
    std::array<Quat, 2> turn{Quat::Identity(), Quat::Identity()};
    std::array<double, 2> mass{};
    double reach = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto at = static_cast<std::size_t>(model.find_body(names[k]));
      x[k] = model.initial.position[at];
      v[k] = model.initial.velocity[at];
      mass[k] = history.mass[names[k]] = model.bodies[at].mass;
      reach += history.radius[names[k]] = model.bodies[at].radius;
    }
    const double h = scene.solver.time_step;
    double pressed = 0, approach = 0;
    for (int n = 0; n <= std::lround((request.until > 0 ? request.until : scene.duration) / h); ++n) {
      const double t = n * h;
      history.time.push_back(t);
      for (std::size_t k = 0; k < 2; ++k) {
        BodyTrack& track = history.bodies[names[k]];
        track.position.push_back(x[k]);
        track.orientation.push_back(turn[k]);
        track.velocity.push_back(v[k]);
        track.spin.push_back(spin[k]);
        track.normal_force.push_back(pressed);
        track.slip_speed.push_back(0);
        track.approach.push_back(approach);
        Vec3 force = k == 0 ? Vec3(-drag * mass[k] * v[k].norm() * v[k]) : Vec3::Zero();
        for (const std::vector<WindowLoad>& some : {request.loads, loads})
          for (const WindowLoad& load : some)
            if (load.body == names[k]) {
              const double acts = std::max(0.0, std::min(load.to, t + h) - std::max(load.from, t));
              force += load.force * acts / h;
              spin[k] += acts / (0.4 * mass[k] * std::pow(history.radius[names[k]], 2)) * load.torque;
            }
        v[k] += h / mass[k] * force;
        if (const double angle = h * spin[k].norm(); angle > 0) turn[k] = (Quat(Eigen::AngleAxisd(angle, spin[k].normalized())) * turn[k]).normalized();
      }
      pressed = approach = 0;
      const Vec3 apart = x[1] - x[0], opening = v[1] - v[0];
      const double a = opening.squaredNorm(), b = apart.dot(opening), c = apart.squaredNorm() - reach * reach, under = b * b - a * c;
      const double hit = b < 0 && under > 0 ? (-b - std::sqrt(under)) / a : h;
      const double before = std::min(hit, h);
      for (std::size_t k = 0; k < 2; ++k) x[k] += before * v[k];
      if (hit < h) {
        const Vec3 normal = (x[1] - x[0]).normalized();
        approach = -normal.dot(opening);
        const double impulse = (1 + restitution) * approach / (1 / mass[0] + 1 / mass[1]);
        pressed = impulse / h;
        v[0] -= impulse / mass[0] * normal;
        v[1] += impulse / mass[1] * normal;
        spin[0] += grip * approach * Vec3::UnitX();
        for (std::size_t k = 0; k < 2; ++k) x[k] += (h - before) * v[k];
      }
    }
    return history;
  }
};

Bundle recorded(const Collisions& truth, double noise, double rate, double duration, bool turns = false) {
  Bundle bundle;
  bundle.title = "Collisions";
  bundle.scene_file = "nominal.yaml";
  bundle.scene = parse_scene("materials: {ball: {density: 500}}\npairs: {ball-ball: {friction: 0}}\n"
                             "shapes: {small: {type: sphere, radius: 0.02}, large: {type: sphere, radius: 0.03}}\n"
                             "bodies:\n"
                             "  light: {shape: small, material: ball, position: [-0.2, 0, 0], velocity: [1, 0, 0]}\n"
                             "  heavy: {shape: large, material: ball, position: [0, 0.02, 0.01]}\n"
                             "gravity: [0, 0, 0]\nsolver: {time_step: 1.0e-3, tolerance: 1.0e-6}\nduration: 0.6\n",
                             "nominal");
  Random random(1, 3);
  for (const double speed : {1.0, 1.3, 0.8}) {
    BundleRun run;
    run.id = "hit-" + std::to_string(bundle.runs.size() + 1);
    run.set = {{"bodies.light.velocity", "[" + std::to_string(speed) + ", 0, 0]"}};
    run.free = {"bodies.light.velocity"};
    const Scene scene = parse_scene(bundle.scene.text, "truth", run.set);
    SimulationRequest request;
    request.scene = &scene;
    request.until = duration;
    std::vector<double> times;
    for (int n = 0; n <= static_cast<int>(duration * rate); ++n) times.push_back(n / rate);
    for (const char* body : {"light", "heavy"}) {
      Observation o;
      o.name = "position";
      o.body = body;
      o.file = run.id + body + ".csv";
      observe(truth(request), times, o);
      if (!turns) o.orientation.clear();
      for (Quat& q : o.orientation) q = (Quat(Eigen::AngleAxisd(2e-3 * normal(random), Vec3::UnitX())) * Quat(Eigen::AngleAxisd(2e-3 * normal(random), Vec3::UnitZ())) * q).normalized();
      for (Vec3& x : o.position)
        for (double& c : x) c += noise * normal(random);
      run.observations.push_back(o);
    }
    bundle.runs.push_back(run);
  }
  return bundle;
}

TEST(Locate, AWrongRestitutionIsInTheImpact) {
  const double rate = 100;
  const Bundle bundle = recorded({.restitution = 0.8}, 2e-4, rate, 0.5);
  const Problem problem(bundle, all(bundle), Collisions{.restitution = 0.9});
  const Located first = places_of(problem).stretches.front();
  EXPECT_LE(first.p, 0.01);
  EXPECT_EQ(first.segment.phase, Phase::impact);
  const double speeds[] = {1.0, 1.3, 0.8};
  // The centres are 0.2 m apart along x and sqrt(0.02^2 + 0.01^2) across.
  const double hit = (0.2 - std::sqrt(0.05 * 0.05 - 0.02 * 0.02 - 0.01 * 0.01)) / speeds[first.run];
  EXPECT_LE(first.segment.from, hit);
  EXPECT_GE(first.segment.to, hit);
  // A sample on either side, and the step in which it hits.
  EXPECT_NEAR(first.segment.to - first.segment.from, 2 / rate, 2.5e-3);
}

// Of an inertia, or of a law of friction, that is wrong a blow shows the spin alone: no force on the centre imitates it.
TEST(Locate, ASpinThatABlowGaveWronglyIsInTheImpact) {
  const Bundle bundle = recorded({.grip = 5.5}, 2e-4, 100, 0.5, true);
  const Problem problem(bundle, all(bundle), Collisions{.grip = 5});
  const Located first = places_of(problem).stretches.front();
  EXPECT_LE(first.p, 0.01);
  EXPECT_EQ(first.segment.phase, Phase::impact);
  EXPECT_EQ(first.segment.body, "light");
  const Bundle right = recorded({.grip = 5}, 2e-4, 100, 0.5, true);
  const Problem nothing(right, all(right), Collisions{.grip = 5});
  for (const Located& l : places_of(nothing).pieces) EXPECT_GT(l.p, 0.01);
}

TEST(Locate, WhatActsInEveryFlightIsOneStretchAcrossAnImpact) {
  const Bundle bundle = recorded({.drag = 0.03}, 1e-4, 100, 0.5);
  const Problem problem(bundle, all(bundle), Collisions{});
  const Places places = places_of(problem);
  const Located& first = places.stretches.front();
  EXPECT_LE(first.p, 0.01);
  EXPECT_EQ(first.segment.phase, Phase::flight);
  EXPECT_LT(first.segment.from, 0.1);
  EXPECT_GT(first.segment.to, 0.4);
}

TEST(Locate, AForceIsThatOnItsOwnBody) {
  for (const std::string body : {"light", "heavy"}) {  // the other has another mass
    const double force = 0.01;
    const Bundle bundle = recorded({.loads = {{body, 0.1, 0.25, Vec3(0, 0, force), Vec3::Zero()}}}, 1e-5, 200, 0.25);
    const Problem problem(bundle, all(bundle), Collisions{});
    const Located first = places_of(problem).stretches.front();
    EXPECT_EQ(first.segment.body, body);
    const double lasts = first.segment.to - first.segment.from, impulse = 0.15 * force, error = lasts * first.force_se.z();
    EXPECT_LT(error, 0.2 * impulse) << body;
    EXPECT_NEAR(lasts * first.force.z(), impulse, 3 * error) << body;
  }
}

TEST(Locate, FindsNothingInTheNoiseOfCollisions) {
  const Bundle bundle = recorded({}, 2e-4, 100, 0.5);
  const Problem problem(bundle, all(bundle), Collisions{});
  for (const Located& l : places_of(problem).pieces) EXPECT_GT(l.p, 0.01);
}

}  // namespace
}  // namespace repose::diagnosis
