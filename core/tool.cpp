#include "core/tool.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/body_frame.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

/// Half-plane points (r, z) of a solid of revolution.
using Profile = std::vector<Vec2>;

/// Names the key of a bad dimension.
class Check {
 public:
  explicit Check(const Tool& tool) : place_("tools." + tool.name + ".") {}

  void holds(bool condition, const char* key, const std::string& problem, const std::string& remedy) const {
    if (!condition) throw Error(place_ + key, problem, remedy);
  }
  void positive(double value, const char* key) const {
    holds(value > 0 && std::isfinite(value), key, std::string(key) + " must be a positive length",
          "give a length above zero, for example \"2 mm\"");
  }
  void not_negative(double value, const char* key) const {
    holds(value >= 0 && std::isfinite(value), key, std::string(key) + " must not be negative", "give zero or more");
  }
  void positive(const Vec3& size, const char* key) const {
    holds(size.allFinite() && size.minCoeff() > 0, key, std::string(key) + " must be three positive lengths",
          "give [x, y, z], each above zero");
  }

 private:
  std::string place_;
};

/// Drops points that repeat the one before, then those in the middle of an edge along r or z.
Profile tidy(const Profile& profile) {
  Profile distinct;
  for (const Vec2& point : profile)
    if (distinct.empty() || point != distinct.back()) distinct.push_back(point);
  if (distinct.size() > 1 && distinct.front() == distinct.back()) distinct.pop_back();

  Profile corners;
  const std::size_t n = distinct.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &last = distinct[(i + n - 1) % n], &point = distinct[i], &next = distinct[(i + 1) % n];
    const bool along_z = last.x() == point.x() && point.x() == next.x();
    const bool along_r = last.y() == point.y() && point.y() == next.y();
    if (!along_z && !along_r) corners.push_back(point);
  }
  return corners;
}

ToolBody revolved(const char* kind, const Profile& profile, const Pose& pose) {
  Shape shape = make_shape(kind, {Part{Revolved{tidy(profile)}, Pose{}}});
  const Pose placed = body_pose(shape, 1, pose);
  return {std::move(shape), placed, {}};
}

/// A box given by its lowest and highest corner.
ToolBody plate(const char* kind, const Vec3& lower, const Vec3& upper) {
  Shape shape = make_shape(kind, {Part{Box{0.5 * (upper - lower)}, Pose{}}});
  const Pose placed = body_pose(shape, 1, {0.5 * (lower + upper), Quat::Identity()});
  return {std::move(shape), placed, {}};
}

/// Solids of revolution are drawn about z; this lays their axis along y.
Pose axis_along_y(const Vec3& position) {
  const double half = std::numbers::sqrt2 / 2;
  return {position, Quat(half, -half, 0, 0)};
}

/// The inner surface runs from the outlet up the cone and then the cylinder; the wall is `thickness` thick everywhere.
Profile funnel_profile(const Funnel& f) {
  const double outlet = 0.5 * f.outlet_diameter, top = 0.5 * f.top_diameter;
  const double angle = f.half_angle_deg * std::numbers::pi / 180;
  const double cone_height = (top - outlet) / std::tan(angle);
  const double level_width = f.thickness / std::cos(angle);  // of the cone's wall, measured along r
  if (f.wall_height == 0)
    return {{outlet, 0}, {outlet + level_width, 0}, {top + level_width, cone_height}, {top, cone_height}};

  const double rim = cone_height + f.wall_height, outer = top + f.thickness;
  const double knee = (outer - outlet - level_width) / std::tan(angle);  // where the two outer surfaces meet
  if (knee <= 0) return {{outlet, 0}, {outer, 0}, {outer, rim}, {top, rim}, {top, cone_height}};
  return {{outlet, 0}, {outlet + level_width, 0}, {outer, knee}, {outer, rim}, {top, rim}, {top, cone_height}};
}

