#include "analysis/render/camera.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
/// Half of the vertical opening angle of the perspective view: narrow, so that a heap is hardly distorted.
constexpr double half_opening = 11 * pi / 180;
constexpr double iso_elevation = 27 * pi / 180, iso_azimuth = 30 * pi / 180;
/// A tool is framed as far as it lies within this many extents of the bodies that move.
constexpr double tool_reach = 0.8;

struct Ball {
  Vec3 centre;
  double radius;
};

struct Bounds {
  Vec3 lower = Vec3::Constant(infinity), upper = Vec3::Constant(-infinity);
  void include(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  bool holds(const Vec3& p) const { return (p.array() >= lower.array()).all() && (p.array() <= upper.array()).all(); }
};

/// Points of the body frame whose hull holds the primitive, roughly; nothing for a half-space.
void outline(const Primitive& primitive, const Pose& pose, std::vector<Vec3>& points) {
  const auto add = [&](const Vec3& local) { points.push_back(pose.to_world(local)); };
  const auto ring = [&](double r, double z) {
    for (int i = 0; i < 48; ++i) add({r * std::cos(i * pi / 24), r * std::sin(i * pi / 24), z});
  };
  const auto corners = [&](const Vec3& half) {
    for (int i = 0; i < 8; ++i)
      add({i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(), i & 4 ? half.z() : -half.z()});
  };
  std::visit(
      [&](const auto& p) {
        using T = std::decay_t<decltype(p)>;
        if constexpr (std::is_same_v<T, Sphere>)
          corners(Vec3::Constant(p.radius / std::sqrt(3.0)));
        else if constexpr (std::is_same_v<T, Ellipsoid>)
          corners(p.semi_axes / std::sqrt(3.0));
        else if constexpr (std::is_same_v<T, RoundCone>)
          add(Vec3::Zero()), add({p.length, 0, 0});
        else if constexpr (std::is_same_v<T, Cone>)
          ring(p.radius, 0), add({0, 0, p.height});
        else if constexpr (std::is_same_v<T, Box>)
          corners(p.half_extents);
        else if constexpr (std::is_same_v<T, Cylinder>)
          ring(p.radius, -p.half_height), ring(p.radius, p.half_height);
        else if constexpr (std::is_same_v<T, Revolved>)
          for (const Vec2& q : p.profile) ring(q.x(), q.y());
        else if constexpr (std::is_same_v<T, TriMesh>)
          for (const Vec3& v : p.vertices) add(v);
      },
      primitive);
}

bool drawn(const Model& model, std::size_t body, double time, const std::vector<std::string>& hide) {
  const Body& b = model.bodies[body];
  if (!b.exists_at(time)) return false;
  return b.name < 0 || std::find(hide.begin(), hide.end(), model.names[static_cast<std::size_t>(b.name)]) == hide.end();
}

/// The box of the middle 99 % of the balls, widened by a sixth on every side.
Bounds middle_box(const std::vector<Ball>& balls) {
  Bounds box;
  std::vector<double> values(balls.size());
  const std::size_t cut = balls.size() / 200;
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(balls.begin(), balls.end(), values.begin(), [&](const Ball& b) { return b.centre[axis]; });
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(cut);
    std::nth_element(values.begin(), low, values.end());
    box.lower[axis] = *low;
    const auto high = values.end() - 1 - static_cast<std::ptrdiff_t>(cut);
    std::nth_element(values.begin(), high, values.end());
    box.upper[axis] = *high;
  }
  const Vec3 margin = (box.upper - box.lower) / 6;
  box.lower -= margin;
  box.upper += margin;
  return box;
}

using Outline = std::vector<Vec3>;

/// One outline for each bounded body that does not move.
std::vector<Outline> tool_outlines(const Model& model, const Snapshot& snapshot, const std::vector<std::string>& hide) {
  std::vector<Outline> outlines;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (body.dynamic || !drawn(model, i, snapshot.time, hide)) continue;
    const Pose pose{snapshot.position[i], snapshot.orientation[i]};
    Outline points;
    for (const Part& part : model.shapes[static_cast<std::size_t>(body.shape)].parts) {
      const Part placed = body.scale == 1 ? part : scaled(part, body.scale);
      outline(placed.primitive, pose.compose(placed.pose), points);
    }
    if (!points.empty()) outlines.push_back(std::move(points));
  }
  return outlines;
}

