#include "analysis/render/stage.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/render/grain_colours.hpp"
#include "analysis/render/palette.hpp"

namespace repose {
namespace {

/// A tool is glass if it stands before more than this share of what moves.
constexpr double hidden_share = 0.25;
constexpr std::size_t probes = 500;

const Shape& shape_of(const Model& model, std::size_t body) {
  return model.shapes[static_cast<std::size_t>(model.bodies[body].shape)];
}

struct Drawing {
  const Model& model;
  const Snapshot& snapshot;
  Vec3 origin;
  double scale;

  Vec3 place(std::size_t body) const { return scale * (snapshot.position[body] - origin); }
  void add(std::size_t body, std::vector<Solid>& solids) const {
    const Pose pose{place(body), snapshot.orientation[body]};
    for (const Part& part : shape_of(model, body).parts) {
      Part placed = scaled(part, model.bodies[body].scale * scale);
      solids.push_back({std::move(placed.primitive), pose.compose(placed.pose), static_cast<int>(body)});
    }
  }
};

/// The size that becomes 1: the median of what moves, else of the bounded rest.
double typical_size(const Model& model, const std::vector<std::size_t>& moving, const std::vector<std::size_t>& tools) {
  std::vector<double> sizes;
  for (const auto* list : {&moving, &tools}) {
    for (const std::size_t i : *list)
      if (shape_of(model, i).bounded()) sizes.push_back(shape_of(model, i).bounding_radius * model.bodies[i].scale);
    if (!sizes.empty()) break;
  }
  if (sizes.empty()) return 1;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle > 0 ? *middle : 1;
}

/// A height that no solid lies below: exact for what tools are made of, a bounding ball for the rest.
double lowest(const std::vector<Solid>& solids) {
  double z = std::numeric_limits<double>::infinity();
  for (const Solid& solid : solids) {
    if (const auto* revolved = std::get_if<Revolved>(&solid.primitive)) {
      const Vec3 axis = solid.pose.orientation * Vec3::UnitZ();
      const double tilt = std::hypot(axis.x(), axis.y());
      for (const Vec2& p : revolved->profile)
        z = std::min(z, solid.pose.position.z() + p.y() * axis.z() - p.x() * tilt);
      continue;
    }
    if (const auto* box = std::get_if<Box>(&solid.primitive)) {
      const Mat3 turn = solid.pose.orientation.toRotationMatrix();
      z = std::min(z, solid.pose.position.z() - turn.row(2).cwiseAbs().dot(box->half_extents));
      continue;
    }
    if (const auto* cylinder = std::get_if<Cylinder>(&solid.primitive)) {
      const Vec3 axis = solid.pose.orientation * Vec3::UnitZ();
      z = std::min(z, solid.pose.position.z() - std::abs(axis.z()) * cylinder->half_height -
                          std::hypot(axis.x(), axis.y()) * cylinder->radius);
      continue;
    }
    if (const auto* mesh = std::get_if<TriMesh>(&solid.primitive)) {
      for (const Vec3& v : mesh->vertices) z = std::min(z, solid.pose.to_world(v).z());
      continue;
    }
    z = std::min(z, solid.pose.position.z() - bounding_radius(solid.primitive));
  }
  return z;
}

/// The tools that stand between the camera and much of what moves, or hang above nearly all of it.
std::vector<bool> tools_in_the_way(const Drawing& drawing, const Camera& camera, const std::vector<std::size_t>& moving,
                                   const std::vector<std::size_t>& tools) {
  std::vector<bool> glass(drawing.model.bodies.size(), false);
  if (moving.empty()) return glass;
  std::vector<double> heights;
  for (const std::size_t i : moving) heights.push_back(drawing.place(i).z());
  const auto top = heights.end() - 1 - static_cast<std::ptrdiff_t>(heights.size() / 200);
  std::nth_element(heights.begin(), top, heights.end());

  std::vector<Solid> solids;
  for (const std::size_t i : tools) {
    std::vector<Solid> own;
    drawing.add(i, own);
    if (lowest(own) > *top + 3) glass[i] = true;
    solids.insert(solids.end(), own.begin(), own.end());
  }
  const RayScene scene(std::move(solids));
  std::vector<std::size_t> hides(drawing.model.bodies.size(), 0);
  const CameraAxes axes = camera_axes(camera);
  const Vec3 eye = drawing.scale * (camera.eye - drawing.origin);
  const std::size_t stride = std::max<std::size_t>(1, moving.size() / probes);
  std::size_t count = 0;
  for (std::size_t k = 0; k < moving.size(); k += stride, ++count) {
    const Vec3 end = drawing.place(moving[k]);
    const Vec3 start = camera.orthographic ? Vec3(end - (end - eye).dot(axes.forward) * axes.forward) : eye;
    const double length = (end - start).norm();
    const Vec3 direction = (end - start) / length;
    int last = -1;
    double from = 0;
    RayHit hit;
    for (int i = 0; i < 16 && scene.nearest(start + from * direction, direction, length - from, hit); ++i) {
      if (hit.owner != last) ++hides[static_cast<std::size_t>(hit.owner)];
      last = hit.owner;
      from += hit.distance + 1e-3;
    }
  }
  for (const std::size_t i : tools)
    if (static_cast<double>(hides[i]) > hidden_share * static_cast<double>(count)) glass[i] = true;
  return glass;
}

}  // namespace

bool is_drawn(const Model& model, std::size_t body, double time, const RenderOptions& options) {
  const Body& b = model.bodies[body];
  if (!b.exists_at(time)) return false;
  if (b.dynamic && !options.only.empty() && shape_of(model, body).kind != options.only) return false;
  return b.name < 0 || std::find(options.hide.begin(), options.hide.end(),
                                 model.names[static_cast<std::size_t>(b.name)]) == options.hide.end();
}

ScaledStage build_stage(const Model& model, const Snapshot& snapshot, const Camera& camera,
                        const RenderOptions& options) {
  std::vector<std::size_t> moving, tools;
  std::optional<double> floor;
  std::vector<Vec3> colour(model.bodies.size(), tool_colour());
  const GrainColours colours(model, options.by_population);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (!is_drawn(model, i, snapshot.time, options)) continue;
    const Shape& shape = shape_of(model, i);
    if (model.bodies[i].dynamic) {
      colour[i] = colours.colour(i);
      moving.push_back(i);
      continue;
    }
    const auto* half = shape.parts.size() == 1 ? std::get_if<HalfSpace>(&shape.parts[0].primitive) : nullptr;
    const Pose pose =
        Pose{snapshot.position[i], snapshot.orientation[i]}.compose(shape.parts.empty() ? Pose{} : shape.parts[0].pose);
    if (half && (pose.orientation * half->normal).z() > 1 - 1e-9)
      floor = std::max(floor.value_or(-1e300), pose.position.z());
    else
      tools.push_back(i);
  }

