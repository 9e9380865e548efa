#pragma once
/// Materials, and the contact laws of *pairs* of materials.
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace repose {

struct Material {
  std::string name;
  double density = 0;  ///< of the solid [kg/m^3], > 0
};

/// Which length turns the dimensionless rolling and spinning friction into the arm of the resisting moment.
/// The source study does not say; `reduced_radius` is this project's default, the others exist to be compared with it.
enum class FrictionArm {
  reduced_radius,         ///< R* = R1 R2 / (R1 + R2); on a plane R* = R
  double_reduced_radius,  ///< 2 R*
  mean_radius,            ///< (R1 + R2) / 2; on a plane R
};

/// The contact law between two materials. Impulse cone and units: cone_problem.hpp.
struct PairLaw {
  double friction = 0;              ///< mu, sliding: |f_t| <= mu f_n [1], >= 0
  double rolling_friction = 0;      ///< rho, dimensionless: |tau_roll| <= rho * arm * f_n, >= 0
  double spinning_friction = 0;     ///< sigma, dimensionless: |tau_spin| <= sigma * arm * f_n, >= 0
  double rolling_friction_length = 0;   ///< the arm itself [m]; adds to rolling_friction * arm. >= 0
  double spinning_friction_length = 0;  ///< as above, for spinning [m]
  FrictionArm friction_arm = FrictionArm::reduced_radius;
  double restitution = 0;           ///< e, v+ = -e v-, in [0, 1]
  double cohesion = 0;              ///< c, attraction that the contact can hold [N], >= 0; independent of the step
  double cohesion_range = 0;        ///< gap up to which cohesion acts [m], >= 0; a property of the material

  bool operator==(const PairLaw&) const = default;
};

/// Arms of the rolling and spinning moments for a given pair of grains.
struct FrictionArms {
  double rolling = 0;   ///< [m]: |tau_roll| <= rolling * f_n
  double spinning = 0;  ///< [m]
};

/// `radius_a`, `radius_b`: of the spheres of equal volume [m], > 0; infinity for a plane or a tool.
FrictionArms friction_arms(const PairLaw& law, double radius_a, double radius_b);

/// R* = Ra Rb / (Ra + Rb) [m]; either radius may be infinite, not both.
double reduced_radius(double radius_a, double radius_b);

}  // namespace repose