double lowest(const Outline& points) {
  double z = infinity;
  for (const Vec3& p : points) z = std::min(z, p.z());
  return z;
}

/// What the picture has to hold.
std::vector<Ball> framed_balls(const Model& model, std::span<const Snapshot> snapshots, const FrameOptions& options) {
  std::vector<Ball> balls;
  std::vector<Outline> tools;
  for (const Snapshot& snapshot : snapshots) {
    std::vector<Outline> outlines = tool_outlines(model, snapshot, options.hide);
    double floor = infinity;
    for (const Outline& points : outlines) floor = std::min(floor, lowest(points));
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      const Body& body = model.bodies[i];
      if (!body.dynamic || !drawn(model, i, snapshot.time, options.hide)) continue;
      if (!outlines.empty() && snapshot.position[i].z() < floor) continue;
      balls.push_back(
          {snapshot.position[i], model.shapes[static_cast<std::size_t>(body.shape)].bounding_radius * body.scale});
    }
    std::move(outlines.begin(), outlines.end(), std::back_inserter(tools));
  }
  if (balls.empty()) {
    for (const Outline& points : tools)
      for (const Vec3& p : points) balls.push_back({p, 0});
    return balls;
  }
  Bounds box = middle_box(balls);
  double largest = 0;
  for (const Ball& b : balls) largest = std::max(largest, b.radius);
  box.lower -= Vec3::Constant(largest);
  box.upper += Vec3::Constant(largest);
  std::erase_if(balls, [&](const Ball& b) { return !box.holds(b.centre); });
  const double top = box.upper.z(), reach = tool_reach * (box.upper - box.lower).maxCoeff();
  box.lower -= Vec3::Constant(reach);
  box.upper += Vec3::Constant(reach);
  for (const Outline& points : tools) {
    if (lowest(points) > top) continue;  // it hangs above everything, as a funnel does
    for (const Vec3& p : points)
      if (box.holds(p)) balls.push_back({p, 0});
  }
  return balls;
}

/// In the camera's axes: right, up, forward.
Bounds projected(const std::vector<Ball>& balls, const CameraAxes& axes) {
  Bounds extent;
  for (const Ball& b : balls)
    for (const double r : {-b.radius, b.radius})
      extent.include(Vec3(axes.right.dot(b.centre), axes.up.dot(b.centre), axes.forward.dot(b.centre)) +
                     Vec3::Constant(r));
  return extent;
}

/// Moves the camera along its own axes until the projections of all balls just fit.
void fit(Camera& camera, const std::vector<Ball>& balls, double aspect, double margin) {
  const CameraAxes axes = camera_axes(camera);
  const Bounds extent = projected(balls, axes);
  const Vec3 centre = 0.5 * (extent.lower + extent.upper), half = 0.5 * (extent.upper - extent.lower);
  camera.target = centre.x() * axes.right + centre.y() * axes.up + centre.z() * axes.forward;
  const double depth = std::max(half.norm(), 1e-300);
  if (camera.orthographic) {
    camera.view_height = 2 * std::max({half.y(), half.x() / aspect, 1e-3 * depth}) / (1 - 2 * margin);
    camera.eye = camera.target - (2 * depth + 2 * camera.view_height) * axes.forward;
    return;
  }
  const double tan_y = std::tan(half_opening) * (1 - 2 * margin), tan_x = tan_y * aspect;
  double distance = 0;
  for (int round = 0; round < 8; ++round) {
    distance = 0;
    double low_x = infinity, high_x = -infinity, low_y = infinity, high_y = -infinity;
    for (const Ball& b : balls) {
      const Vec3 p = b.centre - camera.target;
      const double x = std::abs(axes.right.dot(p)) + b.radius, y = std::abs(axes.up.dot(p)) + b.radius;
      distance = std::max(distance, std::max(x / tan_x, y / tan_y) - axes.forward.dot(p) + b.radius);
    }
    for (const Ball& b : balls) {
      const Vec3 p = b.centre - camera.target;
      const double d = distance + axes.forward.dot(p);
      low_x = std::min(low_x, (axes.right.dot(p) - b.radius) / d);
      high_x = std::max(high_x, (axes.right.dot(p) + b.radius) / d);
      low_y = std::min(low_y, (axes.up.dot(p) - b.radius) / d);
      high_y = std::max(high_y, (axes.up.dot(p) + b.radius) / d);
    }
    camera.target += 0.5 * distance * ((low_x + high_x) * axes.right + (low_y + high_y) * axes.up);
  }
  camera.eye = camera.target - distance * axes.forward;
  camera.view_height = 2 * distance * std::tan(half_opening);
}

}  // namespace

