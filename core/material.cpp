#include "core/material.hpp"

#include <cmath>

namespace repose {

double reduced_radius(double radius_a, double radius_b) {
  if (std::isinf(radius_a)) return radius_b;
  if (std::isinf(radius_b)) return radius_a;
  return radius_a * radius_b / (radius_a + radius_b);
}

FrictionArms friction_arms(const PairLaw& law, double radius_a, double radius_b) {
  double arm = reduced_radius(radius_a, radius_b);
  if (law.friction_arm == FrictionArm::double_reduced_radius) arm *= 2;
  if (law.friction_arm == FrictionArm::mean_radius) {
    arm = std::isinf(radius_a) ? radius_b : std::isinf(radius_b) ? radius_a : 0.5 * (radius_a + radius_b);
  }
  return {law.rolling_friction * arm + law.rolling_friction_length,
          law.spinning_friction * arm + law.spinning_friction_length};
}

}  // namespace repose
