/// The rules of model.hpp, one function per table of the model.
#include <cmath>

#include "core/error.hpp"
#include "core/model.hpp"
#include "core/periodic_body.hpp"

namespace repose {
namespace {

/// Throws unless `holds`. Places and texts are built only on failure: models have up to a million bodies.
template <class Place>
void require(bool holds, const Place& place, const char* problem, const char* remedy) {
  if (!holds) throw Error(place(), problem, remedy);
}

bool positive(double x) { return x > 0 && std::isfinite(x); }
bool not_negative(double x) { return x >= 0 && std::isfinite(x); }
bool unit(const Quat& q) { return std::abs(q.squaredNorm() - 1) < 1e-9; }
bool valid_index(int index, std::size_t size) { return index >= 0 && static_cast<std::size_t>(index) < size; }

void check_materials(const Model& model) {
  for (const Material& material : model.materials) {
    const auto place = [&] { return "materials." + material.name + ".density"; };
    require(positive(material.density), place, "the density must be positive and finite", "give it in kg/m^3");
  }
}

void check_laws(const Model& model) {
  const std::size_t n = model.materials.size();
  const auto table = [] { return std::string("pairs"); };
  require(model.laws.size() == n * n, table, "the table of laws is not materials x materials", "give one law per pair");
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < n; ++b) {
      const PairLaw& law = model.laws[a * n + b];
      const auto place = [&] { return "pairs." + model.materials[a].name + "-" + model.materials[b].name; };
      require(law == model.laws[b * n + a], place, "the law differs from that of the swapped pair", "make them equal");
      require(not_negative(law.friction) && not_negative(law.rolling_friction) && not_negative(law.spinning_friction) &&
                  not_negative(law.rolling_friction_length) && not_negative(law.spinning_friction_length),
              place, "a friction is negative or not finite", "every friction is at least 0");
      require(law.restitution >= 0 && law.restitution <= 1, place, "the restitution is outside [0, 1]",
              "0 is a dead impact, 1 keeps the energy");
      require(not_negative(law.cohesion) && not_negative(law.cohesion_range), place,
              "the cohesion or its range is negative or not finite", "both are at least 0");
    }
  }
}

void check_shapes(const Model& model) {
  for (std::size_t i = 0; i < model.shapes.size(); ++i) {
    const Shape& shape = model.shapes[i];
    const auto place = [&] { return "shape " + std::to_string(i) + " (" + shape.kind + ")"; };
    require(!shape.parts.empty(), place, "the shape has no parts", "make it with make_shape()");
    require(shape.bounding_radius > 0, place, "the bounding radius is not positive", "make it with make_shape()");
    for (const Part& part : shape.parts)
      require(part.pose.position.allFinite() && unit(part.pose.orientation), place,
              "the pose of a part is not finite or its quaternion not of unit length", "normalise the quaternion");
  }
}

bool can_move_freely(const Shape& shape) {
  if (!shape.bounded()) return false;
  for (const Part& part : shape.parts)
    if (std::holds_alternative<HalfSpace>(part.primitive) || std::holds_alternative<Revolved>(part.primitive))
      return false;
  return true;
}

void check_motion(const Motion& m, const auto& place) {
  require(m.velocity.allFinite() && m.angular_velocity.allFinite() && m.pivot.allFinite() &&
              m.vibration_amplitude.allFinite() && std::isfinite(m.vibration_phase) && std::isfinite(m.start),
          place, "a number of the motion is not finite", "give finite numbers");
  require(m.stop >= m.start, place, "the motion stops before it starts", "set stop >= start");
  require(not_negative(m.vibration_frequency), place, "the vibration frequency is negative or not finite",
          "give it in Hz, at least 0");
}