View view_named(std::string_view name) {
  if (name == "iso") return View::iso;
  if (name == "side") return View::side;
  if (name == "top") return View::top;
  throw Error("--view", "there is no view '" + std::string(name) + "'", "choose iso, side or top");
}

CameraAxes camera_axes(const Camera& camera) {
  const Vec3 sight = camera.target - camera.eye;
  const Vec3 right = sight.cross(camera.up);
  const bool finite = camera.eye.allFinite() && camera.target.allFinite() && camera.up.allFinite();
  if (!finite || !(right.norm() > 1e-9 * sight.norm() * camera.up.norm()) || !(camera.view_height > 0) ||
      !std::isfinite(camera.view_height))
    throw Error(
        "camera", "its line of sight, its up vector or its view height is degenerate",
        "eye and target must differ, up must not be parallel to the line of sight, view_height must be positive");
  CameraAxes axes;
  axes.forward = sight.normalized();
  axes.right = right.normalized();
  axes.up = axes.right.cross(axes.forward);
  return axes;
}

namespace {

std::vector<Ball> checked_balls(const Model& model, std::span<const Snapshot> snapshots, const FrameOptions& options) {
  if (!(options.aspect > 0) || !(options.margin >= 0 && options.margin < 0.45))
    throw Error("camera", "the aspect ratio must be positive and the margin in [0, 0.45)", "check width and height");
  for (const Snapshot& s : snapshots)
    if (s.size() != model.bodies.size())
      throw Error("camera", "the snapshot and the model have different numbers of bodies",
                  "use a frame of the same run");
  std::vector<Ball> balls = framed_balls(model, snapshots, options);
  if (balls.empty())
    throw Error("camera", "there is nothing to show: no body that moves, no bounded tool",
                "hide fewer bodies, or place the camera by hand");
  return balls;
}

/// Looks at the origin from the view's direction.
Camera facing(const FrameOptions& options) {
  const double a = options.azimuth_deg * pi / 180 + (options.view == View::iso ? iso_azimuth : 0);
  Vec3 back(std::sin(a), -std::cos(a), 0);  // from the target to the eye
  Camera camera;
  if (options.view == View::iso) back = back * std::cos(iso_elevation) + std::sin(iso_elevation) * Vec3::UnitZ();
  if (options.view == View::top) {
    back = Vec3::UnitZ();
    camera.up = Vec3::UnitY();
  }
  camera.orthographic = options.view != View::iso;
  camera.target = Vec3::Zero();
  camera.eye = back;
  return camera;
}

}  // namespace

Camera frame_scene(const Model& model, std::span<const Snapshot> snapshots, const FrameOptions& options) {
  const std::vector<Ball> balls = checked_balls(model, snapshots, options);
  Camera camera = facing(options);
  fit(camera, balls, options.aspect, options.margin);
  return camera;
}

Camera frame_scene(const Model& model, const Snapshot& snapshot, const FrameOptions& options) {
  return frame_scene(model, std::span<const Snapshot>(&snapshot, 1), options);
}

double fitting_aspect(const Model& model, std::span<const Snapshot> snapshots, const FrameOptions& options) {
  const std::vector<Ball> balls = checked_balls(model, snapshots, options);
  const CameraAxes axes = camera_axes(facing(options));
  const Bounds extent = projected(balls, axes);
  const Vec3 size = extent.upper - extent.lower;
  return size.y() > 0 ? std::clamp(size.x() / size.y(), 0.8, 1.6) : 1.6;
}

}  // namespace repose
