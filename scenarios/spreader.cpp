#include "scenarios/spreader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "analysis/bed_structure.hpp"
#include "core/error.hpp"
#include "core/overlap.hpp"

namespace repose {
namespace {

/// The tool standing so that its lowest line is at (x, z).
Tool placed(const Tool& tool, double x, double z) {
  Tool out = tool;
  const auto* roller = std::get_if<Roller>(&tool.kind);
  out.position = {x, tool.position.y(), z + (roller ? 0.5 * roller->diameter : 0.0)};
  out.motion = {};
  return out;
}

/// How far a blade reaches in front of its lowest line [m].
double reach_ahead(const Blade& blade) {
  const double rake = blade.rake_deg * std::numbers::pi / 180;
  return blade.thickness * std::cos(rake) + std::max(0.0, blade.height * std::sin(rake));
}

/// The largest x of the lowest line at which a ball is not touched.
double farthest_start(const Tool& tool, double lowest, const Vec3& centre, double radius) {
  constexpr double anywhere = std::numeric_limits<double>::infinity();
  if (const auto* roller = std::get_if<Roller>(&tool.kind)) {
    const double r = 0.5 * roller->diameter, rise = centre.z() - lowest - r;
    const double square = (r + radius) * (r + radius) - rise * rise;
    return square > 0 ? centre.x() - std::sqrt(square) : anywhere;
  }
  if (centre.z() + radius < lowest) return anywhere;
  return centre.x() - radius - reach_ahead(std::get<Blade>(tool.kind));
}

/// A scene may hold several spreaders to choose from.
bool can_spread(const Tool& tool) { return std::holds_alternative<Roller>(tool.kind) || std::holds_alternative<Blade>(tool.kind); }

constexpr double cut_depth = 1e-7;  // [m]
constexpr double endless = std::numeric_limits<double>::infinity();

/// The smallest box along the axes that holds a piece; infinite for a half-space.
struct Extent {
  Vec3 lower = Vec3::Constant(endless), upper = Vec3::Constant(-endless);
  double along_x() const { return upper.x() - lower.x(); }
};

Extent extent_of(const Shape& shape, const Pose& pose) {
  Extent extent;
  for (const Part& part : shape.parts) {
    const std::vector<Vec3> points = surface_points(part.primitive);
    if (points.empty()) return {Vec3::Constant(-endless), Vec3::Constant(endless)};
    for (const Vec3& point : points) {
      const Vec3 at = pose.to_world(part.pose.to_world(point));
      extent.lower = extent.lower.cwiseMin(at);
      extent.upper = extent.upper.cwiseMax(at);
    }
  }
  return extent;
}

/// Places of the lowest line, between `from` and `to`, at which a piece that stands at x = 0 has to be looked at lest it passes through the other:
/// where both ranges along x touch, half the smaller extent apart, and where their middles meet, for a roller is lowest there.
std::vector<double> places_of_touch(const Extent& piece, const Extent& other, double from, double to) {
  constexpr double most = 1000;
  for (int axis = 1; axis < 3; ++axis)
    if (piece.lower[axis] > other.upper[axis] - cut_depth || other.lower[axis] > piece.upper[axis] - cut_depth) return {};
  const double first = std::max(from, other.lower.x() - piece.upper.x()), last = std::min(to, other.upper.x() - piece.lower.x());
  if (!(first <= last)) return {};
  const double steps = std::clamp(std::ceil((last - first) / (0.5 * std::min(piece.along_x(), other.along_x()))), 8.0, most);
  std::vector<double> places;
  for (int k = 0; k <= static_cast<int>(steps); ++k) places.push_back(first + (last - first) * k / steps);
  const double middles = 0.5 * (other.lower.x() + other.upper.x() - piece.lower.x() - piece.upper.x());
  if (std::isfinite(middles)) places.push_back(std::clamp(middles, first, last));
  return places;
}

/// Tools and fixed bodies stand where they are `time` after the bed began to settle.
void refuse_cuts(const Model& bed, const Tool& spreader, const SpreaderPath& path, double to, double time) {
  const std::vector<ToolBody> pieces = build_tool(placed(spreader, 0, path.lowest));
  for (std::size_t i = 0; i < bed.bodies.size(); ++i) {
    const Body& body = bed.bodies[i];
    if (body.dynamic) continue;
    const Shape& shape = bed.shapes[static_cast<std::size_t>(body.shape)];
    const Pose stands = pose_at(body.motion, {bed.initial.position[i], bed.initial.orientation[i]}, time);
    const Extent extent = extent_of(shape, stands);
    for (const ToolBody& piece : pieces)
      for (const double x : places_of_touch(extent_of(piece.shape, piece.pose), extent, path.from, to)) {
        Pose pose = piece.pose;
        pose.position.x() += x;
        if (cut_into(piece.shape, pose, shape, stands, cut_depth))
          throw Error("layer.gap",
                      fmt::format("at x = {:.4g} m the spreader, its lowest line at z = {:.6g} m, cuts into `{}`", x, path.lowest,
                                  bed.names[static_cast<std::size_t>(body.name)]),
                      "make `gap` larger, lower or shorten what stands in the way, or make the spreader narrower than the walls");
      }
  }
}

/// Something other than rollers and blades is made of it.
bool is_in_the_bed(const Scene& bed, const std::string& material) {
  const auto of_it = [&](const auto& thing) { return thing.material == material; };
  return std::any_of(bed.tools.begin(), bed.tools.end(), of_it) || std::any_of(bed.bodies.begin(), bed.bodies.end(), of_it) ||
         std::any_of(bed.grains.begin(), bed.grains.end(), of_it);
}

}  // namespace

const Tool& spreader_of(const Scene& scene) {
  return *std::find_if(scene.tools.begin(), scene.tools.end(), [&](const Tool& t) { return t.name == scene.layer->spreader; });
}

Scene bed_scene(const Scene& scene) {
  Scene bed = scene;
  std::erase_if(bed.tools, can_spread);
  std::erase_if(bed.materials, [&](const auto& entry) { return !is_in_the_bed(bed, entry.first); });
  std::erase_if(bed.pairs, [&](const auto& entry) { return !is_in_the_bed(bed, entry.first.first) || !is_in_the_bed(bed, entry.first.second); });
  bed.duration = scene.layer->settle;
  bed.solver.time_step = scene.layer->settle_time_step;
  return bed;
}

SpreaderPath spreader_path(const Scene& scene, const Model& model, const Snapshot& settled, double surface) {
  const LayerSetup& layer = *scene.layer;
  const Tool& tool = spreader_of(scene);
  SpreaderPath path;
  path.lowest = layer.plate + layer.gap + (layer.gap_from == LayerSetup::GapFrom::bed ? surface : 0);
  if (!(path.lowest > layer.plate))
    throw Error("layer.gap", "the spreader would cut into the plate", "make `gap` larger");

  const double clearance = 0.01 * mean_diameter(model);
  double farthest = layer.to;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (!body.dynamic) continue;
    const double ball = body.scale * model.shapes[static_cast<std::size_t>(body.shape)].bounding_radius;
    farthest = std::min(farthest, farthest_start(tool, path.lowest, settled.position[i], ball + clearance));
  }
  if (layer.from && *layer.from > farthest)
    throw Error("layer.from", fmt::format("at x = {:.6g} m the spreader stands in the powder", *layer.from),
                fmt::format("leave it out, or start at {:.6g} m or before", farthest));
  path.from = layer.from.value_or(farthest);
  path.duration = (layer.to - path.from) / layer.speed;
  if (!(path.duration > 0))
    throw Error("layer.to", "the spreader finds nothing to spread before it arrives", "make `to` larger, or `gap` smaller");
  refuse_cuts(model, tool, path, layer.to, settled.time);
  return path;
}

Scene spreading_scene(const Scene& scene, const SpreaderPath& path) {
  const LayerSetup& layer = *scene.layer;
  Scene out = scene;
  std::erase_if(out.tools, [&](const Tool& t) { return can_spread(t) && t.name != layer.spreader; });
  Tool& tool = *std::find_if(out.tools.begin(), out.tools.end(), [&](const Tool& t) { return t.name == layer.spreader; });
  tool = placed(tool, path.from, path.lowest);
  tool.motion.velocity = {layer.speed, 0, 0};
  tool.motion.pivot = tool.position;
  tool.motion.stop = path.duration;
  if (const auto* roller = std::get_if<Roller>(&tool.kind); roller && layer.rotation != LayerSetup::Rotation::none) {
    const double sign = layer.rotation == LayerSetup::Rotation::rolling ? 1 : -1;
    tool.motion.angular_velocity = {0, sign * layer.rotation_ratio * layer.speed / (0.5 * roller->diameter), 0};
  }
  out.duration = path.duration + layer.rest;
  return out;
}

}  // namespace repose
