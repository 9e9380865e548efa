#pragma once
/// How a free body goes on turning while its axes turn.
#include "core/math.hpp"

namespace repose::dvi {

/// Angular velocity (world) that a body with principal moments `inertia` has at the orientation `after` if it had `spin` at
/// `before` and no torque acted: its angular momentum stays.
inline Vec3 carried_spin(const Vec3& inertia, const Quat& before, const Quat& after, const Vec3& spin) {
  const Mat3 from = before.toRotationMatrix(), to = after.toRotationMatrix();
  const Vec3 momentum = from * inertia.cwiseProduct(from.transpose() * spin);
  return to * (to.transpose() * momentum).cwiseQuotient(inertia);
}

}  // namespace repose::dvi
