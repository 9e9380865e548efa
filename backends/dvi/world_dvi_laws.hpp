#pragma once
/// The contact effects of a model (core/contact_effects.hpp) as numbers of a cone problem, in the world's own units.
#include "backends/dvi/cone_problem.hpp"
#include "backends/dvi/impact.hpp"
#include "backends/dvi/units.hpp"
#include "core/model.hpp"

namespace repose::dvi {

class ContactLaws {
 public:
  /// The model must outlive the laws.
  ContactLaws(const Model& model, const Units& units);

  bool any() const { return any_; }
  bool compliant() const { return compliance_ != nullptr; }

  /// Empties and sets what the problem as a whole needs.
  void begin(ConeProblem& problem) const;

  /// Completes the contact last built: `contact` has the pair's law, and `impact` its restitution; `before`: velocity
  /// of b against a at the contact at the start of the step; `step`: h.
  void apply(ConeProblem& problem, ConeContact& contact, ImpactData& impact, const Vec3& before, double step) const;

 private:
  void give_way(const ConeProblem& problem, ConeContact& contact, ImpactData& impact, double step) const;

  Units units_;
  bool any_;
  const RateDependentFriction* rate_;
  const AnisotropicFriction* anisotropy_;
  const RateDependentRestitution* restitution_;
  const LiquidBridge* bridge_;
  const ContactCompliance* compliance_;
  Vec3 direction_ = Vec3::UnitX();
};

}  // namespace repose::dvi
