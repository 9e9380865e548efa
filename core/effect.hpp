#pragma once
/// Body loads: physics that acts on a body whatever touches it. Every backend applies them through BodyLoads.
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/math.hpp"

namespace repose {

struct Model;
struct Snapshot;

/// Gravity turned about the world axes, first x then y: g' = Ry(y) Rx(x) g.
struct GravityTilt {
  double x_deg = 0, y_deg = 0;
};

/// A constant force on every body, whatever its size [N], world frame.
struct UniformForce {
  Vec3 force = Vec3::Zero();
};

/// Resistance of a still fluid to a small, slow body (Stokes):
///   F = -6 pi eta R v [N],  tau = -8 pi eta R^3 w [N m],   R: radius of the sphere of equal volume.
/// Valid for a particle Reynolds number 2 R |v| rho_f / eta below about 0.5; beyond it use FiniteReynoldsDrag.
struct LinearDrag {
  double viscosity = 0;  ///< eta [Pa s], > 0; air at 20 C: 1.8e-5
};

/// Resistance at high Reynolds number:  F = -1/2 rho_f C pi R^2 |v| v [N]; no torque.
struct QuadraticDrag {
  double coefficient = 0;    ///< C [1], >= 0; a sphere: 0.47
  double fluid_density = 0;  ///< rho_f [kg/m^3], > 0
};

/// Stokes drag with the correction of Schiller & Naumann (1935), for grains too fast for LinearDrag:
///   F = -6 pi eta R v (1 + 0.15 Re^0.687),  Re = 2 R |v| rho_f / eta;   tau = -8 pi eta R^3 w.
/// Valid for Re < 800.
struct FiniteReynoldsDrag {
  double viscosity = 0;      ///< eta [Pa s], > 0
  double fluid_density = 0;  ///< rho_f [kg/m^3], > 0
};

/// F = -rho_f V g [N], V: volume of the body.
struct Buoyancy {
  double fluid_density = 0;  ///< rho_f [kg/m^3], > 0
};

/// Lift on a body that spins in a still fluid (Magnus):
///   F = lift rho_f (4/3) pi R^3  w x v [N]; no torque.   R: radius of the sphere of equal volume.
/// Slow spheres (Reynolds number << 1): lift = 3/4 (Rubinow & Keller 1961); fast balls of games: 0.1 to 1; negative on
/// smooth balls near the drag crisis (inverse Magnus effect).
/// Explicit: with W = lift (rho_f / rho) |w| the path of frozen spin turns by atan(h W) per step and the speed grows by
/// sqrt(1 + (h W)^2), that is by h W^2 t / 2 after the time t.
struct Magnus {
  double lift = 0;           ///< [1]
  double fluid_density = 0;  ///< rho_f [kg/m^3], > 0
};

/// The same periodic acceleration on every body (a shaken frame of reference):
///   F = m amplitude sin(2 pi frequency t + phase) [N], t: time at the start of the step.
struct PeriodicForce {
  Vec3 amplitude = Vec3::Zero();  ///< [m/s^2], world frame
  double frequency = 0;           ///< [Hz], >= 0
  double phase = 0;               ///< [rad]
};

/// One row per effect on bodies; scene key in the comment.
using Effect = std::variant<GravityTilt,         // gravity_tilt
                            UniformForce,        // uniform_force
                            LinearDrag,          // linear_drag
                            QuadraticDrag,       // quadratic_drag
                            FiniteReynoldsDrag,  // finite_reynolds_drag
                            Buoyancy,            // buoyancy
                            Magnus,              // magnus
                            PeriodicForce>;      // periodic_force

/// The scene key of an effect ("linear_drag").
std::string effect_name(const Effect& effect);

/// What acts on each body during one step, arrays of length Model::bodies.size().
/// Explicit part: `force`, `torque`. Implicit part: -damping * v+ (the velocity at the *end* of the step), so that a stiff
/// drag is stable at any step. A backend therefore uses, with step h and the loads of this struct,
///   (m + h linear_damping) v+ = m v + h force + contact impulses,   and likewise for each principal axis of rotation.
/// In Integration::second_order half of the damping acts on v.
struct BodyLoads {
  std::vector<Vec3> force;              ///< [N] at the centre of mass, world frame; gravity included
  std::vector<Vec3> torque;             ///< [N m], world frame
  std::vector<double> linear_damping;   ///< [kg/s], >= 0
  std::vector<double> angular_damping;  ///< [kg m^2/s], >= 0
};

/// Fills `loads` for the present state (resizes it). Non-dynamic bodies get zero.
void evaluate_loads(const Model& model, const Snapshot& state, BodyLoads& loads);

/// `gravity` turned by every GravityTilt among `effects` [m/s^2].
Vec3 tilted_gravity(const Vec3& gravity, std::span<const Effect> effects);

}  // namespace repose
