#include <algorithm>
#include <variant>

#include "core/areal_filter.hpp"
#include "core/error.hpp"
#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

const NumberRule length = positive(dimension::length);

/// The name of a roller or blade among the tools.
std::string read_spreader(const YamlReader& block, const Scene& scene) {
  const YamlReader reader = block.at("spreader");
  const std::string name = reader.text();
  std::vector<std::string> names;
  for (const Tool& tool : scene.tools) {
    const bool spreads = std::holds_alternative<Roller>(tool.kind) || std::holds_alternative<Blade>(tool.kind);
    if (spreads && tool.name == name) return name;
    if (spreads) names.push_back(tool.name);
  }
  if (names.empty()) reader.fail("the scene has neither a roller nor a blade", "add a tool of the kind `roller` or `blade`");
  const Suggestion suggestion = suggest("no roller or blade of this name", name, names);
  reader.fail(suggestion.problem, suggestion.remedy);
}

Vec2 read_pair(const YamlReader& reader) {
  const std::vector<double> values = reader.numbers(any(dimension::length), 2);
  return {values[0], values[1]};
}

/// [lowest, highest]
Vec2 read_span(const YamlReader& reader) {
  const Vec2 span = read_pair(reader);
  if (!(span.x() < span.y())) reader.fail("the first is not below the second", "write `[lowest, highest]`");
  return span;
}

void read_region(const YamlReader& reader, LayerSetup& layer) {
  reader.only({"lower", "upper"});
  layer.lower = read_pair(reader.at("lower"));
  layer.upper = read_pair(reader.at("upper"));
  if (!((layer.upper - layer.lower).minCoeff() > 0)) reader.fail("has no area", "each of `upper` must exceed `lower`");
}

void read_surface(const YamlReader& reader, LayerSetup& layer) {
  reader.only({"cell", "square", "further_squares", "s_filter", "l_filter"});
  reader.require("cell", layer.cell, length);
  reader.require("square", layer.square, length);
  reader.read("s_filter", layer.s_filter, non_negative(dimension::length));
  reader.read("l_filter", layer.l_filter, non_negative(dimension::length));
  const Vec2 extent = layer.upper - layer.lower;
  if (layer.cell > 0.1 * extent.minCoeff())
    reader.at("cell").fail("the region is narrower than ten cells", "a tenth of a grain is usual");
  if (extent.prod() / (layer.cell * layer.cell) > 1e9)
    reader.at("cell").fail("the region has more than a billion cells", "a tenth of a grain is usual");
  const auto fits = [&](const YamlReader& at, double square) {
    if (square > extent.minCoeff()) at.fail("is larger than the region", "about one grain diameter is usual");
    if (extent.prod() / (square * square) > 1e9) at.fail("the region has more than a billion squares", "about one grain diameter is usual");
  };
  fits(reader.at("square"), layer.square);
  if (reader.has("further_squares"))
    for (const YamlReader& item : reader.at("further_squares").items()) {
      const double square = item.number(length);
      fits(item, square);
      const auto same = [&](double other) { return std::abs(other - square) < 1e-3 * square; };
      if (same(layer.square) || std::any_of(layer.further_squares.begin(), layer.further_squares.end(), same)) item.fail("is told already", "give each size once");
      layer.further_squares.push_back(square);
    }
  for (const auto& [key, index] : {std::pair{"s_filter", layer.s_filter}, {"l_filter", layer.l_filter}})
    if (index > 0 && index < least_filter_cells * layer.cell)
      reader.at(key).fail("is shorter than three cells: on this grid it is no filter", "make it longer or `cell` smaller, or leave it out for none");
  if (layer.s_filter > extent.minCoeff())
    reader.at("s_filter").fail("is longer than the region: nothing of the surface is left", "a fraction of a grain diameter is usual; leave it out for none");
  if (layer.l_filter > 0 && layer.l_filter <= layer.s_filter)
    reader.at("l_filter").fail("is not above `s_filter`", "it keeps what is shorter, the other what is longer");
}

