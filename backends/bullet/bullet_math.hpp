#pragma once
/// Vectors and rotations between Repose and Bullet, written so that Bullet's headers stay with whoever calls.
#include "core/math.hpp"

namespace repose::bullet {

/// V: btVector3.
template <class V>
V to_bullet(const Vec3& v) {
  return V(v.x(), v.y(), v.z());
}

template <class V>
Vec3 from_bullet(const V& v) {
  return Vec3(v.x(), v.y(), v.z());
}

/// M: btMatrix3x3.
template <class M>
M to_bullet(const Mat3& m) {
  return M(m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2));
}

}  // namespace repose::bullet
