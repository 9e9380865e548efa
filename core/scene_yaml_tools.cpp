#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

const NumberRule length = positive(dimension::length);
const NumberRule length_or_zero = non_negative(dimension::length);

// The keys of every tool, then those of its kind.
void only(const YamlReader& reader, std::vector<std::string> keys) {
  keys.insert(keys.begin(), {"type", "material", "position", "motion", "yield"});
  reader.only(keys);
}

ToolKind read_funnel(const YamlReader& reader) {
  only(reader, {"outlet_diameter", "half_angle_deg", "top_diameter", "wall_height", "thickness", "opens", "closes"});
  Funnel funnel;
  reader.require("outlet_diameter", funnel.outlet_diameter, length);
  reader.read("half_angle_deg", funnel.half_angle_deg, degrees(0, 90));
  reader.require("top_diameter", funnel.top_diameter, length);
  reader.read("wall_height", funnel.wall_height, length_or_zero);
  reader.require("thickness", funnel.thickness, length);
  reader.read("opens", funnel.opens, non_negative(dimension::time));
  reader.read("closes", funnel.closes, non_negative(dimension::time));
  if (!(funnel.top_diameter > funnel.outlet_diameter))
    reader.at("top_diameter").fail("is not above `outlet_diameter`", "a funnel is wider at its top");
  if (!(funnel.closes > funnel.opens))
    reader.at("closes").fail("is not after `opens`", "give a later time, or leave `closes` out");
  return funnel;
}

ToolKind read_base(const YamlReader& reader) {
  only(reader, {"diameter", "rim_height", "rim_width", "trench_width", "trench_depth", "trench_wall"});
  Base base;
  reader.require("diameter", base.diameter, length);
  reader.read("rim_height", base.rim_height, length_or_zero);
  reader.read("rim_width", base.rim_width, length_or_zero);
  reader.read("trench_width", base.trench_width, length_or_zero);
  reader.read("trench_depth", base.trench_depth, length_or_zero);
  reader.read("trench_wall", base.trench_wall, length_or_zero);
  if (base.rim_height > 0 && base.rim_width == 0) reader.fail("a rim needs a width", "add `rim_width`");
  return base;
}

ToolKind read_plate(const YamlReader& reader) {
  only(reader, {"size"});
  Plate plate;
  reader.require("size", plate.size, length);
  return plate;
}

ToolKind read_floor(const YamlReader& reader) {
  only(reader, {"normal"});
  Floor floor;
  reader.read("normal", floor.normal, any(dimension::none));
  if (!(floor.normal.norm() > 0)) reader.at("normal").fail("has no direction", "write e.g. [0, 0, 1]");
  floor.normal.normalize();
  return floor;
}

ToolKind read_container(const YamlReader& reader) {
  only(reader, {"inner_size", "thickness", "lid"});
  Container container;
  reader.require("inner_size", container.inner_size, length);
  reader.require("thickness", container.thickness, length);
  reader.read("lid", container.lid);
  return container;
}

ToolKind read_cup(const YamlReader& reader) {
  only(reader, {"inner_diameter", "height", "thickness"});
  Cup cup;
  reader.require("inner_diameter", cup.inner_diameter, length);
  reader.require("height", cup.height, length);
  reader.require("thickness", cup.thickness, length);
  return cup;
}

ToolKind read_roller(const YamlReader& reader) {
  only(reader, {"diameter", "width"});
  Roller roller;
  reader.require("diameter", roller.diameter, length);
  reader.require("width", roller.width, length);
  return roller;
}

ToolKind read_blade(const YamlReader& reader) {
  only(reader, {"thickness", "height", "width", "rake_deg", "edge_radius"});
  Blade blade;
  reader.require("thickness", blade.thickness, length);
  reader.require("height", blade.height, length);
  reader.require("width", blade.width, length);
  reader.read("rake_deg", blade.rake_deg, degrees(-80, 80));
  reader.read("edge_radius", blade.edge_radius, length_or_zero);
  return blade;
}

ToolKind read_drum(const YamlReader& reader) {
  only(reader, {"inner_diameter", "inner_width", "thickness"});
  Drum drum;
  reader.require("inner_diameter", drum.inner_diameter, length);
  reader.require("inner_width", drum.inner_width, length);
  reader.require("thickness", drum.thickness, length);
  return drum;
}

struct Kind {
  std::string name;
  ToolKind (*read)(const YamlReader&);
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> table{
      {"funnel", read_funnel},       {"base", read_base}, {"plate", read_plate},   {"floor", read_floor},
      {"container", read_container}, {"cup", read_cup},   {"roller", read_roller}, {"blade", read_blade}, {"drum", read_drum}};
  return table;
}

const Kind& find_kind(const std::string& name, const YamlReader& reader) {
  const std::string type = reader.has("type") ? reader.at("type").text() : name;
  std::vector<std::string> names;
  for (const Kind& kind : kinds()) {
    if (kind.name == type) return kind;
    names.push_back(kind.name);
  }
  const Suggestion suggestion = suggest("unknown tool type", type, names);
  if (reader.has("type")) reader.at("type").fail(suggestion.problem, suggestion.remedy);
  reader.fail(suggestion.problem, "a tool that is not named after its type needs `type: ...`; " + suggestion.remedy);
}

Yield read_yield(const YamlReader& block) {
  block.only({"load", "mass"});
  Yield yield;
  block.require("load", yield.load, non_negative(dimension::force));
  block.require("mass", yield.mass, positive(dimension::mass));
  return yield;
}

Tool read_tool(const std::string& name, const YamlReader& reader, const Scene& scene) {
  if (reader.node().kind != YamlNode::Kind::map) only(reader, {});
  Tool tool;
  tool.name = name;
  tool.kind = find_kind(name, reader).read(reader);
  tool.material = read_material_name(reader, scene);
  reader.read("position", tool.position, any(dimension::length));
  tool.motion.pivot = tool.position;
  if (reader.has("motion")) tool.motion = read_motion(reader.at("motion"), tool.position);
  if (reader.has("yield")) tool.yield = read_yield(reader.at("yield"));
  std::size_t pieces = 0;
  try {
    pieces = build_tool(tool).size();
  } catch (const Error& error) {
    // The tool names its key, "tools.funnel.thickness"; the reader knows the line.
    const std::string key = error.place().substr(std::min(error.place().size(), reader.path().size() + 1));
    (reader.has(key) ? reader.at(key) : reader).fail(error.problem(), error.remedy());
  }
  if (tool.yield && pieces != 1)
    reader.at("yield").fail(fmt::format("a tool of {} pieces cannot yield as one", pieces), "give it to a roller, a blade or a plate");
  return tool;
}

}  // namespace

void read_tools(const YamlReader& block, Scene& scene) {
  for (const auto& [name, reader] : block.named()) scene.tools.push_back(read_tool(name, reader, scene));
  std::sort(scene.tools.begin(), scene.tools.end(), [](const Tool& a, const Tool& b) { return a.name < b.name; });
}

}  // namespace repose