void check_dynamic(const Model& model, const Body& body, const auto& place) {
  require(positive(body.mass), place, "the mass is not positive and finite", "give a mass, or make the body fixed");
  require(positive(body.inertia.x()) && positive(body.inertia.y()) && positive(body.inertia.z()), place,
          "a principal moment of inertia is not positive and finite", "give three positive moments");
  require(!body.yield, place, "a body that moves freely has nothing to yield from", "leave `yield` out");
  require(positive(body.radius) && positive(body.volume), place,
          "the equal-volume radius or the volume is not positive and finite", "take them from the shape");
  require(body.active.empty(), place, "a body that moves freely cannot come and go",
          "make it fixed or give it a motion");
  require(can_move_freely(model.shapes[static_cast<std::size_t>(body.shape)]), place,
          "a half-space or solid of revolution cannot move freely", "make the body fixed or give it a motion");
}

void check_prescribed(const Body& body, const auto& place) {
  require(body.mass == 0 && body.inertia.isZero(0) && body.volume == 0 && std::isinf(body.radius) && body.radius > 0,
          place, "a fixed or prescribed body must have mass, inertia and volume 0 and an infinite radius",
          "leave them at that or make it dynamic");
  check_motion(body.motion, place);
  require(!body.yield || (std::isfinite(body.yield->load) && body.yield->load >= 0 && positive(body.yield->mass)), place,
          "a body that yields needs a load that is not negative and a positive mass", "give both, in N and kg");
}

void check_bodies(const Model& model) {
  // The order that Model::bodies promises.
  const auto rank = [](BodyRole role) { return role == BodyRole::body ? 0 : role == BodyRole::tool ? 1 : 2; };
  int last_rank = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    const auto place = [&] {
      const bool named = valid_index(body.name, model.names.size());
      return "body " + std::to_string(i) + (named ? " (" + model.names[static_cast<std::size_t>(body.name)] + ")" : "");
    };
    require(valid_index(body.shape, model.shapes.size()), place, "the shape index is out of range", "add the shape");
    require(valid_index(body.material, model.materials.size()), place, "the material index is out of range",
            "add the material");
    require(body.name == -1 || valid_index(body.name, model.names.size()), place, "the name index is out of range",
            "use -1 for no name");
    require(positive(body.scale), place, "the scale is not positive and finite", "1 leaves the shape as it is");
    require(not_negative(body.gate_tolerance), place, "the gate tolerance is negative or not finite", "use 0 or more");
    for (const Interval& interval : body.active)
      require(interval.from < interval.to, place, "a time of presence is empty", "each interval needs from < to");
    require(rank(body.role) >= last_rank, place, "the order is not explicit bodies, then tools, then grains",
            "sort them");
    last_rank = rank(body.role);
    if (body.dynamic)
      check_dynamic(model, body, place);
    else
      check_prescribed(body, place);
  }
}

void check_state(const Model& model) {
  const Snapshot& s = model.initial;
  const std::size_t n = model.bodies.size();
  const auto arrays = [] { return std::string("initial state"); };
  require(
      s.position.size() == n && s.orientation.size() == n && s.velocity.size() == n && s.angular_velocity.size() == n,
      arrays, "an array does not have one entry per body", "resize it to the number of bodies");
  require(std::isfinite(s.time), arrays, "the time is not finite", "start at 0");
  for (std::size_t i = 0; i < n; ++i) {
    const auto place = [&] { return "initial state of body " + std::to_string(i); };
    require(s.position[i].allFinite() && s.velocity[i].allFinite() && s.angular_velocity[i].allFinite(), place,
            "a position or velocity is not finite", "give finite numbers");
    require(unit(s.orientation[i]), place, "the orientation is not a unit quaternion", "normalise it");
  }
}