std::vector<ToolBody> build(const Funnel& f, const Tool& tool) {
  const Check check(tool);
  check.positive(f.outlet_diameter, "outlet_diameter");
  check.holds(f.half_angle_deg > 0 && f.half_angle_deg < 90, "half_angle_deg",
              "the angle between wall and vertical must lie between 0 and 90 degrees", "an hourglass has about 30");
  check.positive(f.top_diameter, "top_diameter");
  check.holds(f.top_diameter > f.outlet_diameter, "top_diameter",
              "the funnel must be wider at the top than at its outlet",
              "make top_diameter larger than outlet_diameter");
  check.not_negative(f.wall_height, "wall_height");
  check.positive(f.thickness, "thickness");
  check.holds(f.opens >= 0, "opens", "the outlet cannot open before the start", "give a time of 0 s or later");
  check.holds(f.closes > f.opens, "closes", "the outlet closes before it opens",
              "make closes later than opens, or leave it out");

  const Pose pose{tool.position, Quat::Identity()};
  std::vector<ToolBody> bodies{revolved("funnel", funnel_profile(f), pose)};

  const double outlet = 0.5 * f.outlet_diameter;
  const double level_width = f.thickness / std::cos(f.half_angle_deg * std::numbers::pi / 180);
  const double radius = outlet + 0.5 * std::min(level_width, outlet);
  ToolBody shutter = revolved("shutter", {{0, -f.thickness}, {radius, -f.thickness}, {radius, 0}, {0, 0}}, pose);
  if (f.opens > 0) shutter.active.push_back({0, f.opens});
  if (f.closes < Interval{}.to) shutter.active.push_back({f.closes, Interval{}.to});
  if (!shutter.active.empty()) bodies.push_back(std::move(shutter));
  return bodies;
}

std::vector<ToolBody> build(const Base& b, const Tool& tool) {
  const Check check(tool);
  check.positive(b.diameter, "diameter");
  check.not_negative(b.rim_height, "rim_height");
  check.not_negative(b.rim_width, "rim_width");
  check.holds(b.rim_width > 0 || b.rim_height == 0, "rim_width", "a rim needs a width", "set rim_width above zero");
  check.not_negative(b.trench_width, "trench_width");
  check.not_negative(b.trench_depth, "trench_depth");
  check.not_negative(b.trench_wall, "trench_wall");

  const double inner = 0.5 * b.diameter, rim = inner + b.rim_width;
  const double thickness = 0.05 * b.diameter;  // of the plate under the floors and of the trench's outer wall
  const Pose pose{tool.position, Quat::Identity()};
  if (b.trench_width == 0) {
    check.holds(b.trench_depth == 0 && b.trench_wall == 0, "trench_width", "a trench needs a width",
                "set trench_width, or leave out trench_depth and trench_wall");
    return {revolved(
        "base", {{0, -thickness}, {rim, -thickness}, {rim, b.rim_height}, {inner, b.rim_height}, {inner, 0}, {0, 0}},
        pose)};
  }
  check.holds(b.trench_wall > 0, "trench_wall", "a trench without an outer wall holds nothing",
              "set trench_wall, its height above the trench's floor");
  check.holds(b.trench_depth > 0 || b.rim_height > 0, "trench_depth",
              "the trench is level with the plate, and no rim parts the two", "set trench_depth or rim_height");
  const double trench = rim + b.trench_width, outer = trench + thickness;
  const double floor = -b.trench_depth, bottom = floor - thickness, wall = floor + b.trench_wall;
  return {revolved("base",
                   {{0, bottom},
                    {outer, bottom},
                    {outer, wall},
                    {trench, wall},
                    {trench, floor},
                    {rim, floor},
                    {rim, b.rim_height},
                    {inner, b.rim_height},
                    {inner, 0},
                    {0, 0}},
                   pose)};
}

std::vector<ToolBody> build(const Plate& p, const Tool& tool) {
  Check(tool).positive(p.size, "size");
  const Vec3 lower = tool.position - Vec3(0.5 * p.size.x(), 0.5 * p.size.y(), p.size.z());
  return {plate("plate", lower, lower + p.size)};
}

std::vector<ToolBody> build(const Floor& f, const Tool& tool) {
  Check(tool).holds(f.normal.allFinite() && f.normal.norm() > 0, "normal", "the normal has no direction",
                    "give the direction that points out of the floor, for example [0, 0, 1]");
  Shape shape = make_shape("floor", {Part{HalfSpace{f.normal.normalized()}, Pose{}}});
  const Pose placed = body_pose(shape, 1, {tool.position, Quat::Identity()});
  return {{std::move(shape), placed, {}}};
}

/// One body per plate, floor first, so that the load on the floor can be told from that on the walls.
std::vector<ToolBody> build(const Container& c, const Tool& tool) {
  const Check check(tool);
  check.positive(c.inner_size, "inner_size");
  check.positive(c.thickness, "thickness");
  const double x = 0.5 * c.inner_size.x(), y = 0.5 * c.inner_size.y(), z = c.inner_size.z(), t = c.thickness;
  const auto add = [&](std::vector<ToolBody>& bodies, const char* kind, const Vec3& lower, const Vec3& upper) {
    bodies.push_back(plate(kind, tool.position + lower, tool.position + upper));
  };
  std::vector<ToolBody> bodies;
  add(bodies, "container_floor", {-x - t, -y - t, -t}, {x + t, y + t, 0});
  add(bodies, "container_wall", {-x - t, -y - t, 0}, {-x, y + t, z});
  add(bodies, "container_wall", {x, -y - t, 0}, {x + t, y + t, z});
  add(bodies, "container_wall", {-x, -y - t, 0}, {x, -y, z});
  add(bodies, "container_wall", {-x, y, 0}, {x, y + t, z});
  if (c.lid) add(bodies, "container_lid", {-x - t, -y - t, z}, {x + t, y + t, z + t});
  return bodies;
}

