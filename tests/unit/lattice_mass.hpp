#pragma once
/// Mass, centre and inertia of anything that can say whether it contains a point: the slow oracle for mass_properties.
#include <cmath>

#include "core/shape.hpp"

namespace repose::test {

/// Counts points of the box of half extents `half` about `centre`, spread evenly by the additive sequence of the
/// "plastic number" (the real root of x^4 = x + 1): a quasi-Monte-Carlo integration, off by about 2e-4 with a million
/// points.
template <class Inside>
MassProperties lattice_mass(const Inside& inside, const Vec3& centre, const Vec3& half, int points) {
  const double root = 1.2207440846057594754;
  const Vec3 stride(1 / root, 1 / (root * root), 1 / (root * root * root));
  double count = 0;
  Vec3 first = Vec3::Zero(), unit = Vec3::Constant(0.5);
  Mat3 second = Mat3::Zero();
  for (int i = 0; i < points; ++i) {
    for (int k = 0; k < 3; ++k) {
      unit[k] += stride[k];
      if (unit[k] >= 1) unit[k] -= 1;
    }
    const Vec3 p = half.cwiseProduct(2 * unit - Vec3::Ones());
    if (!inside(Vec3(centre + p))) continue;
    count += 1;
    first += p;
    second += p * p.transpose();
  }
  const double cell = 8 * half.prod() / points;
  const Vec3 mean = first / count;
  const Mat3 central = cell * (second - count * mean * mean.transpose());
  return {cell * count, centre + mean, central.trace() * Mat3::Identity() - central};
}

}  // namespace repose::test