struct CheckEffect {
  static void fluid(const char* name, double density) {
    const auto place = [&] { return std::string("effects.") + name + ".fluid_density"; };
    require(positive(density), place, "the density of the fluid must be positive and finite",
            "air at 20 C: 1.2 kg/m^3");
  }
  static void viscous(const char* name, double viscosity) {
    const auto place = [&] { return std::string("effects.") + name + ".viscosity"; };
    require(positive(viscosity), place, "the viscosity must be positive and finite", "air at 20 C: 1.8e-5 Pa s");
  }
  void operator()(const GravityTilt& e) const {
    const auto place = [] { return std::string("effects.gravity_tilt"); };
    require(std::isfinite(e.x_deg) && std::isfinite(e.y_deg), place, "an angle is not finite", "give degrees");
  }
  void operator()(const UniformForce& e) const {
    const auto place = [] { return std::string("effects.uniform_force.force"); };
    require(e.force.allFinite(), place, "the force is not finite", "give three numbers in N");
  }
  void operator()(const LinearDrag& e) const { viscous("linear_drag", e.viscosity); }
  void operator()(const QuadraticDrag& e) const {
    const auto place = [] { return std::string("effects.quadratic_drag.coefficient"); };
    require(not_negative(e.coefficient), place, "the coefficient is negative or not finite", "a sphere: 0.47");
    fluid("quadratic_drag", e.fluid_density);
  }
  void operator()(const FiniteReynoldsDrag& e) const {
    viscous("finite_reynolds_drag", e.viscosity);
    fluid("finite_reynolds_drag", e.fluid_density);
  }
  void operator()(const Buoyancy& e) const { fluid("buoyancy", e.fluid_density); }
  void operator()(const Magnus& e) const {
    const auto place = [] { return std::string("effects.magnus.lift"); };
    require(std::isfinite(e.lift), place, "the lift is not finite", "a slow sphere: 0.75");
    fluid("magnus", e.fluid_density);
  }
  void operator()(const PeriodicForce& e) const {
    const auto place = [] { return std::string("effects.periodic_force"); };
    require(e.amplitude.allFinite() && std::isfinite(e.phase), place, "the amplitude or phase is not finite",
            "give three numbers in m/s^2 and an angle");
    require(not_negative(e.frequency), place, "the frequency is negative or not finite", "give it in Hz, at least 0");
  }
};

struct CheckContactEffect {
  static void speed(const char* name, double value) {
    const auto place = [&] { return std::string("effects.") + name + ".reference_speed"; };
    require(positive(value), place, "the reference speed must be positive and finite", "give it in m/s");
  }
  void operator()(const RateDependentFriction& e) const {
    const auto place = [] { return std::string("effects.rate_dependent_friction.slope"); };
    require(std::isfinite(e.slope), place, "the slope is not finite", "rock: 0.01 per factor e of speed");
    speed("rate_dependent_friction", e.reference_speed);
  }
  void operator()(const AnisotropicFriction& e) const {
    const auto place = [] { return std::string("effects.anisotropic_friction"); };
    require(positive(e.ratio), place, "the ratio must be positive and finite", "1 leaves friction as it is");
    require(std::isfinite(e.direction_deg), place, "the direction is not finite", "give degrees");
  }
  void operator()(const RateDependentRestitution& e) const {
    const auto place = [] { return std::string("effects.rate_dependent_restitution.exponent"); };
    require(std::isfinite(e.exponent), place, "the exponent is not finite", "plastic spheres: 0.25");
    speed("rate_dependent_restitution", e.reference_speed);
  }
  void operator()(const LiquidBridge& e) const {
    const auto place = [] { return std::string("effects.liquid_bridge"); };
    require(not_negative(e.force), place, "the force is negative or not finite", "give it in N");
    require(positive(e.rupture), place, "the rupture gap must be positive and finite", "give it in m");
  }
  void operator()(const ContactCompliance& e) const {
    const auto place = [] { return std::string("effects.contact_compliance"); };
    require(positive(e.stiffness), place, "the stiffness must be positive and finite",
            "leave the effect out for rigid contacts");
    require(not_negative(e.damping), place, "the damping is negative or not finite", "give it in N s/m");
  }
};

}  // namespace

void validate(const Model& model) {
  check_materials(model);
  check_laws(model);
  check_shapes(model);
  check_bodies(model);
  check_state(model);
  const auto gravity = [] { return std::string("gravity"); };
  require(model.gravity.allFinite(), gravity, "gravity is not finite", "give three numbers in m/s^2");
  for (const Effect& effect : model.effects) std::visit(CheckEffect{}, effect);
  for (const ContactEffect& effect : model.contact_effects) std::visit(CheckContactEffect{}, effect);
  check_periodic(model);
}

}  // namespace repose
