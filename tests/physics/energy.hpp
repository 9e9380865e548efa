#pragma once
/// Energy and momenta of a whole model.
#include "tests/physics/simulate.hpp"

namespace repose::test {

struct Momentum {
  Vec3 linear = Vec3::Zero();   ///< [kg m/s]
  Vec3 angular = Vec3::Zero();  ///< about the world's origin [kg m^2/s]
};

inline Vec3 spin_momentum(const Simulation& s, std::size_t i) {
  const Mat3 r = s.state().orientation[i].toRotationMatrix();
  return r * s.model().bodies[i].inertia.cwiseProduct(r.transpose() * s.state().angular_velocity[i]);
}

inline double kinetic_energy(const Simulation& s) {
  double energy = 0;
  for (std::size_t i = 0; i < s.model().bodies.size(); ++i) {
    const Body& body = s.model().bodies[i];
    if (!body.dynamic) continue;
    energy += 0.5 * body.mass * s.state().velocity[i].squaredNorm() +
              0.5 * s.state().angular_velocity[i].dot(spin_momentum(s, i));
  }
  return energy;
}

inline Momentum momentum(const Simulation& s) {
  Momentum sum;
  for (std::size_t i = 0; i < s.model().bodies.size(); ++i) {
    const Body& body = s.model().bodies[i];
    if (!body.dynamic) continue;
    sum.linear += body.mass * s.state().velocity[i];
    sum.angular += s.state().position[i].cross(Vec3(body.mass * s.state().velocity[i])) + spin_momentum(s, i);
  }
  return sum;
}

}  // namespace repose::test
