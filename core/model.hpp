#pragma once
/// What a backend simulates: the scene with every grain made, constant during a run. The state is Snapshot.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/contact_effects.hpp"
#include "core/effect.hpp"
#include "core/material.hpp"
#include "core/math.hpp"
#include "core/motion.hpp"
#include "core/periodic.hpp"
#include "core/shape.hpp"

namespace repose {

enum class BodyRole : std::uint8_t { grain, tool, body };

/// One rigid body. Its frame has the centre of mass at the origin and principal axes.
struct Body {
  int shape = 0;               ///< index into Model::shapes
  double scale = 1;            ///< the shape is scaled by this about its origin
  int material = 0;            ///< index into Model::materials
  bool dynamic = true;         ///< false: fixed or of prescribed motion, infinite mass
  double mass = 0;             ///< [kg]; 0 if not dynamic
  Vec3 inertia = Vec3::Zero(); ///< principal moments [kg m^2]; 0 if not dynamic
  double radius = 0;           ///< R of the sphere of equal volume [m]; infinite for tools, half-spaces and fixed bodies
  double volume = 0;           ///< [m^3]; 0 if not dynamic
  BodyRole role = BodyRole::body;
  int name = -1;               ///< index into Model::names: body or tool name, or the population of a grain
  Motion motion;               ///< used if not dynamic
  std::optional<Yield> yield;  ///< if not dynamic: it gives way upward
  /// If not empty, the body exists only during these times (the gate of a funnel). A body that appears never expels what
  /// stands in its way: pairs that overlap by more than `gate_tolerance` are left out until they have parted.
  std::vector<Interval> active;
  double gate_tolerance = 0;   ///< [m]

  bool exists_at(double t) const {
    if (active.empty()) return true;
    for (const Interval& i : active)
      if (t >= i.from && t < i.to) return true;
    return false;
  }
};

/// State of all bodies at one time. Arrays of length Model::bodies.size(); poses are of the body frame (centre of mass).
struct Snapshot {
  double time = 0;  ///< [s]
  std::vector<Vec3> position;          ///< [m]
  std::vector<Quat> orientation;
  std::vector<Vec3> velocity;          ///< of the centre of mass [m/s]
  std::vector<Vec3> angular_velocity;  ///< [rad/s], world frame

  void resize(std::size_t n) {
    position.assign(n, Vec3::Zero());
    orientation.assign(n, Quat::Identity());
    velocity.assign(n, Vec3::Zero());
    angular_velocity.assign(n, Vec3::Zero());
  }
  std::size_t size() const { return position.size(); }
};

struct Model {
  std::vector<Material> materials;
  std::vector<PairLaw> laws;   ///< materials.size()^2, row-major, symmetric
  std::vector<Shape> shapes;
  std::vector<Body> bodies;    ///< explicit bodies, then tools, then grains
  std::vector<std::string> names;
  Vec3 gravity{0, 0, -9.81};   ///< [m/s^2], before any tilt
  std::vector<Effect> effects;
  std::vector<ContactEffect> contact_effects;  ///< of all contacts; at most one of each kind
  /// Rules: periodic_body.hpp. States hold the positions of moving bodies wrapped into it (lower <= x < upper of the centre
  /// of mass, a solid may stick out), those of fixed and prescribed bodies as they were prescribed.
  PeriodicCell periodic;
  Snapshot initial;

  const PairLaw& law(int material_a, int material_b) const {
    return laws[static_cast<std::size_t>(material_a) * materials.size() + static_cast<std::size_t>(material_b)];
  }
  /// Index of the named explicit body or tool, -1 if there is none.
  int find_body(const std::string& name) const;
  std::size_t grain_count() const;
};

/// Throws Error if the model breaks a rule of this header (sizes of arrays, positive masses, finite numbers, unit
/// quaternions, indices in range) or of periodic_body.hpp: the check every backend makes before it accepts a model.
void validate(const Model& model);

/// The Froude-similar model: lengths times `length`, times times `time`, gravity kept when length = time^2; densities kept.
/// Cohesion scales as length^3, viscosity as length^1.5, forces as length^3, arms as length. With powers of two for both
/// factors every number of the result is exact.
Model froude_scaled(const Model& model, double length);

}  // namespace repose
