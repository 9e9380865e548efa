#include "core/yaml_tree.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "core/error.hpp"
#include "core/nearest.hpp"

namespace repose {
namespace {

// Deeper nesting is never a scene, and each level costs a stack frame.
constexpr int deepest = 64;

struct Conversion {
  const std::string& name;
  int nodes = 0;

  [[noreturn]] void fail(int line, const std::string& problem, const std::string& remedy) const {
    throw Error(line > 0 ? fmt::format("{}:{}", name, line) : name, problem, remedy);
  }

  YamlNode convert(const YAML::Node& from, int depth) {
    YamlNode to;
    to.line = from.Mark().is_null() ? 0 : from.Mark().line + 1;
    if (++nodes > yaml_limit) fail(to.line, "too many values", "a scene has thousands of values, not millions");
    if (depth > deepest) fail(to.line, fmt::format("nested more than {} levels deep", deepest), "check the brackets");
    if (from.IsScalar()) {
      to.kind = YamlNode::Kind::scalar;
      to.text = from.Scalar();
    } else if (from.IsSequence()) {
      to.kind = YamlNode::Kind::sequence;
      for (const YAML::Node& item : from) to.items.push_back(convert(item, depth + 1));
    } else if (from.IsMap()) {
      to.kind = YamlNode::Kind::map;
      std::map<std::string, int> lines;
      for (const auto& entry : from) add_entry(to, lines, entry.first, entry.second, depth);
    }
    return to;
  }

  void add_entry(YamlNode& to, std::map<std::string, int>& lines, const YAML::Node& key, const YAML::Node& value,
                 int depth) {
    const int line = key.Mark().is_null() ? to.line : key.Mark().line + 1;
    if (!key.IsScalar()) fail(line, "a key is not a word", "write `key: value`");
    const auto [earlier, is_new] = lines.emplace(key.Scalar(), line);
    if (!is_new)
      fail(line, fmt::format("key `{}` is given twice, first on line {}", key.Scalar(), earlier->second),
           "keep one of them");
    to.entries.push_back({key.Scalar(), line, convert(value, depth + 1)});
  }
};

// Values of an override carry no line: their place is the override itself.
void forget_lines(YamlNode& node) {
  node.line = 0;
  for (YamlNode& item : node.items) forget_lines(item);
  for (YamlEntry& entry : node.entries) {
    entry.line = 0;
    forget_lines(entry.value);
  }
}

std::vector<std::string> keys_of(const YamlNode& node) {
  std::vector<std::string> keys;
  for (const YamlEntry& entry : node.entries) keys.push_back(entry.key);
  return keys;
}

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

void emit(YAML::Emitter& out, const YamlNode& node, bool flow) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      out << YAML::Null;
      break;
    case YamlNode::Kind::scalar:
      out << node.text;
      break;
    case YamlNode::Kind::sequence: {
      // Lists of maps (parts of a compound, observables) read better as blocks.
      const bool plain = flow || std::all_of(node.items.begin(), node.items.end(), [](const YamlNode& item) {
                           return item.kind == YamlNode::Kind::scalar || item.kind == YamlNode::Kind::null;
                         });
      if (plain) out << YAML::Flow;
      out << YAML::BeginSeq;
      for (const YamlNode& item : node.items) emit(out, item, plain);
      out << YAML::EndSeq;
      break;
    }
    case YamlNode::Kind::map:
      if (flow) out << YAML::Flow;
      out << YAML::BeginMap;
      for (const YamlEntry& entry : node.entries) {
        out << YAML::Key << entry.key << YAML::Value;
        emit(out, entry.value, flow);
      }
      out << YAML::EndMap;
      break;
  }
}

// Lengths in front of texts and lists: no two trees run together to the same key.
void append_key(const YamlNode& node, std::string& key) {
  const auto append = [&](char kind, std::size_t length, const std::string& text) {
    key += kind;
    key += std::to_string(length);
    key += ':';
    key += text;
  };
  switch (node.kind) {
    case YamlNode::Kind::null: key += '~'; break;
    case YamlNode::Kind::scalar: append('"', node.text.size(), node.text); break;
    case YamlNode::Kind::sequence:
      append('[', node.items.size(), "");
      for (const YamlNode& item : node.items) append_key(item, key);
      break;
    case YamlNode::Kind::map:
      append('{', node.entries.size(), "");
      for (const YamlEntry& entry : node.entries) {
        append('"', entry.key.size(), entry.key);
        append_key(entry.value, key);
      }
      break;
  }
}

}  // namespace

