#pragma once
/// A constant of the scene that nobody measured, as a parameter.
#include "analysis/diagnosis/hypothesis.hpp"
#include "core/effect_library.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {

/// Within the library's bounds where an effect has the key; else a factor of ten about the number that the scene has. It starts from that
/// number, or else where the effect does nothing. Throws Error where neither gives bounds.
Parameter calibrated_constant(const std::string& key, const YamlNode& scene, const NaturalScale& scale);

}  // namespace repose::diagnosis
