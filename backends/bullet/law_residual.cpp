#include "backends/bullet/law_residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "backends/dvi/cone.hpp"
#include "backends/dvi/impact.hpp"

namespace repose::bullet {

namespace {

double turning_response(const dvi::InverseMass& body, const Vec3& arm, const Vec3& normal) {
  const Vec3 t = arm.cross(normal);
  const auto& m = body.inertia;
  const Vec3 response(m[0] * t.x() + m[1] * t.y() + m[2] * t.z(), m[1] * t.x() + m[3] * t.y() + m[4] * t.z(),
                      m[2] * t.x() + m[4] * t.y() + m[5] * t.z());
  return body.mass + t.dot(response);
}

}  // namespace

double law_residual(const dvi::ConeProblem& problem, std::span<const dvi::Impulse> impulse,
                    std::span<const Vec3> velocity, std::span<const Vec3> angular_velocity) {
  double error = 0, size = 0, kinetic = 0;
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const dvi::ConeContact& c = problem.contacts[i];
    const double l = turning_response(problem.inverse_mass[static_cast<std::size_t>(c.a)], c.arm_a, c.normal) +
                     turning_response(problem.inverse_mass[static_cast<std::size_t>(c.b)], c.arm_b, c.normal);
    dvi::Impulse u = dvi::relative_velocity(c, velocity, angular_velocity);
    u[0] += c.bias + c.friction * std::hypot(u[1], u[2]) + c.rolling * std::hypot(u[3], u[4]) +
            c.spinning * std::abs(u[5]);
    dvi::Impulse g = impulse[i];
    for (std::size_t k = 0; k < 6; ++k) g[k] -= u[k] / l;
    g[0] += c.cohesion;
    dvi::project_on_cone(g[0], g[1], g[2], g[3], g[4], g[5], c.friction, c.rolling, c.spinning);
    g[0] -= c.cohesion;
    for (std::size_t k = 0; k < 6; ++k) {
      error += l * (impulse[i][k] - g[k]) * (impulse[i][k] - g[k]);
      size += l * impulse[i][k] * impulse[i][k];
    }
  }
  if (error == 0) return 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(problem.dynamic_bodies); ++i)
    kinetic += problem.velocity[i].squaredNorm() / problem.inverse_mass[i].mass;
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::sqrt(kinetic);
  return std::sqrt(error) / std::max(std::sqrt(size), std::max(rounding, std::numeric_limits<double>::min()));
}

}  // namespace repose::bullet
