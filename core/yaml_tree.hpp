#pragma once
/// A YAML document as plain data that keeps order, line numbers and duplicate keys: what the scene reader reads.
///
/// Only the scene layer uses it. Aliases are expanded; tags other than "!" are ignored; one document per text.
#include <string>
#include <utility>
#include <vector>

namespace repose {

struct YamlEntry;

struct YamlNode {
  enum class Kind { null, scalar, sequence, map } kind = Kind::null;
  std::string text;                ///< of a scalar
  std::vector<YamlNode> items;     ///< of a sequence
  std::vector<YamlEntry> entries;  ///< of a map, in the order of the text
  int line = 0;                    ///< from 1; 0: the node came from an override

  const YamlNode* find(const std::string& key) const;
  YamlNode* find(const std::string& key);
};

struct YamlEntry {
  std::string key;
  int line = 0;
  YamlNode value;
};

/// Parses one document. Throws Error ("name:line: ...") for malformed YAML, an empty text, binary data, several
/// documents, keys that are not scalars, duplicate keys, and texts or alias expansions beyond `yaml_limit` nodes.
YamlNode parse_yaml(const std::string& text, const std::string& name);
inline constexpr int yaml_limit = 1'000'000;

/// Sets the key at `path` ("grains.powder.size.range.1": map keys and sequence indices) to `value`, YAML text. The
/// names under bodies, grains, materials, shapes and tools must exist; other keys are added where they are missing, and
/// the reader judges them later. Throws Error naming the nearest key.
void set_path(YamlNode& root, const std::string& path, const std::string& value);

/// The node at a path of map keys and sequence indices ("bodies.ball.mass", "gravity.2"); nullptr if it is not there.
const YamlNode* node_at(const YamlNode& root, const std::string& path);

/// Canonical YAML: block maps in the order of the tree, sequences in flow style. Parses back to an equal tree.
std::string emit_yaml(const YamlNode& root);

/// A text that two trees share exactly if they are equal, lines apart: a key for caches, quicker than emit_yaml.
std::string tree_key(const YamlNode& root);

/// "a map", "a list", "`58 um`", "nothing": for messages.
std::string describe(const YamlNode& node);

}  // namespace repose
