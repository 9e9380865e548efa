#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

const std::vector<std::string>& primitive_names() {
  static const std::vector<std::string> names{"sphere",     "ellipsoid",  "box",  "cylinder", "cone",
                                              "round_cone", "half_space", "mesh", "compound"};
  return names;
}

std::vector<std::string> type_names() {
  std::vector<std::string> names = primitive_names();
  for (const std::string& grain : grain_shape_names())
    if (std::find(names.begin(), names.end(), grain) == names.end()) names.push_back(grain);
  return names;
}

// One of two spellings of a length: the whole, or the half of it.
template <class T>
T read_half(const YamlReader& reader, const std::string& whole, const std::string& half) {
  if (reader.has(whole) == reader.has(half))
    reader.fail(fmt::format("needs one of `{}` and `{}`", whole, half), fmt::format("write `{}: ...`", whole));
  T value{};
  if (reader.has(half)) {
    reader.require(half, value, positive(dimension::length));
    return value;
  }
  reader.require(whole, value, positive(dimension::length));
  return 0.5 * value;
}

std::vector<std::string> with_type(std::vector<std::string> keys, const std::vector<std::string>& extra) {
  keys.push_back("type");
  keys.insert(keys.end(), extra.begin(), extra.end());
  return keys;
}

// `extra`: keys that the owner of the primitive reads itself (the pose of a compound's part).
Primitive read_primitive(const YamlReader& reader, const std::string& type, const std::vector<std::string>& extra,
                         const std::filesystem::path& folder) {
  const NumberRule length = positive(dimension::length);
  const auto only = [&](const std::vector<std::string>& keys) { reader.only(with_type(keys, extra)); };
  if (type == "sphere") {
    only({"radius"});
    Sphere sphere;
    reader.require("radius", sphere.radius, length);
    return sphere;
  }
  if (type == "ellipsoid") {
    only({"semi_axes"});
    Ellipsoid ellipsoid;
    reader.require("semi_axes", ellipsoid.semi_axes, length);
    return ellipsoid;
  }
  if (type == "box") {
    only({"size", "half_extents"});
    return Box{read_half<Vec3>(reader, "size", "half_extents")};
  }
  if (type == "cylinder") {
    only({"radius", "height", "half_height"});
    Cylinder cylinder;
    reader.require("radius", cylinder.radius, length);
    cylinder.half_height = read_half<double>(reader, "height", "half_height");
    return cylinder;
  }
  if (type == "cone") {
    only({"radius", "height"});
    Cone cone;
    reader.require("radius", cone.radius, length);
    reader.require("height", cone.height, length);
    return cone;
  }
  if (type == "round_cone") {
    only({"radius_a", "radius_b", "length"});
    RoundCone cone;
    reader.require("radius_a", cone.radius_a, length);
    reader.require("radius_b", cone.radius_b, non_negative(dimension::length));
    reader.require("length", cone.length, length);
    return cone;
  }
  if (type == "half_space") {
    only({"normal"});
    HalfSpace half_space;
    reader.read("normal", half_space.normal, any(dimension::none));
    if (!(half_space.normal.norm() > 0))
      reader.at("normal").fail("has no direction", "write the outward normal, e.g. [0, 0, 1]");
    half_space.normal.normalize();
    return half_space;
  }
  if (type == "mesh") {
    only({"file"});
    const YamlReader file = reader.at("file");
    try {
      return read_obj(folder / file.text());
    } catch (const Error& error) {
      file.fail(error.what(),
                "give a text OBJ file with `v x y z` and `f a b c` lines, relative to the scene's folder");
    }
  }
  const Suggestion suggestion = suggest("unknown shape type", type, extra.empty() ? type_names() : primitive_names());
  reader.at("type").fail(suggestion.problem, suggestion.remedy);
}

