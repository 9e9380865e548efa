#include "core/effect.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "core/model.hpp"

namespace repose {
namespace {

constexpr double pi = std::numbers::pi;

/// What one body needs to know of itself and hands back.
struct BodyLoad {
  const Body& body;
  const Vec3& velocity;
  const Vec3& angular_velocity;
  const Vec3& gravity;
  double time;
  Vec3 force = Vec3::Zero();
  double linear_damping = 0;
  double angular_damping = 0;
};

double stokes_linear(double viscosity, double radius) { return 6 * pi * viscosity * radius; }
double stokes_angular(double viscosity, double radius) { return 8 * pi * viscosity * radius * radius * radius; }

void add(const GravityTilt&, BodyLoad&) {}  // already in BodyLoad::gravity

void add(const UniformForce& effect, BodyLoad& load) { load.force += effect.force; }

void add(const LinearDrag& effect, BodyLoad& load) {
  load.linear_damping += stokes_linear(effect.viscosity, load.body.radius);
  load.angular_damping += stokes_angular(effect.viscosity, load.body.radius);
}

void add(const QuadraticDrag& effect, BodyLoad& load) {
  const double area = pi * load.body.radius * load.body.radius;
  load.linear_damping += 0.5 * effect.fluid_density * effect.coefficient * area * load.velocity.norm();
}

void add(const FiniteReynoldsDrag& effect, BodyLoad& load) {
  const double radius = load.body.radius;
  const double reynolds = 2 * radius * load.velocity.norm() * effect.fluid_density / effect.viscosity;
  load.linear_damping += stokes_linear(effect.viscosity, radius) * (1 + 0.15 * std::pow(reynolds, 0.687));
  load.angular_damping += stokes_angular(effect.viscosity, radius);
}

void add(const Buoyancy& effect, BodyLoad& load) {
  load.force -= effect.fluid_density * load.body.volume * load.gravity;
}

void add(const Magnus& effect, BodyLoad& load) {
  const double radius = load.body.radius;
  const double volume = 4.0 / 3 * pi * radius * radius * radius;
  load.force += effect.lift * effect.fluid_density * volume * load.angular_velocity.cross(load.velocity);
}

void add(const PeriodicForce& effect, BodyLoad& load) {
  load.force +=
      load.body.mass * std::sin(2 * pi * effect.frequency * load.time + effect.phase) * effect.amplitude;
}

struct NameOf {
  std::string operator()(const GravityTilt&) const { return "gravity_tilt"; }
  std::string operator()(const UniformForce&) const { return "uniform_force"; }
  std::string operator()(const LinearDrag&) const { return "linear_drag"; }
  std::string operator()(const QuadraticDrag&) const { return "quadratic_drag"; }
  std::string operator()(const FiniteReynoldsDrag&) const { return "finite_reynolds_drag"; }
  std::string operator()(const Buoyancy&) const { return "buoyancy"; }
  std::string operator()(const Magnus&) const { return "magnus"; }
  std::string operator()(const PeriodicForce&) const { return "periodic_force"; }
};

}  // namespace

std::string effect_name(const Effect& effect) { return std::visit(NameOf{}, effect); }

Vec3 tilted_gravity(const Vec3& gravity, std::span<const Effect> effects) {
  Vec3 turned = gravity;
  for (const Effect& effect : effects) {
    const GravityTilt* tilt = std::get_if<GravityTilt>(&effect);
    if (tilt == nullptr) continue;
    const Eigen::AngleAxisd about_x(tilt->x_deg * pi / 180, Vec3::UnitX());
    const Eigen::AngleAxisd about_y(tilt->y_deg * pi / 180, Vec3::UnitY());
    turned = about_y.toRotationMatrix() * (about_x.toRotationMatrix() * turned);
  }
  return turned;
}

void evaluate_loads(const Model& model, const Snapshot& state, BodyLoads& loads) {
  const std::size_t n = model.bodies.size();
  assert(state.size() == n);
  loads.force.assign(n, Vec3::Zero());
  loads.torque.assign(n, Vec3::Zero());
  loads.linear_damping.assign(n, 0);
  loads.angular_damping.assign(n, 0);

  const Vec3 gravity = tilted_gravity(model.gravity, model.effects);
  for (std::size_t i = 0; i < n; ++i) {
    const Body& body = model.bodies[i];
    if (!body.dynamic) continue;
    BodyLoad load{.body = body,
                  .velocity = state.velocity[i],
                  .angular_velocity = state.angular_velocity[i],
                  .gravity = gravity,
                  .time = state.time,
                  .force = body.mass * gravity};
    for (const Effect& effect : model.effects) std::visit([&](const auto& e) { add(e, load); }, effect);
    loads.force[i] = load.force;
    loads.linear_damping[i] = load.linear_damping;
    loads.angular_damping[i] = load.angular_damping;
  }
}

}  // namespace repose
