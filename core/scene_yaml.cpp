#include "core/scene_yaml.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

// No scene is larger; a wrong file (a recording, a disk image) often is.
constexpr std::uintmax_t largest_file = 64'000'000;

std::string read_file(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw Error(file.string(), "no such file", "check the name of the scene file");
  if (std::filesystem::is_directory(status))
    throw Error(file.string(), "is a directory",
                "name the scene file inside it, e.g. " + (file / "scene.yaml").string());
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(file, error) > largest_file)
    throw Error(file.string(), "is too large for a scene", "a scene is YAML text of a few kilobytes");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(file.string(), "cannot be read", "check its permissions");
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad()) throw Error(file.string(), "cannot be read to its end", "check the disk");
  return text.str();
}

// A file of proportions is written into the scene in its place, so that the resolved text stands on its own.
void inline_proportions(YamlNode& root, const std::string& name, const std::filesystem::path& folder) {
  YamlNode* block = root.find("grain_shapes");
  if (block == nullptr || block->kind != YamlNode::Kind::scalar) return;
  const std::filesystem::path file = folder / block->text;
  YamlNode content;
  try {
    content = parse_yaml(read_file(file), file.string());
  } catch (const Error& error) {
    throw Error(fmt::format("{}:{}: grain_shapes", name, block->line), error.what(),
                "name a file, or write the map here");
  }
  if (content.kind == YamlNode::Kind::map && content.find("grain_shapes") != nullptr)
    content = *content.find("grain_shapes");
  *block = std::move(content);
}

void name_whole_paths(YamlNode& shape, const std::filesystem::path& folder) {
  if (shape.kind == YamlNode::Kind::map)
    if (YamlNode* file = shape.find("file"); file != nullptr && file->kind == YamlNode::Kind::scalar)
      file->text = std::filesystem::absolute(folder / file->text).lexically_normal().string();
  for (YamlNode& item : shape.items) name_whole_paths(item, folder);
  for (YamlEntry& entry : shape.entries) name_whole_paths(entry.value, folder);
}

/// So that the resolved text can be read in any folder: sizes that stand in a file are written out, meshes named by their whole path.
void stand_alone(YamlNode& root, const Scene& scene, const std::filesystem::path& folder) {
  if (YamlNode* shapes = root.find("shapes")) name_whole_paths(*shapes, folder);
  YamlNode* grains = root.find("grains");
  for (const GrainPopulation& population : scene.grains) {
    const auto* table = std::get_if<TableSize>(&population.size.law);
    YamlNode* block = table == nullptr ? nullptr : grains->find(population.name);
    YamlNode* size = block == nullptr ? nullptr : block->find("size");
    YamlNode* list = size == nullptr ? nullptr : size->find("table");
    if (list == nullptr || list->kind != YamlNode::Kind::scalar) continue;
    *list = YamlNode{YamlNode::Kind::sequence, "", {}, {}, list->line};
    for (const double value : table->values) list->items.push_back({YamlNode::Kind::scalar, fmt::format("{}", value), {}, {}, list->line});
  }
}