std::vector<Part> read_parts(const YamlReader& reader, const std::filesystem::path& folder) {
  reader.only({"type", "parts"});
  std::vector<Part> parts;
  for (const YamlReader& item : reader.at("parts").items()) {
    if (item.node().kind != YamlNode::Kind::map)
      item.fail("not a map", "write `{type: sphere, radius: ..., position: ...}`");
    Part part;
    part.primitive = read_primitive(item, item.at("type").text(), {"position", "orientation"}, folder);
    item.read("position", part.pose.position, any(dimension::length));
    item.read("orientation", part.pose.orientation);
    parts.push_back(part);
  }
  if (parts.empty()) reader.at("parts").fail("an empty list", "a compound needs at least one part");
  return parts;
}

// A uniform scaling about the origin of a shape whose mass is already known: exact, no second integration.
Shape scaled_shape(const Shape& shape, double factor) {
  Shape result = shape;
  for (Part& part : result.parts) part = scaled(part, factor);
  result.mass.volume *= std::pow(factor, 3);
  result.mass.centre *= factor;
  result.mass.inertia *= std::pow(factor, 5);
  result.own_frame.position *= factor;
  result.bounding_radius *= factor;
  return result;
}

Shape read_grain_shape(const YamlReader& reader, const std::string& type, const GrainProportions& proportions) {
  reader.only({"type", "size", "aspect"});
  double size = 0, aspect = 1;
  reader.require("size", size, positive(dimension::length));
  reader.read("aspect", aspect, positive(dimension::none));
  return scaled_shape(make_grain_shape(type, proportions.with_aspect(aspect)), size);
}

Shape read_shape(const YamlReader& reader, const std::filesystem::path& folder, const GrainProportions& proportions) {
  if (reader.node().kind != YamlNode::Kind::map) reader.only({"type"});
  const std::string type = reader.at("type").text();
  const auto& grains = grain_shape_names();
  const bool is_grain = std::find(grains.begin(), grains.end(), type) != grains.end();
  // `sphere` and `ellipsoid` are both a primitive and a grain shape: a `size` says that the grain shape is meant.
  const auto& primitives = primitive_names();
  const bool is_primitive = std::find(primitives.begin(), primitives.end(), type) != primitives.end();
  if (is_grain && (!is_primitive || reader.has("size"))) return read_grain_shape(reader, type, proportions);
  if (type == "compound") return make_shape("compound", read_parts(reader, folder));
  return make_shape(type, {Part{read_primitive(reader, type, {}, folder), Pose{}}});
}

}  // namespace

void read_proportions(const YamlReader& block, Scene& scene) {
  block.only({"ellipsoid_aspect", "twin_distance", "uneven_twin_radius", "uneven_twin_distance", "cone_apex",
              "side_ellipsoid", "piercing_ellipsoid"});
  GrainProportions& p = scene.proportions;
  const NumberRule ratio = positive(dimension::none);
  block.read("ellipsoid_aspect", p.ellipsoid_aspect, ratio);
  block.read("twin_distance", p.twin_distance, ratio);
  block.read("uneven_twin_radius", p.uneven_twin_radius, ratio);
  block.read("uneven_twin_distance", p.uneven_twin_distance, ratio);
  block.read("cone_apex", p.cone_apex, ratio);
  block.read("side_ellipsoid", p.side_ellipsoid, ratio);
  block.read("piercing_ellipsoid", p.piercing_ellipsoid, ratio);
  for (const std::string& name : grain_shape_names()) {
    try {
      make_grain_shape(name, p);
    } catch (const Error& error) {
      block.fail(fmt::format("makes `{}` impossible: {}", name, error.problem()), error.remedy());
    }
  }
}

void read_shapes(const YamlReader& block, const std::filesystem::path& folder, Scene& scene) {
  for (const auto& [name, reader] : block.named()) {
    try {
      scene.shapes.emplace(name, read_shape(reader, folder, scene.proportions));
    } catch (const Error& error) {
      // What the shape itself refuses knows no line; what this file refuses does.
      if (error.place().find(reader.path()) != std::string::npos) throw;
      reader.fail((error.place().empty() ? "" : error.place() + ": ") + error.problem(), error.remedy());
    }
  }
}

}  // namespace repose
