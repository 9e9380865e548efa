#pragma once
/// Checked reading of a YAML tree: every value knows its place, every map its keys.
///
///   reader.only({"radius", "height"});                         // anything else is an error that names the nearest key
///   reader.require("radius", cone.radius, positive(dimension::length));
///   reader.read("height", cone.height, positive(dimension::length));   // optional: keeps its default
/// All errors are Error with place "file:line: grains.powder.size", what was found and expected, and a remedy.
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/math.hpp"
#include "core/quantity.hpp"
#include "core/yaml_tree.hpp"

namespace repose {

/// What a number must be: its dimension and its bounds.
struct NumberRule {
  Dimension dimension;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false, upper_open = false;  ///< the bound itself is not allowed
  bool degrees = false;  ///< a bare number is in degrees, and so is the result ("0.5 rad" is converted)
};

NumberRule any(const Dimension& dimension);
NumberRule positive(const Dimension& dimension);
NumberRule non_negative(const Dimension& dimension);
NumberRule between(double lower, double upper);  ///< dimensionless, bounds included
NumberRule degrees(double lower, double upper);  ///< bounds excluded

/// A node with its place. Cheap to copy; the tree must outlive it.
class YamlReader {
 public:
  YamlReader(const YamlNode& root, std::string file) : node_(&root), file_(std::move(file)), line_(root.line) {}

  const YamlNode& node() const { return *node_; }
  const std::string& path() const { return path_; }
  std::string place() const;
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;

  /// Demands a map that holds none but these keys.
  void only(const std::vector<std::string>& keys) const;
  bool has(const std::string& key) const;
  YamlReader at(const std::string& key) const;  ///< throws if missing
  std::vector<YamlReader> items() const;        ///< of a list; throws for anything else
  /// The named parts of a map: (name, reader). Names are letters, digits, `_`, `-`.
  std::vector<std::pair<std::string, YamlReader>> named() const;

  double number(const NumberRule& rule) const;
  std::size_t count() const;  ///< a whole number, at least 1
  bool flag() const;
  std::string text() const;
  Vec3 vector(const NumberRule& rule) const;  ///< three numbers
  std::vector<double> numbers(const NumberRule& rule, std::size_t length) const;
  Quat quaternion() const;  ///< [w, x, y, z], unit to 1 %; normalised
  /// The index of a word of the list.
  std::size_t choice(const std::vector<std::string>& words) const;

  /// Required keys, and optional ones that keep their default.
  void require(const std::string& key, double& target, const NumberRule& rule) const { target = at(key).number(rule); }
  void require(const std::string& key, Vec3& target, const NumberRule& rule) const { target = at(key).vector(rule); }
  void read(const std::string& key, double& target, const NumberRule& rule) const;
  void read(const std::string& key, Vec3& target, const NumberRule& rule) const;
  void read(const std::string& key, bool& target) const;
  void read(const std::string& key, Quat& target) const;

 private:
  YamlReader(const YamlReader& parent, const YamlNode& node, const std::string& key, int line);
  std::string shown_path(const std::string& key) const;

  const YamlNode* node_;
  std::string file_, path_;
  int line_ = 0;  ///< of the key; 0 within an override
};

/// `what` with the nearest of `words` and all of them: "unknown shape type `shpere`; did you mean `sphere`?" and a
/// remedy.
struct Suggestion {
  std::string problem, remedy;
};
Suggestion suggest(const std::string& what, const std::string& word, const std::vector<std::string>& words);

}  // namespace repose