/// Two plates along x whose faces hold the powder between them.
void add_walls(const YamlReader& reader, Scene& scene) {
  const std::string material = read_material_name(reader, scene);
  const Vec2 x = read_span(reader.at("x")), y = read_span(reader.at("y")), z = read_span(reader.at("z"));
  const double thickness = 0.25 * (y.y() - y.x());
  for (const bool left : {true, false}) {
    Tool wall;
    wall.name = left ? "side_left" : "side_right";
    wall.material = material;
    wall.kind = Plate{{x.y() - x.x(), thickness, z.y() - z.x()}};
    wall.position = {0.5 * (x.x() + x.y()), left ? y.y() + 0.5 * thickness : y.x() - 0.5 * thickness, z.y()};
    for (const Tool& tool : scene.tools)
      if (tool.name == wall.name) reader.fail("there is already a tool `" + wall.name + "`", "rename that tool");
    scene.tools.push_back(wall);
  }
  std::sort(scene.tools.begin(), scene.tools.end(), [](const Tool& a, const Tool& b) { return a.name < b.name; });
}

void read_sides(const YamlReader& reader, const LayerSetup& layer, Scene& scene) {
  if (reader.at("kind").choice({"periodic", "walls"}) == 1) {
    reader.only({"kind", "material", "x", "y", "z"});
    add_walls(reader, scene);
    return;
  }
  reader.only({"kind", "y"});
  const Vec2 y = read_span(reader.at("y"));
  if (layer.lower.y() < y.x() || layer.upper.y() > y.y())
    reader.at("y").fail("the region reaches beyond these sides: the same powder would count twice", "make `layer.region` as wide as the sides, or narrower");
  scene.periodic.lower.y() = y.x();
  scene.periodic.upper.y() = y.y();
}

}  // namespace

void read_layer(const YamlReader& block, Scene& scene) {
  block.only({"spreader", "plate", "gap", "gap_from", "speed", "rotation", "rotation_ratio", "from", "to", "rest", "settle",
              "settle_time_step", "region", "surface", "sides"});
  LayerSetup layer;
  layer.spreader = read_spreader(block, scene);
  block.read("plate", layer.plate, any(dimension::length));
  block.require("gap", layer.gap, any(dimension::length));
  if (block.has("gap_from"))
    layer.gap_from = block.at("gap_from").choice({"bed", "plate"}) == 0 ? LayerSetup::GapFrom::bed : LayerSetup::GapFrom::plate;
  if (layer.gap_from == LayerSetup::GapFrom::plate && !(layer.gap > 0))
    block.at("gap").fail("the spreader would cut into the plate", "give a positive length above the plate");
  block.require("speed", layer.speed, positive(dimension::velocity));
  if (block.has("rotation")) {
    constexpr LayerSetup::Rotation kinds[] = {LayerSetup::Rotation::none, LayerSetup::Rotation::rolling,
                                              LayerSetup::Rotation::counter_rotating};
    layer.rotation = kinds[block.at("rotation").choice({"none", "rolling", "counter_rotating"})];
  }
  block.read("rotation_ratio", layer.rotation_ratio, positive(dimension::none));
  for (const Tool& tool : scene.tools)
    if (tool.name == layer.spreader && std::holds_alternative<Blade>(tool.kind) && layer.rotation != LayerSetup::Rotation::none)
      block.at("rotation").fail("a blade does not turn", "write `rotation: none`, or spread with a roller");
  if (block.has("from")) layer.from = block.at("from").number(any(dimension::length));
  block.require("to", layer.to, any(dimension::length));
  if (layer.from && !(*layer.from < layer.to))
    block.at("to").fail("is not beyond `from`", "the spreader travels along +x: make `to` larger");
  block.read("rest", layer.rest, non_negative(dimension::time));
  block.require("settle", layer.settle, positive(dimension::time));
  block.require("settle_time_step", layer.settle_time_step, positive(dimension::time));
  read_region(block.at("region"), layer);
  read_surface(block.at("surface"), layer);
  if (block.has("sides")) read_sides(block.at("sides"), layer, scene);
  scene.layer = layer;
}

}  // namespace repose