const YamlNode* YamlNode::find(const std::string& key) const {
  for (const YamlEntry& entry : entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

YamlNode* YamlNode::find(const std::string& key) {
  for (YamlEntry& entry : entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

YamlNode parse_yaml(const std::string& text, const std::string& name) {
  Conversion conversion{name};
  if (text.find('\0') != std::string::npos)
    conversion.fail(0, "not a text file (it holds NUL bytes)", "a scene is YAML text; `repose check --help` shows one");
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1)
      conversion.fail(documents[1].Mark().line + 1, "a second YAML document begins here",
                      "one scene per file: remove `---`");
    if (documents.empty() || documents[0].IsNull())
      conversion.fail(0, "empty", "a scene is a YAML map; `repose check --help` shows one");
    return conversion.convert(documents[0], 0);
  } catch (const YAML::Exception& error) {
    conversion.fail(error.mark.is_null() ? 0 : error.mark.line + 1, "not valid YAML: " + error.msg,
                    "check indentation (blanks, no tabs), brackets, and the blank after each colon near this line");
  }
}

const YamlNode* node_at(const YamlNode& root, const std::string& path) {
  const YamlNode* node = &root;
  for (std::size_t from = 0; node != nullptr && from <= path.size();) {
    const std::size_t dot = std::min(path.find('.', from), path.size());
    const std::string part = path.substr(from, dot - from);
    if (node->kind == YamlNode::Kind::sequence) {
      const bool index = !part.empty() && part.size() < 7 && part.find_first_not_of("0123456789") == std::string::npos;
      node = index && std::stoul(part) < node->items.size() ? &node->items[std::stoul(part)] : nullptr;
    } else {
      node = node->find(part);
    }
    from = dot + 1;
  }
  return node;
}

void set_path(YamlNode& root, const std::string& path, const std::string& value) {
  const std::string place = "--set " + path;
  const std::vector<std::string> parts = split_path(path);
  if (std::any_of(parts.begin(), parts.end(), [](const std::string& part) { return part.empty(); }))
    throw Error(place, "the path has an empty part", "write `--set block.name.key=value`");

  YamlNode replacement;
  if (!value.empty()) {
    replacement = parse_yaml(value, place);
    forget_lines(replacement);
  }

  constexpr std::array named_blocks{"bodies", "grains", "materials", "shapes", "tools"};
  const bool named = std::find(named_blocks.begin(), named_blocks.end(), parts[0]) != named_blocks.end();
  YamlNode* node = &root;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string& part = parts[i];
    if (node->kind == YamlNode::Kind::sequence) {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
      if (error != std::errc() || end != part.data() + part.size() || index >= node->items.size())
        throw Error(place, fmt::format("`{}` is not an index of a list of {}", part, node->items.size()),
                    "indices count from 0");
      node = &node->items[index];
      continue;
    }
    if (node->kind == YamlNode::Kind::scalar)
      throw Error(place, fmt::format("`{}` lies inside a plain value, {}", part, describe(*node)),
                  "shorten the path, or set the whole value");
    node->kind = YamlNode::Kind::map;
    auto entry =
        std::find_if(node->entries.begin(), node->entries.end(), [&](const YamlEntry& e) { return e.key == part; });
    if (entry == node->entries.end()) {
      const std::vector<std::string> keys = keys_of(*node);
      const std::string near = nearest(part, keys);
      if (named && i == 1 && i + 1 < parts.size())
        throw Error(place,
                    fmt::format("`{}` has no `{}`{}", parts[0], part,
                                near.empty() ? "" : fmt::format("; did you mean `{}`?", near)),
                    "names here: " + listing(keys));
      entry = node->entries.insert(entry, {part, 0, YamlNode{}});
    }
    if (i + 1 == parts.size()) entry->line = 0;
    node = &entry->value;
  }
  *node = std::move(replacement);
}

std::string emit_yaml(const YamlNode& root) {
  YAML::Emitter out;
  emit(out, root, false);
  return std::string(out.c_str()) + "\n";
}

std::string tree_key(const YamlNode& root) {
  std::string key;
  append_key(root, key);
  return key;
}

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null:
      return "nothing";
    case YamlNode::Kind::sequence:
      return fmt::format("a list of {}", node.items.size());
    case YamlNode::Kind::map:
      return "a map";
    case YamlNode::Kind::scalar:
      break;
  }
  if (node.text.empty()) return "an empty text";
  return "`" + (node.text.size() > 60 ? node.text.substr(0, 57) + "..." : node.text) + "`";
}

}  // namespace repose
