#include <algorithm>

#include <fmt/format.h>

#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

std::vector<std::string> material_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const auto& [name, material] : scene.materials) names.push_back(name);
  return names;
}

// Names may hold a hyphen themselves, so a key is read by trying all pairs of materials rather than by splitting it.
std::pair<std::string, std::string> resolve_pair(const YamlReader& pair, const std::string& key, const Scene& scene) {
  const std::vector<std::string> names = material_names(scene);
  std::vector<std::pair<std::string, std::string>> found;
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t j = i; j < names.size(); ++j) {
      keys.push_back(names[i] + "-" + names[j]);
      if (key == keys.back()) found.emplace_back(names[i], names[j]);
      if (i != j && key == names[j] + "-" + names[i])
        pair.fail("the two materials are not in alphabetical order", fmt::format("write `{}`", keys.back()));
    }
  }
  if (found.size() > 1)
    pair.fail("this key fits more than one pair of materials", "rename a material so that its name holds no `-`");
  if (found.empty()) {
    const Suggestion suggestion = suggest("no such pair of materials:", key, keys);
    pair.fail(suggestion.problem, suggestion.remedy);
  }
  return found.front();
}

PairLaw read_law(const YamlReader& pair) {
  pair.only({"friction", "rolling_friction", "spinning_friction", "rolling_friction_length", "spinning_friction_length",
             "friction_arm", "restitution", "cohesion", "cohesion_range"});
  PairLaw law;
  pair.read("friction", law.friction, non_negative(dimension::none));
  pair.read("rolling_friction", law.rolling_friction, non_negative(dimension::none));
  pair.read("spinning_friction", law.spinning_friction, non_negative(dimension::none));
  pair.read("rolling_friction_length", law.rolling_friction_length, non_negative(dimension::length));
  pair.read("spinning_friction_length", law.spinning_friction_length, non_negative(dimension::length));
  if (pair.has("friction_arm")) {
    constexpr FrictionArm arms[] = {FrictionArm::reduced_radius, FrictionArm::double_reduced_radius,
                                    FrictionArm::mean_radius};
    law.friction_arm = arms[pair.at("friction_arm").choice({"reduced_radius", "double_reduced_radius", "mean_radius"})];
  }
  pair.read("restitution", law.restitution, between(0, 1));
  pair.read("cohesion", law.cohesion, non_negative(dimension::force));
  pair.read("cohesion_range", law.cohesion_range, non_negative(dimension::length));
  return law;
}

}  // namespace

void read_materials(const YamlReader& block, Scene& scene) {
  for (const auto& [name, reader] : block.named()) {
    reader.only({"density"});
    Material material{name, 0};
    reader.require("density", material.density, positive(dimension::density));
    scene.materials.emplace(name, material);
  }
}

void read_pairs(const YamlReader& block, Scene& scene) {
  for (const auto& [key, reader] : block.named())
    scene.pairs.emplace(resolve_pair(reader, key, scene), read_law(reader));
}

std::string read_material_name(const YamlReader& owner, const Scene& scene) {
  const YamlReader reader = owner.at("material");
  const std::string name = reader.text();
  if (!scene.materials.contains(name)) {
    const Suggestion suggestion = suggest("no such material:", name, material_names(scene));
    reader.fail(suggestion.problem, suggestion.remedy);
  }
  return name;
}

}  // namespace repose
