#include "core/contact_effects.hpp"

#include <algorithm>
#include <cmath>

#include "core/model.hpp"

namespace repose {
namespace {

struct NameOf {
  std::string operator()(const RateDependentFriction&) const { return "rate_dependent_friction"; }
  std::string operator()(const AnisotropicFriction&) const { return "anisotropic_friction"; }
  std::string operator()(const RateDependentRestitution&) const { return "rate_dependent_restitution"; }
  std::string operator()(const LiquidBridge&) const { return "liquid_bridge"; }
  std::string operator()(const ContactCompliance&) const { return "contact_compliance"; }
};

}  // namespace

std::string contact_effect_name(const ContactEffect& effect) { return std::visit(NameOf{}, effect); }

std::vector<std::string> contact_effect_names(const Model& model) {
  std::vector<std::string> names;
  for (const ContactEffect& effect : model.contact_effects) names.push_back(contact_effect_name(effect));
  return names;
}

double rate_dependent_friction(double slope, double friction, double slip) {
  if (friction == 0) return 0;
  return std::max(0.0, friction + slope * std::log(std::max(slip, slowest_slip)));
}

double restitution_at(const RateDependentRestitution& effect, double restitution, double speed) {
  if (!(speed > 0)) return restitution;
  return std::min(1.0, restitution * std::pow(speed / effect.reference_speed, -effect.exponent));
}

double bridge_force(const LiquidBridge& effect, double gap) {
  return effect.force * std::clamp(1 - gap / effect.rupture, 0.0, 1.0);
}

}  // namespace repose