std::vector<ToolBody> build(const Cup& c, const Tool& tool) {
  const Check check(tool);
  check.positive(c.inner_diameter, "inner_diameter");
  check.positive(c.height, "height");
  check.positive(c.thickness, "thickness");
  const double inner = 0.5 * c.inner_diameter, outer = inner + c.thickness;
  return {revolved("cup",
                   {{0, -c.thickness}, {outer, -c.thickness}, {outer, c.height}, {inner, c.height}, {inner, 0}, {0, 0}},
                   {tool.position, Quat::Identity()})};
}

std::vector<ToolBody> build(const Roller& r, const Tool& tool) {
  const Check check(tool);
  check.positive(r.diameter, "diameter");
  check.positive(r.width, "width");
  const double radius = 0.5 * r.diameter, half = 0.5 * r.width;
  return {revolved("roller", {{0, -half}, {radius, -half}, {radius, half}, {0, half}}, axis_along_y(tool.position))};
}

/// Drawn upright with the middle of its lower face at the origin, then leant and moved so that its lowest line is at `position`.
std::vector<ToolBody> build(const Blade& b, const Tool& tool) {
  const Check check(tool);
  check.positive(b.thickness, "thickness");
  check.positive(b.height, "height");
  check.positive(b.width, "width");
  check.not_negative(b.edge_radius, "edge_radius");
  check.holds(b.edge_radius <= 0.5 * b.thickness && b.edge_radius < b.height, "edge_radius",
              "the edges cannot be rounder than half the thickness", "make edge_radius smaller, or thickness larger");
  check.holds(b.rake_deg > -80 && b.rake_deg < 80, "rake_deg", "the blade must stand within 80 degrees of the vertical",
              "an upright blade has 0");
  const double half = 0.5 * b.thickness, width = 0.5 * b.width, r = b.edge_radius;
  std::vector<Part> parts{{Box{{half, width, 0.5 * (b.height - r)}}, {Vec3(0, 0, 0.5 * (b.height + r)), Quat::Identity()}}};
  if (r > 0) {
    for (const double side : {-1.0, 1.0}) {
      parts.push_back({Cylinder{r, width}, axis_along_y({side * (half - r), 0, r})});
      if (r == half) break;
    }
    if (r < half) parts.push_back({Box{{half - r, width, 0.5 * r}}, {Vec3(0, 0, 0.5 * r), Quat::Identity()}});
  }
  const double rake = b.rake_deg * std::numbers::pi / 180;
  const Quat lean(Eigen::AngleAxisd(rake, Vec3::UnitY()));
  // The edge on the side that it leans to is the lowest; where its centre of rounding is when upright.
  const Vec3 corner(rake > 0 ? half - r : rake < 0 ? r - half : 0, 0, r);
  const Vec3 lowest = lean * corner - Vec3(0, 0, r);
  Shape shape = make_shape("blade", std::move(parts));
  const Pose placed = body_pose(shape, 1, {tool.position - lowest, lean});
  return {{std::move(shape), placed, {}}};
}

std::vector<ToolBody> build(const Drum& d, const Tool& tool) {
  const Check check(tool);
  check.positive(d.inner_diameter, "inner_diameter");
  check.positive(d.inner_width, "inner_width");
  check.positive(d.thickness, "thickness");
  const double inner = 0.5 * d.inner_diameter, outer = inner + d.thickness;
  const double half = 0.5 * d.inner_width, end = half + d.thickness;
  return {revolved(
      "drum", {{0, -end}, {outer, -end}, {outer, end}, {0, end}, {0, half}, {inner, half}, {inner, -half}, {0, -half}},
      axis_along_y(tool.position))};
}

}  // namespace

std::vector<ToolBody> build_tool(const Tool& tool) {
  Check(tool).holds(tool.position.allFinite(), "position", "the position is not finite", "give [x, y, z] in metres");
  return std::visit([&](const auto& kind) { return build(kind, tool); }, tool.kind);
}

}  // namespace repose
