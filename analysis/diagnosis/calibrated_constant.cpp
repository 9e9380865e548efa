#include "analysis/diagnosis/calibrated_constant.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.hpp"
#include "core/quantity.hpp"

namespace repose::diagnosis {
namespace {

/// Whether `key` is that of the parameter, with any name in the place of `*`.
bool has_key(const EffectParameter& parameter, const std::string& key) {
  const std::size_t star = parameter.key.find('*');
  if (star == std::string::npos) return !parameter.key.empty() && parameter.key == key;
  if (key.size() + 1 < parameter.key.size() || !key.starts_with(parameter.key.substr(0, star)) || !key.ends_with(parameter.key.substr(star + 1))) return false;
  return key_at(parameter, key.substr(star, key.size() - (parameter.key.size() - 1))) == key;
}

const EffectParameter* of_library(const std::string& key) {
  for (const EffectRow& row : effect_library())
    for (const EffectParameter& parameter : row.parameters)
      if (row.name != "wall_friction" && has_key(parameter, key)) return &parameter;
  return nullptr;
}

std::optional<double> number_at(const YamlNode& scene, const std::string& key) {
  const YamlNode* node = node_at(scene, key);
  if (node == nullptr || node->kind != YamlNode::Kind::scalar) return std::nullopt;
  return parse_quantity(node->text, dimension::none);
}

}  // namespace

Parameter calibrated_constant(const std::string& key, const YamlNode& scene, const NaturalScale& scale) {
  Parameter p;
  p.key = key;
  const std::optional<double> stated = number_at(scene, key);
  if (const EffectParameter* known = of_library(key)) {
    const EffectBounds bounds = bounds_of(*known, scale);
    p.unit = known->unit;
    p.lower = bounds.lower;
    p.upper = bounds.upper;
    p.null = bounds.nominal;
    p.logarithmic = known->log_scaled;
    p.start = std::clamp(stated.value_or(bounds.nominal), p.lower, p.upper);
  } else {
    const double value = stated.value_or(0);
    if (value == 0) throw Error("calibrate: " + key, "its search has no bounds", "state a value other than zero for it in the scene");
    p.lower = std::min(value / 10, value * 10);
    p.upper = std::max(value / 10, value * 10);
    p.start = p.null = value;
    p.logarithmic = value > 0;
  }
  p.step = 1e-3 * std::max(std::abs(p.start), 0.1 * std::min(p.upper - p.lower, 10.0));
  return p;
}

}  // namespace repose::diagnosis
