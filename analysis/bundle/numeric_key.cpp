#include "analysis/bundle/numeric_key.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"
#include "core/quantity.hpp"
#include "core/yaml_tree.hpp"

namespace repose {
namespace {

bool is_number(const YamlNode& node) {
  if (node.kind != YamlNode::Kind::scalar) return false;
  try {
    parse_quantity(node.text, dimension::none);
  } catch (const Error&) {
    return false;
  }
  return true;
}

}  // namespace

void check_numeric_key(const YamlReader& reader, const std::string& key, const YamlNode& tree, bool vectors) {
  const YamlNode* value = node_at(tree, key);
  if (value == nullptr || value->kind == YamlNode::Kind::null || is_number(*value)) return;
  if (vectors && value->kind == YamlNode::Kind::sequence && std::all_of(value->items.begin(), value->items.end(), is_number)) return;
  reader.fail(fmt::format("the scene has {} at `{}`, not a plain number", describe(*value), key),
              "name a key whose value is a number in SI, without its unit");
}

}  // namespace repose
