#include "backends/dvi/world_dvi_laws.hpp"

#include <cmath>
#include <numbers>

namespace repose::dvi {

namespace {

constexpr double along_the_normal = 1e-9;  // sine of the angle below which a direction has no projection

/// Inverse mass that an impulse along the normal meets on one side.
double inverse_mass(const InverseMass& m, const Vec3& arm, const Vec3& normal) {
  const Vec3 t = arm.cross(normal);
  const std::array<double, 6>& i = m.inertia;
  return m.mass + m.lift * normal.z() * normal.z() + i[0] * t.x() * t.x() + i[3] * t.y() * t.y() + i[5] * t.z() * t.z() +
         2 * (i[1] * t.x() * t.y() + i[2] * t.x() * t.z() + i[4] * t.y() * t.z());
}

}  // namespace

ContactLaws::ContactLaws(const Model& model, const Units& units)
    : units_(units),
      any_(!model.contact_effects.empty()),
      rate_(find_contact_effect<RateDependentFriction>(model.contact_effects)),
      anisotropy_(find_contact_effect<AnisotropicFriction>(model.contact_effects)),
      restitution_(find_contact_effect<RateDependentRestitution>(model.contact_effects)),
      bridge_(find_contact_effect<LiquidBridge>(model.contact_effects)),
      compliance_(find_contact_effect<ContactCompliance>(model.contact_effects)) {
  if (anisotropy_ == nullptr) return;
  const double angle = anisotropy_->direction_deg * std::numbers::pi / 180;
  direction_ = {std::cos(angle), std::sin(angle), 0};
}

void ContactLaws::begin(ConeProblem& problem) const {
  problem.across = anisotropy_ ? anisotropy_->ratio : 1;
  problem.slip_law.friction.clear();
  problem.slip_law.slope = rate_ && rate_->slope > 0 ? rate_->slope : 0;
  problem.slip_law.speed = rate_ ? rate_->reference_speed / units_.velocity() : 1;
}

void ContactLaws::apply(ConeProblem& problem, ConeContact& contact, ImpactData& impact, const Vec3& before,
                        double step) const {
  contact.compliance = 0;
  contact.along = Vec3::Zero();
  if (rate_) {
    problem.slip_law.friction.push_back(contact.friction);
    const double slip = (before - contact.normal.dot(before) * contact.normal).norm();
    contact.friction = rate_dependent_friction(rate_->slope, contact.friction, slip / problem.slip_law.speed);
  }
  if (anisotropy_) {
    const Vec3 along = direction_ - contact.normal.dot(direction_) * contact.normal;
    if (along.norm() > along_the_normal) contact.along = along.normalized();
  }
  if (restitution_ && impact.before < 0)
    impact.restitution = restitution_at(*restitution_, impact.restitution, -impact.before * units_.velocity());
  if (bridge_) contact.cohesion += step * (bridge_force(*bridge_, impact.gap * units_.length) / units_.force());
  if (compliance_) give_way(problem, contact, impact, step);
}

void ContactLaws::give_way(const ConeProblem& problem, ConeContact& contact, ImpactData& impact, double step) const {
  const double stiffness = compliance_->stiffness / (units_.mass / (units_.time * units_.time));
  const double damping = compliance_->damping / (units_.mass / units_.time);
  const double w =
      inverse_mass(problem.inverse_mass[static_cast<std::size_t>(contact.a)], contact.arm_a, contact.normal) +
      inverse_mass(problem.inverse_mass[static_cast<std::size_t>(contact.b)], contact.arm_b, contact.normal);
  const double z = step * step * stiffness * w;
  // g = -h (k gap + s u_n) with s = theta h k + d, written as u_n + bias + eps g = 0. A contact that is still open
  // closes first: spring and damper see only what lies beyond.
  const double s = z / (1 + z) * step * stiffness + damping;
  contact.compliance = 1 / (step * s);
  contact.bias = impact.gap > 0 ? impact.gap / step : impact.gap * stiffness / s;
  if (z < 1) impact.restitution = 0;
}

}  // namespace repose::dvi
