#include "scenarios/study_plan.hpp"

#include <charconv>
#include <set>

#include <fmt/format.h>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/yaml_reader.hpp"
#include "core/yaml_tree.hpp"

namespace repose {
namespace {

constexpr int most_seeds = 10'000;
constexpr std::size_t most_points = 100'000;

std::string as_value(const YamlNode& node) {
  std::string text = emit_yaml(node);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

std::vector<Override> overrides_of(const YamlReader& parent) {
  std::vector<Override> result;
  if (!parent.has("set")) return result;
  const YamlReader block = parent.at("set");
  if (block.node().kind != YamlNode::Kind::map)
    block.fail(fmt::format("is {}; a map of scene keys is expected", describe(block.node())), "write `set: {key.path: value}`");
  for (const YamlEntry& entry : block.node().entries) result.push_back({entry.key, as_value(entry.value)});
  return result;
}

int seeds_of(const YamlReader& block, int otherwise) {
  if (!block.has("seeds")) return otherwise;
  const std::size_t n = block.at("seeds").count();
  if (n > most_seeds) block.at("seeds").fail("more than ten thousand seeds", "eight usually suffice");
  return static_cast<int>(n);
}

// "60 um" as it was written: 60, "um".
struct Written {
  double value = 0;
  std::string unit;
};

std::optional<Written> number_in(const std::string& text) {
  Written w;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), w.value);
  if (error != std::errc()) return std::nullopt;
  const std::string rest(end, text.data() + text.size());
  if (rest.empty()) return w;
  if (rest.front() != ' ') return std::nullopt;
  w.unit = rest.substr(1);
  return w;
}

std::string last_name(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? key : key.substr(dot + 1);
}

// The settings of each entry of a map of lists that go together.
std::vector<std::vector<Override>> together(const YamlReader& map) {
  if (map.node().kind != YamlNode::Kind::map || map.node().entries.empty())
    map.fail(fmt::format("is {}; a map of lists is expected", describe(map.node())), "write `- {key.path: [1, 2, 3]}`");
  std::vector<std::vector<Override>> result;
  for (const YamlEntry& entry : map.node().entries) {
    const YamlReader list = map.at(entry.key);
    const std::vector<YamlReader> items = list.items();
    if (items.empty()) list.fail("the list is empty", "give at least one value");
    if (!result.empty() && items.size() != result.size())
      list.fail(fmt::format("has {} values, the first list of the map has {}", items.size(), result.size()),
                "lists of one map go together: give them the same length, or write a second map to cross them");
    result.resize(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) result[i].push_back({entry.key, as_value(items[i].node())});
  }
  return result;
}

std::vector<std::vector<Override>> crossed(const YamlReader& vary) {
  std::vector<std::vector<Override>> result{{}};
  const std::vector<YamlReader> maps = vary.items();
  if (maps.empty()) vary.fail("the list is empty", "write `- {key.path: [1, 2, 3]}`");
  for (const YamlReader& map : maps) {
    std::vector<std::vector<Override>> next;
    for (const auto& before : result)
      for (const auto& set : together(map)) {
        next.push_back(before);
        next.back().insert(next.back().end(), set.begin(), set.end());
        if (next.size() > most_points) vary.fail("makes more than 100,000 points", "vary less");
      }
    result = std::move(next);
  }
  return result;
}

std::string label_of(const std::vector<Override>& set) {
  std::string label;
  for (const Override& o : set) label += (label.empty() ? "" : ", ") + last_name(o.path) + " " + o.value;
  return label;
}

// What a series takes from the study where it says nothing itself.
struct Defaults {
  std::filesystem::path folder, scene;
  std::vector<Override> set;
  int seeds = 8;
};

void read_series(const std::string& name, const YamlReader& block, const Defaults& defaults, StudyPlan& plan) {
  block.only({"label", "reference", "scene", "set", "vary", "points", "seeds"});
  StudySeries series{name, block.has("label") ? block.at("label").text() : name,
                     block.has("reference") ? block.at("reference").text() : "", "", ""};
  const std::filesystem::path scene = block.has("scene") ? defaults.folder / block.at("scene").text() : defaults.scene;
  std::vector<Override> base = defaults.set;
  for (Override& o : overrides_of(block)) base.push_back(std::move(o));
  const int own_seeds = seeds_of(block, defaults.seeds);
  const std::size_t before = plan.points.size();
  const auto add = [&](const std::vector<Override>& set, std::string label, std::optional<double> x, int n) {
    StudyPoint point{plan.series.size(), std::move(label), x, base, n, scene};
    point.set.insert(point.set.end(), set.begin(), set.end());
    plan.points.push_back(std::move(point));
  };
  if (block.has("vary")) {
    std::set<std::string> units;
    for (const auto& set : crossed(block.at("vary"))) {
      series.x_key = set.front().path;
      const std::optional<Written> x = number_in(set.front().value);
      if (x) units.insert(x->unit);
      add(set, label_of(set), x ? std::optional<double>(x->value) : std::nullopt, own_seeds);
    }
    if (units.size() > 1) block.at("vary").fail("gives the first key in several units", "write all its values in one unit");
    if (!units.empty()) series.x_unit = *units.begin();
  }
  if (block.has("points"))
    for (const YamlReader& point : block.at("points").items()) {
      point.only({"label", "set", "seeds"});
      const std::vector<Override> set = overrides_of(point);
      add(set, point.has("label") ? point.at("label").text() : label_of(set), std::nullopt, seeds_of(point, own_seeds));
    }
  if (plan.points.size() == before) add({}, series.label, std::nullopt, own_seeds);
  plan.series.push_back(std::move(series));
}

}  // namespace

StudyPlan parse_study(const std::string& text, const std::string& name, const std::filesystem::path& folder) {
  const YamlNode tree = parse_yaml(text, name);
  const YamlReader root(tree, name);
  root.only({"title", "scene", "seeds", "first_seed", "set", "series"});
  StudyPlan plan;
  plan.title = root.has("title") ? root.at("title").text() : name;
  if (root.has("first_seed")) plan.first_seed = root.at("first_seed").count();
  const Defaults defaults{folder, folder / root.at("scene").text(), overrides_of(root), seeds_of(root, 8)};
  for (const auto& [key, block] : root.at("series").named()) read_series(key, block, defaults, plan);
  if (plan.points.empty()) root.at("series").fail("there is no point", "add a series");
  if (plan.points.size() > most_points) root.at("series").fail("makes more than 100,000 points", "vary less");
  return plan;
}

StudyPlan load_study(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file))
    throw Error(file.string(), "no such file", "check the name of the study file");
  return parse_study(read_bytes(file), file.string(), file.parent_path());
}

}  // namespace repose
