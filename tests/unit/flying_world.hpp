#pragma once
/// Test support: a world without contacts, and a small model for it.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "core/error.hpp"
#include "core/model.hpp"
#include "core/world.hpp"

namespace repose {

/// Free flight by symplectic Euler. Its reports are made up from the step number, so that a log can be told from another.
class FlyingWorld : public World {
 public:
  explicit FlyingWorld(const Model& model) : model_(model), state_(model.initial) {}

  StepReport step(double dt, const BodyLoads& loads) override {
    for (std::size_t i = 0; i < state_.size(); ++i) {
      if (!model_.bodies[i].dynamic) continue;
      state_.velocity[i] += dt / model_.bodies[i].mass * loads.force[i];
      state_.position[i] += dt * state_.velocity[i];
      state_.orientation[i] = (rotation_of(dt * state_.angular_velocity[i]) * state_.orientation[i]).normalized();
    }
    ++steps_;
    state_.time = static_cast<double>(steps_) * dt;
    if (steps_ == explode_at) state_.position[0].x() = std::nan("");
    memory_ = 0.5 * memory_ + std::sin(static_cast<double>(steps_));
    StepReport report;
    report.contacts = static_cast<int>(steps_ % 7);
    report.iterations = static_cast<int>(steps_ % 5);
    report.residual = 1e-4 * (1 + memory_ * memory_);
    report.converged = steps_ % 4 != 0;
    report.cycling = steps_ % 10 == 0;
    report.penetration = 1e-6 * static_cast<double>(steps_ % 3);
    report.contact_work = -memory_;
    return report;
  }
  void read(Snapshot& state) const override { state = state_; }
  void read(std::vector<Contact>& contacts) const override { contacts.clear(); }
  void save(Frame& frame) const override {
    frame.state = state_;
    frame.numbers["memory"] = {memory_};
    frame.numbers["nothing"] = {};
    frame.integers["steps"] = {steps_};
  }
  void restore(const Frame& frame) override {
    state_ = frame.state;
    memory_ = frame.numbers.at("memory").at(0);
    steps_ = frame.integers.at("steps").at(0);
  }

  std::int64_t explode_at = -1;  ///< the state stops being finite in this step

 private:
  const Model& model_;
  Snapshot state_;
  double memory_ = 0;
  std::int64_t steps_ = 0;
};

/// Two materials, every kind of primitive, every effect, a moving tool and a gate, and `grains` spheres in flight.
inline Model flying_model(std::size_t grains = 5) {
  Model m;
  m.materials = {{"pa12", 1020}, {"steel", 7800}};
  PairLaw law;
  law.friction = 0.1 + 0.2;  // not a short decimal
  law.friction_arm = FrictionArm::mean_radius;
  law.cohesion = 1e-9;
  m.laws = {law, PairLaw{}, PairLaw{}, law};
  m.names = {"floor", "gate", "powder"};
  m.gravity = Vec3(0, 0, -9.81);
  m.effects = {GravityTilt{1, 0}, UniformForce{Vec3(1e-12, 0, 0)}, Buoyancy{1.2}};

  Shape ball = make_shape("sphere", {Part{Sphere{29e-6}, {}}});
  Shape odd = ball;
  odd.kind = "odd";
  const Pose aside{Vec3(1. / 3, 0, -0.0), rotation_of(Vec3(0.1, 0.2, 0.3))};
  odd.parts = {Part{Ellipsoid{Vec3(1, 2, 3)}, aside}, Part{RoundCone{1, 0, 2}, {}}, Part{Cone{1, 2}, {}},
               Part{Box{Vec3(1, 2, 3)}, {}}, Part{Cylinder{1, 2}, {}},
               Part{Revolved{{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1)}}, {}},
               Part{TriMesh{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
                            {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}, {}}};
  m.shapes = {make_shape("half_space", {Part{HalfSpace{}, {}}}), odd, ball};

  const auto add = [&m](Body body, Vec3 position) {
    m.bodies.push_back(body);
    m.initial.position.push_back(position);
    m.initial.orientation.push_back(Quat::Identity());
    m.initial.velocity.push_back(Vec3::Zero());
    m.initial.angular_velocity.push_back(Vec3::Zero());
  };
  Body tool;
  tool.dynamic = false;
  tool.radius = std::numeric_limits<double>::infinity();
  tool.role = BodyRole::tool;
  tool.name = 0;
  tool.material = 1;
  add(tool, Vec3(0, 0, -1));
  tool.shape = 1;
  tool.name = 1;
  tool.motion.velocity = Vec3(0.127, 0, 0);
  tool.motion.stop = 3;
  tool.active = {{0, 0.5}, {1, 1e300}};
  tool.gate_tolerance = 1e-6;
  add(tool, Vec3(0, 0, 1));
  for (std::size_t i = 0; i < grains; ++i) {
    Body grain;
    grain.shape = 2;
    grain.radius = 29e-6;
    grain.volume = ball.mass.volume;
    grain.mass = 1020 * grain.volume;
    grain.inertia = 1020 * ball.mass.inertia.diagonal();
    grain.role = BodyRole::grain;
    grain.name = 2;
    const double k = static_cast<double>(i);
    add(grain, Vec3(1e-4 * k, 1e-4 / (1 + k), 0));
    m.initial.velocity.back() = Vec3(0.1, 0.01 * k, 1. / 3);
    m.initial.angular_velocity.back() = Vec3(k, 2, -1);
  }
  return m;
}

/// A folder of its own for a test, empty.
inline std::filesystem::path fresh_folder(const std::string& name) {
  const auto folder = std::filesystem::temp_directory_path() / ("repose-" + name + "-" + std::to_string(::getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace repose
