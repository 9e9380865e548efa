#include "core/model.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace repose {
namespace {

struct FroudeFactors {
  double length, time, velocity, cube, fifth, viscosity;

  explicit FroudeFactors(double factor)
      : length(factor),
        time(std::sqrt(factor)),
        velocity(time),
        cube(factor * factor * factor),
        fifth(cube * factor * factor),
        viscosity(factor * time) {}
};

void scale(Motion& motion, const FroudeFactors& f) {
  motion.velocity *= f.velocity;
  motion.angular_velocity /= f.time;
  motion.pivot *= f.length;
  motion.start *= f.time;
  motion.stop *= f.time;
  motion.vibration_amplitude *= f.length;
  motion.vibration_frequency /= f.time;
}

void scale(PairLaw& law, const FroudeFactors& f) {
  law.rolling_friction_length *= f.length;
  law.spinning_friction_length *= f.length;
  law.cohesion *= f.cube;
  law.cohesion_range *= f.length;
}

void scale(Shape& shape, const FroudeFactors& f) {
  for (Part& part : shape.parts) part = scaled(part, f.length);
  shape.mass.volume *= f.cube;
  shape.mass.centre *= f.length;
  shape.mass.inertia *= f.fifth;
  shape.own_frame.position *= f.length;
  shape.bounding_radius *= f.length;
}

void scale(Body& body, const FroudeFactors& f) {
  body.mass *= f.cube;
  body.inertia *= f.fifth;
  body.radius *= f.length;
  body.volume *= f.cube;
  body.gate_tolerance *= f.length;
  scale(body.motion, f);
  if (body.yield) {
    body.yield->load *= f.cube;
    body.yield->mass *= f.cube;
  }
  for (Interval& interval : body.active) {
    interval.from *= f.time;
    interval.to *= f.time;
  }
}

struct ScaleEffect {
  const FroudeFactors& f;
  void operator()(GravityTilt&) const {}
  void operator()(UniformForce& e) const { e.force *= f.cube; }
  void operator()(LinearDrag& e) const { e.viscosity *= f.viscosity; }
  void operator()(QuadraticDrag&) const {}
  void operator()(FiniteReynoldsDrag& e) const { e.viscosity *= f.viscosity; }
  void operator()(Buoyancy&) const {}
  void operator()(Magnus&) const {}
  void operator()(PeriodicForce& e) const { e.frequency /= f.time; }
};

struct ScaleContactEffect {
  const FroudeFactors& f;
  void operator()(RateDependentFriction& e) const { e.reference_speed *= f.velocity; }
  void operator()(AnisotropicFriction&) const {}
  void operator()(RateDependentRestitution& e) const { e.reference_speed *= f.velocity; }
  void operator()(LiquidBridge& e) const {
    e.force *= f.cube;
    e.rupture *= f.length;
  }
  void operator()(ContactCompliance& e) const {
    e.stiffness *= f.cube / f.length;
    e.damping *= f.cube / f.time;
  }
};

void scale(Snapshot& state, const FroudeFactors& f) {
  state.time *= f.time;
  for (Vec3& x : state.position) x *= f.length;
  for (Vec3& v : state.velocity) v *= f.velocity;
  for (Vec3& w : state.angular_velocity) w /= f.time;
}

}  // namespace

int Model::find_body(const std::string& name) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    if (body.role == BodyRole::grain || body.name < 0) continue;
    if (names[static_cast<std::size_t>(body.name)] == name) return static_cast<int>(i);
  }
  return -1;
}

std::size_t Model::grain_count() const {
  return static_cast<std::size_t>(
      std::count_if(bodies.begin(), bodies.end(), [](const Body& b) { return b.role == BodyRole::grain; }));
}

Model froude_scaled(const Model& model, double length) {
  if (!(length > 0) || !std::isfinite(length))
    throw Error("froude_scaled", "the length factor must be positive and finite", "give a factor above zero");
  const FroudeFactors f(length);
  Model result = model;
  for (PairLaw& law : result.laws) scale(law, f);
  for (Shape& shape : result.shapes) scale(shape, f);
  for (Body& body : result.bodies) scale(body, f);
  for (Effect& effect : result.effects) std::visit(ScaleEffect{f}, effect);
  for (ContactEffect& effect : result.contact_effects) std::visit(ScaleContactEffect{f}, effect);
  result.periodic = {f.length * model.periodic.lower, f.length * model.periodic.upper};
  scale(result.initial, f);
  return result;
}

}  // namespace repose
