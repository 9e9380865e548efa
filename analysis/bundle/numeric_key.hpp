#pragma once
/// Keys of a scene that a fit may turn.
#include <string>

#include "core/yaml_reader.hpp"

namespace repose {

/// Throws Error at `reader` if what the scene has at `key` is neither absent nor a number (for `vectors`: nor a list of numbers): a word
/// cannot be estimated, and a number with a unit would lose it.
void check_numeric_key(const YamlReader& reader, const std::string& key, const YamlNode& tree, bool vectors);

}  // namespace repose
