#pragma once
/// Scenes from YAML, with errors that name file, line, key, what was expected and the nearest valid key.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/scene.hpp"

namespace repose {

struct YamlNode;

/// `--set key.path=value`: replaces one key of the scene before it is read. Values are YAML.
struct Override {
  std::string path, value;
};

Scene load_scene(const std::filesystem::path& file, const std::vector<Override>& overrides = {});

/// As above from text; `name` stands for the file name in messages, `folder` is where relative file names start. Scene::text is the resolved
/// scene, which can be read in any folder: it holds the sizes of a table, and names meshes by their whole path.
Scene parse_scene(const std::string& text, const std::string& name, const std::vector<Override>& overrides = {},
                  const std::filesystem::path& folder = ".");

/// As above from a tree that has been parsed already. Scene::text stays empty: to write it takes longer than to read the tree.
Scene read_scene(YamlNode tree, const std::string& name, const std::filesystem::path& folder = ".");

}  // namespace repose
