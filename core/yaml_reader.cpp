#include "core/yaml_reader.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/nearest.hpp"

namespace repose {
namespace {

std::string bound_text(double value, const NumberRule& rule) {
  const std::string unit = rule.degrees ? "deg" : rule.dimension == dimension::none ? "" : unit_of(rule.dimension);
  return fmt::format("{}{}{}", value, unit.empty() || value == 0 ? "" : " ", value == 0 ? "" : unit);
}

std::string bounds_text(const NumberRule& rule) {
  const bool low = std::isfinite(rule.lower), high = std::isfinite(rule.upper);
  if (low && high)
    return fmt::format("{} {} and {} {}", rule.lower_open ? "above" : "at least", bound_text(rule.lower, rule),
                       rule.upper_open ? "below" : "at most", bound_text(rule.upper, rule));
  if (low && rule.lower == 0) return rule.lower_open ? "positive" : "zero or positive";
  if (low) return fmt::format("{} {}", rule.lower_open ? "above" : "at least", bound_text(rule.lower, rule));
  return fmt::format("{} {}", rule.upper_open ? "below" : "at most", bound_text(rule.upper, rule));
}

bool within(double value, const NumberRule& rule) {
  return (rule.lower_open ? value > rule.lower : value >= rule.lower) &&
         (rule.upper_open ? value < rule.upper : value <= rule.upper);
}

double parse_degrees(const std::string& text) {
  const bool has_unit = text.find_first_of("dr°") != std::string::npos;
  return has_unit ? parse_quantity(text, dimension::angle) * 180 / std::numbers::pi
                  : parse_quantity(text, dimension::none);
}

}  // namespace

NumberRule any(const Dimension& dimension) { return {.dimension = dimension}; }
NumberRule positive(const Dimension& dimension) { return {.dimension = dimension, .lower = 0, .lower_open = true}; }
NumberRule non_negative(const Dimension& dimension) { return {.dimension = dimension, .lower = 0}; }
NumberRule between(double lower, double upper) {
  return {.dimension = dimension::none, .lower = lower, .upper = upper};
}
NumberRule degrees(double lower, double upper) {
  return {.dimension = dimension::angle,
          .lower = lower,
          .upper = upper,
          .lower_open = true,
          .upper_open = true,
          .degrees = true};
}

Suggestion suggest(const std::string& what, const std::string& word, const std::vector<std::string>& words) {
  const std::string near = nearest(word, words);
  return {fmt::format("{} `{}`{}", what, word, near.empty() ? "" : fmt::format("; did you mean `{}`?", near)),
          words.empty() ? "there are none in this scene" : "known: " + listing(words)};
}

YamlReader::YamlReader(const YamlReader& parent, const YamlNode& node, const std::string& key, int line)
    : node_(&node), file_(parent.file_), path_(parent.shown_path(key)), line_(line) {}

std::string YamlReader::shown_path(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

std::string YamlReader::place() const {
  if (line_ == 0) return path_.empty() ? file_ : "--set " + path_;
  return fmt::format("{}:{}{}{}", file_, line_, path_.empty() ? "" : ": ", path_);
}

void YamlReader::fail(const std::string& problem, const std::string& remedy) const {
  throw Error(place(), problem, remedy);
}

void YamlReader::only(const std::vector<std::string>& keys) const {
  if (node_->kind == YamlNode::Kind::null) fail("empty; expected a map", "keys here: " + listing(keys));
  if (node_->kind != YamlNode::Kind::map)
    fail(fmt::format("is {}; expected a map", describe(*node_)),
         "write `{key: value, ...}`; keys here: " + listing(keys));
  for (const YamlEntry& entry : node_->entries) {
    if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) continue;
    const std::string near = nearest(entry.key, keys);
    YamlReader(*this, entry.value, entry.key, entry.line)
        .fail(fmt::format("unknown key{}", near.empty() ? "" : fmt::format("; did you mean `{}`?", near)),
              "keys here: " + listing(keys));
  }
}

bool YamlReader::has(const std::string& key) const { return node_->find(key) != nullptr; }

YamlReader YamlReader::at(const std::string& key) const {
  for (const YamlEntry& entry : node_->entries)
    if (entry.key == key) return YamlReader(*this, entry.value, key, entry.line);
  fail(fmt::format("key `{}` is missing", key), fmt::format("add `{}: ...` here", key));
}

std::vector<YamlReader> YamlReader::items() const {
  if (node_->kind != YamlNode::Kind::sequence)
    fail(fmt::format("is {}; expected a list", describe(*node_)), "write `[first, second, ...]`");
  std::vector<YamlReader> readers;
  for (std::size_t i = 0; i < node_->items.size(); ++i)
    readers.push_back(YamlReader(*this, node_->items[i], std::to_string(i), node_->items[i].line));
  return readers;
}

std::vector<std::pair<std::string, YamlReader>> YamlReader::named() const {
  if (node_->kind == YamlNode::Kind::null)
    fail("empty; expected a map by name", "write `name: {...}` below it, or leave the block out");
  if (node_->kind != YamlNode::Kind::map)
    fail(fmt::format("is {}; expected a map by name", describe(*node_)), "write `name: {...}` below it");
  std::vector<std::pair<std::string, YamlReader>> result;
  for (const YamlEntry& entry : node_->entries) {
    YamlReader reader(*this, entry.value, entry.key, entry.line);
    const bool good = !entry.key.empty() && entry.key.size() <= 100 &&
                      std::all_of(entry.key.begin(), entry.key.end(), [](unsigned char c) {
                        return c >= 0x80 || std::isalnum(c) != 0 || c == '_' || c == '-';
                      });
    if (!good) reader.fail("not a name", "names are made of letters, digits, `_` and `-`");
    result.emplace_back(entry.key, reader);
  }
  return result;
}

double YamlReader::number(const NumberRule& rule) const {
  const std::string expected = rule.degrees                        ? "an angle in degrees"
                               : rule.dimension == dimension::none ? "a number"
                                                                   : "a number in " + unit_of(rule.dimension);
  if (node_->kind != YamlNode::Kind::scalar)
    fail(node_->kind == YamlNode::Kind::null ? "empty; expected " + expected
                                             : fmt::format("is {}; expected {}", describe(*node_), expected),
         "write one value");
  double value = 0;
  try {
    value = rule.degrees ? parse_degrees(node_->text) : parse_quantity(node_->text, rule.dimension);
  } catch (const Error& error) {
    fail(error.problem(), error.remedy());
  }
  if (!within(value, rule))
    fail(fmt::format("is {}; must be {}", describe(*node_), bounds_text(rule)),
         fmt::format("write {} that is {}", expected, bounds_text(rule)));
  return value;
}

std::size_t YamlReader::count() const {
  const double value = number(positive(dimension::none));
  if (value != std::floor(value) || value > 9e15)
    fail(fmt::format("is {}; expected a whole number", describe(*node_)), "write a count such as 10000");
  return static_cast<std::size_t>(value);
}

bool YamlReader::flag() const {
  if (node_->kind == YamlNode::Kind::scalar) {
    if (node_->text == "true") return true;
    if (node_->text == "false") return false;
  }
  fail(fmt::format("is {}; expected true or false", describe(*node_)), "write `true` or `false`");
}

std::string YamlReader::text() const {
  if (node_->kind != YamlNode::Kind::scalar || node_->text.empty())
    fail(fmt::format("is {}; expected a word", describe(*node_)), "write a name");
  return node_->text;
}

std::vector<double> YamlReader::numbers(const NumberRule& rule, std::size_t length) const {
  if (node_->kind != YamlNode::Kind::sequence || node_->items.size() != length)
    fail(fmt::format("is {}; expected a list of {} numbers", describe(*node_), length),
         length == 3 ? "write `[x, y, z]`" : "write them as `[first, second, ...]`");
  std::vector<double> values;
  for (const YamlReader& item : items()) values.push_back(item.number(rule));
  return values;
}

Vec3 YamlReader::vector(const NumberRule& rule) const {
  const std::vector<double> values = numbers(rule, 3);
  return {values[0], values[1], values[2]};
}

Quat YamlReader::quaternion() const {
  const std::vector<double> values = numbers(any(dimension::none), 4);
  const Quat quaternion(values[0], values[1], values[2], values[3]);
  if (!(std::abs(quaternion.norm() - 1) < 0.01))
    fail(fmt::format("is a quaternion of length {:.4g}; expected a unit one, [w, x, y, z]", quaternion.norm()),
         "write [cos(a/2), sin(a/2) * axis]; no rotation is [1, 0, 0, 0]");
  return quaternion.normalized();
}

std::size_t YamlReader::choice(const std::vector<std::string>& words) const {
  const std::string word = text();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) {
    const Suggestion suggestion = suggest("unknown choice", word, words);
    fail(suggestion.problem, suggestion.remedy);
  }
  return static_cast<std::size_t>(found - words.begin());
}

void YamlReader::read(const std::string& key, double& target, const NumberRule& rule) const {
  if (has(key)) target = at(key).number(rule);
}
void YamlReader::read(const std::string& key, Vec3& target, const NumberRule& rule) const {
  if (has(key)) target = at(key).vector(rule);
}
void YamlReader::read(const std::string& key, bool& target) const {
  if (has(key)) target = at(key).flag();
}
void YamlReader::read(const std::string& key, Quat& target) const {
  if (has(key)) target = at(key).quaternion();
}

}  // namespace repose
