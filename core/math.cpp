#include "core/math.hpp"

#include <cmath>

namespace repose {

Quat rotation_of(const Vec3& w) {
  const double angle = w.norm();
  // sin(a/2)/a by its series where the quotient would lose digits.
  const double s = angle > 1e-4 ? std::sin(0.5 * angle) / angle : 0.5 - angle * angle / 48.0;
  Quat q(std::cos(0.5 * angle), s * w.x(), s * w.y(), s * w.z());
  return q.normalized();
}

}  // namespace repose
