#pragma once
/// Contact effects: laws of all contacts alike, beyond those of the pairs of materials (material.hpp).
#include <string>
#include <variant>
#include <vector>

namespace repose {

struct Model;

/// Friction that depends on the speed s of sliding, by its logarithm (Dieterich 1979, without memory):
///   mu(s) = max(0, mu_pair + slope ln(max(s, s0) / reference_speed)),   s0 = 1e-6 reference_speed.
/// Below s0 the coefficient no longer changes, so a contact at rest has a finite one. A pair without friction stays so.
/// slope > 0 (faster is rougher): mu is that of the slip at the *end* of the step, found together with the impulses, so
/// that creep is stable at any step. slope < 0 (stick-slip): that of the slip at its start, since the end is not
/// unique.
struct RateDependentFriction {
  double slope = 0;            ///< [1] per factor e of speed
  double reference_speed = 0;  ///< [m/s], > 0
};

/// Friction with a grain: mu along a direction, ratio mu across it (orthotropic Coulomb friction, Michalowski & Mroz
/// 1978). In the tangent plane, axis 1 along the direction's projection on it:  (f_1)^2 + (f_2 / ratio)^2 <= (mu
/// f_n)^2, and the force dissipates the most that this allows: f = -mu f_n (u_1, ratio^2 u_2) / |(u_1, ratio u_2)|.
/// Exact: the solver works in the scaled coordinates (u_1, ratio u_2), in which the ellipse is a disc. Where the normal
/// is the direction itself, the axes are those of tangent_frame().
struct AnisotropicFriction {
  double ratio = 1;          ///< [1], > 0
  double direction_deg = 0;  ///< of the direction in the world's x-y plane, from x towards y
};

/// Restitution that falls with the speed u of approach: e(u) = min(1, e_pair (u / reference_speed)^(-exponent)).
/// Plastic spheres: exponent 1/4 (Johnson 1985).
struct RateDependentRestitution {
  double exponent = 0;         ///< [1]
  double reference_speed = 0;  ///< [m/s], > 0
};

/// Liquid between surfaces: at every contact point an attraction  F = force (1 - gap / rupture), gap from 0 to rupture;
/// `force` in touch, nothing beyond rupture. It needs no touch before and has no memory: pulling it open takes the work
/// force rupture / 2. The gap is that of the start of the step.
struct LiquidBridge {
  double force = 0;    ///< [N], >= 0
  double rupture = 0;  ///< [m], > 0
};

/// Contacts that give way: f_n = max(0, -stiffness gap - damping u_n), at every contact point.
///
/// Taken implicitly, as compliance on the diagonal of the cone problem. With z = h^2 stiffness W (W: inverse mass of
/// the contact), the spring's force is that of the gap at the start plus the share theta = z / (1 + z) of its change:
/// stable at any step, sag m g / stiffness exact at any step, almost no numerical damping where z << 1 (a lone
/// oscillator's energy falls by about z^2 per step), strong damping where the step cannot resolve it. At z < 1 the
/// rebound is that of spring and damper and the pair's restitution is not used; at z >= 1 an impact is rigid and
/// follows the pair's restitution.
struct ContactCompliance {
  double stiffness = 0;  ///< k [N/m], > 0
  double damping = 0;    ///< [N s/m], >= 0
};

/// One row per contact effect; scene key in the comment.
using ContactEffect = std::variant<RateDependentFriction,     // rate_dependent_friction
                                   AnisotropicFriction,       // anisotropic_friction
                                   RateDependentRestitution,  // rate_dependent_restitution
                                   LiquidBridge,              // liquid_bridge
                                   ContactCompliance>;        // contact_compliance

/// The scene key of an effect ("liquid_bridge").
std::string contact_effect_name(const ContactEffect& effect);

/// The scene keys of all contact effects of the model: what a backend that has none of them says is unsupported.
std::vector<std::string> contact_effect_names(const Model& model);

/// The effect of type T in the list, or nullptr.
template <class T>
const T* find_contact_effect(const std::vector<ContactEffect>& effects) {
  for (const ContactEffect& effect : effects)
    if (const T* found = std::get_if<T>(&effect)) return found;
  return nullptr;
}

/// Slip speed below which friction no longer changes, in units of the reference speed.
inline constexpr double slowest_slip = 1e-6;

/// mu(s) of a pair with friction `friction`; `slip` in units of the reference speed.
double rate_dependent_friction(double slope, double friction, double slip);

/// e(u) for u > 0 [m/s].
double restitution_at(const RateDependentRestitution& effect, double restitution, double speed);

/// F(gap) >= 0 [N].
double bridge_force(const LiquidBridge& effect, double gap);

}  // namespace repose