  const Drawing drawing{model, snapshot, camera.target, 1 / typical_size(model, moving, tools)};
  const std::vector<bool> glass = tools_in_the_way(drawing, camera, moving, tools);
  std::vector<Solid> solid, clear, standing;
  for (const std::size_t i : moving) drawing.add(i, solid);
  for (const std::size_t i : tools) {
    if (!shape_of(model, i).bounded())
      drawing.add(i, solid);
    else
      drawing.add(i, glass[i] ? clear : standing);
  }
  std::optional<double> ground;
  if (floor)
    ground = drawing.scale * (*floor - camera.target.z());
  else if (!standing.empty())
    ground = lowest(standing);
  solid.insert(solid.end(), standing.begin(), standing.end());
  return {{RayScene(std::move(solid)), RayScene(std::move(clear)), std::move(colour), ground}, drawing.scale};
}

Stage build_sample(const Shape& shape, const Vec3& colour) {
  const Quat turn(Eigen::AngleAxisd(-0.5, Vec3::UnitY()) * Eigen::AngleAxisd(0.35, Vec3::UnitZ()));
  std::vector<Solid> solids;
  for (const Part& part : shape.parts) {
    Part placed = scaled(part, 0.5 / shape.bounding_radius);
    solids.push_back({std::move(placed.primitive), Pose{Vec3::Zero(), turn}.compose(placed.pose), 0});
  }
  return {RayScene(std::move(solids)), RayScene({}), {colour}, std::nullopt};
}

}  // namespace repose