/// A tree whose proportions are in it.
Scene scene_of(const YamlNode& tree, const std::string& name, const std::filesystem::path& folder) {
  if (tree.kind != YamlNode::Kind::map)
    throw Error(name, fmt::format("is {}; a scene is a map", describe(tree)),
                "write blocks such as `materials:`, `pairs:`, `bodies:`, `duration:`");
  const YamlReader root(tree, name);
  root.only({"materials", "pairs", "shapes", "bodies", "grains", "tools", "grain_shapes", "gravity", "periodic", "effects",
             "layer", "solver", "duration", "frame_interval", "record"});
  Scene scene;
  read_materials(root.at("materials"), scene);
  if (root.has("pairs")) read_pairs(root.at("pairs"), scene);
  if (root.has("grain_shapes")) read_proportions(root.at("grain_shapes"), scene);
  if (root.has("shapes")) read_shapes(root.at("shapes"), folder, scene);
  if (root.has("bodies")) read_bodies(root.at("bodies"), scene);
  if (root.has("grains")) read_grains(root.at("grains"), folder, scene);
  if (root.has("tools")) read_tools(root.at("tools"), scene);
  if (root.has("layer")) read_layer(root.at("layer"), scene);
  root.read("gravity", scene.gravity, any(dimension::acceleration));
  if (root.has("periodic")) read_periodic(root.at("periodic"), scene);
  if (root.has("effects")) read_effects(root.at("effects"), scene);
  if (root.has("solver")) read_solver(root.at("solver"), scene);
  root.require("duration", scene.duration, positive(dimension::time));
  scene.frame_interval = std::max(scene.duration / 100, scene.solver.time_step);
  root.read("frame_interval", scene.frame_interval, positive(dimension::time));
  if (root.has("record")) check_record(root.at("record"));

  for (const Tool& tool : scene.tools)
    for (const SceneBody& body : scene.bodies)
      if (tool.name == body.name)
        root.at("tools").at(tool.name).fail("a body has the same name",
                                            "names of bodies and tools are one list: rename one");
  if (scene.bodies.empty() && scene.grains.empty())
    root.fail("nothing to simulate: neither `bodies` nor `grains`", "add a body or a population of grains");
  return scene;
}

}  // namespace

void read_solver(const YamlReader& block, Scene& scene) {
  block.only({"time_step", "tolerance", "max_iterations", "method", "law", "integration", "warm_start", "search_margin"});
  SolverOptions& options = scene.solver;
  block.read("time_step", options.time_step, positive(dimension::time));
  block.read("tolerance", options.tolerance,
             {.dimension = dimension::none, .lower = 0, .upper = 1, .lower_open = true});
  if (block.has("max_iterations")) {
    const std::size_t count = block.at("max_iterations").count();
    if (count > 10'000'000) block.at("max_iterations").fail("more than ten million", "a few hundred usually suffice");
    options.max_iterations = static_cast<int>(count);
  }
  if (block.has("method")) {
    constexpr SolverKind solvers[] = {SolverKind::gauss_seidel, SolverKind::apgd, SolverKind::barzilai_borwein};
    options.kind = solvers[block.at("method").choice({"gauss_seidel", "apgd", "barzilai_borwein"})];
  }
  if (block.has("law"))
    options.law = block.at("law").choice({"exact", "relaxed"}) == 0 ? ContactLaw::exact : ContactLaw::relaxed;
  if (block.has("integration"))
    options.integration = block.at("integration").choice({"symplectic_euler", "second_order"}) == 0 ? Integration::symplectic_euler
                                                                                                    : Integration::second_order;
  block.read("warm_start", options.warm_start);
  block.read("search_margin", options.search_margin, between(1, 100));
}

void check_record(const YamlReader& block) {
  block.only({"rate", "noise", "dropouts", "observables", "runs", "conceal", "free", "calibrate"});
  if (block.has("rate")) block.at("rate").number(positive(dimension::frequency));
}

Scene parse_scene(const std::string& text, const std::string& name, const std::vector<Override>& overrides,
                  const std::filesystem::path& folder) {
  YamlNode tree = parse_yaml(text, name);
  if (tree.kind == YamlNode::Kind::map)
    for (const Override& change : overrides) set_path(tree, change.path, change.value);
  inline_proportions(tree, name, folder);
  Scene scene = scene_of(tree, name, folder);
  stand_alone(tree, scene, folder);
  scene.text = emit_yaml(tree);
  return scene;
}

Scene read_scene(YamlNode tree, const std::string& name, const std::filesystem::path& folder) {
  inline_proportions(tree, name, folder);
  return scene_of(tree, name, folder);
}

Scene load_scene(const std::filesystem::path& file, const std::vector<Override>& overrides) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  return parse_scene(read_file(file), file.string(), overrides, folder);
}

}  // namespace repose
