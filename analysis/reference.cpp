#include "analysis/reference.hpp"

#include <algorithm>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/yaml_reader.hpp"
#include "core/yaml_tree.hpp"

namespace repose {

std::vector<ReferenceValue> ReferenceSet::curve(const std::string& observable) const {
  std::vector<ReferenceValue> result;
  for (const ReferenceValue& v : values)
    if (v.observable == observable && v.x) result.push_back(v);
  std::stable_sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return *a.x < *b.x; });
  return result;
}

std::optional<ReferenceValue> ReferenceSet::single(const std::string& observable) const {
  std::optional<ReferenceValue> found;
  for (const ReferenceValue& v : values) {
    if (v.observable != observable) continue;
    if (found) return std::nullopt;
    found = v;
  }
  return found;
}

ReferenceSet load_reference(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw Error(file.string(), "no such file", "check the name of the reference");
  const YamlNode tree = parse_yaml(read_bytes(file), file.string());
  const YamlReader root(tree, file.string());
  root.only({"title", "source", "method", "x", "values"});
  ReferenceSet set;
  set.title = root.at("title").text();
  set.source = root.at("source").text();
  if (root.has("method")) set.method = root.at("method").text();
  if (root.has("x")) set.x = root.at("x").text();
  for (const YamlReader& item : root.at("values").items()) {
    item.only({"observable", "x", "value", "uncertainty", "unit"});
    ReferenceValue v;
    v.observable = item.at("observable").text();
    v.value = item.at("value").number(any(dimension::none));
    v.unit = item.at("unit").text();
    if (item.has("x")) v.x = item.at("x").number(any(dimension::none));
    if (item.has("uncertainty")) v.uncertainty = item.at("uncertainty").number(positive(dimension::none));
    set.values.push_back(std::move(v));
  }
  return set;
}

std::optional<Line> reference_line(const std::vector<ReferenceValue>& curve) {
  if (curve.size() < 3) return std::nullopt;
  std::vector<double> x, y;
  for (const ReferenceValue& v : curve) {
    x.push_back(v.x.value_or(0));
    y.push_back(v.value);
  }
  return fit_line(x, y);
}

}  // namespace repose
