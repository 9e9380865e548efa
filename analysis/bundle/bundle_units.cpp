#include "analysis/bundle/bundle_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/error.hpp"
#include "core/quantity.hpp"

namespace repose {
namespace {

constexpr double standard_gravity = 9.81;
constexpr double too_far = 50;        // times what a body can reach
constexpr double steepest = 90;       // [deg] of a surface of powder
constexpr double any_speed = 10;      // [m/s] of one whose start is to be estimated
constexpr double too_long = 100;      // times what the scene lasts
constexpr double shortest_slide = 1e-3;  // [m]: what came to rest at once may have moved less than its start suggests
constexpr double thousand_from = 300, thousand_to = 3000;

/// Dimensions of the series that a simulation tells, but for angles (which are told in degrees).
const std::map<std::string, Dimension>& dimensions() {
  constexpr Dimension torque{2, 1, -2, 0};
  static const std::map<std::string, Dimension> known{
      {"discharged_mass", dimension::mass},   {"mass_on_base", dimension::mass}, {"roller_force_x", dimension::force},
      {"roller_force_z", dimension::force},   {"roller_torque", torque},         {"specific_force", dimension::acceleration},
      {"speed", dimension::velocity},         {"height", dimension::length}};
  return known;
}

bool about_a_thousand(double ratio) { return (ratio > thousand_from && ratio < thousand_to) || (1 / ratio > thousand_from && 1 / ratio < thousand_to); }

/// The first position with an observed axis, and the farthest that the body came from it.
struct Path {
  Vec3 first = Vec3::Zero(), start = Vec3::Zero();  ///< observed axes; others are 0
  double extent = 0;
  bool seen = false;
};

Path path_of(const Observation& o, const Vec3& start) {
  Path path;
  for (const Vec3& x : o.position) {
    if (x.array().isNaN().all()) continue;
    Vec3 here = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (std::isfinite(x[k])) here[k] = x[k];
    if (!path.seen) {
      path.first = here;
      for (int k = 0; k < 3; ++k) path.start[k] = std::isfinite(x[k]) ? start[k] : 0;
      path.seen = true;
    }
    for (int k = 0; k < 3; ++k)
      if (std::isfinite(x[k])) path.extent = std::max(path.extent, std::abs(x[k] - path.first[k]));
  }
  return path;
}

bool has_free_velocity(const BundleRun& run, const std::string& body) {
  return std::any_of(run.free.begin(), run.free.end(), [&](const std::string& key) { return key.starts_with("bodies." + body + ".velocity"); });
}

void check_lengths(const BundleRun& run, const Observation& o, const SceneBody& body) {
  const std::string place = fmt::format("run {}: {}: position of `{}`", run.id, o.file, o.body);
  const Path path = path_of(o, body.position);
  const double t = o.time.back(), reach = (body.velocity.norm() + (has_free_velocity(run, o.body) ? any_speed : 0)) * t + 0.5 * standard_gravity * t * t;
  if (path.extent > too_far * reach && reach > 0)
    throw Error(place, fmt::format("it moves {:.3g} m within {:.3g} s, where {:.3g} m is what its start and gravity allow", path.extent, t, reach),
                "positions are in metres, times in seconds: are these millimetres, or milliseconds?");
  // A guess of a free start may be far off, but hardly by the same factor in height.
  const bool is_free = std::find(run.free.begin(), run.free.end(), "bodies." + o.body + ".position") != run.free.end();
  const bool height_too = path.start.z() != 0 && about_a_thousand(path.first.z() / path.start.z());
  const double there = path.first.norm(), here = path.start.norm();
  if ((is_free && !height_too) || there == 0 || here == 0) return;
  const double ratio = there / here;
  if (about_a_thousand(ratio))
    throw Error(place, fmt::format("it begins {:.3g} m from the origin, where the scene starts it {:.3g} m away: a factor of about 1000", there, here),
                ratio > 1 ? "positions are in metres: are these millimetres? Else mend the start in the scene"
                          : "positions are in metres: are these kilometres? Else mend the start in the scene");
}

/// A body's height or speed as a series, against what its start and gravity allow.
void check_series(const BundleRun& run, const Observation& o, const SceneBody& body) {
  const double t = o.time.back(), gained = standard_gravity * t, speed = body.velocity.norm() + any_speed;
  double low = INFINITY, high = -INFINITY;
  for (const double value : o.value)
    if (std::isfinite(value)) low = std::min(low, value), high = std::max(high, value);
  const double seen = o.name == "height" ? high - low : std::max(std::abs(low), std::abs(high));
  const double most = o.name == "height" ? (speed + 0.5 * gained) * t : speed + gained;
  if (seen > too_far * most)
    throw Error(fmt::format("run {}: {}: {} of `{}`", run.id, o.file, o.name, o.body),
                fmt::format("it {} {:.3g} {} within {:.3g} s, where {:.3g} is what its start, at up to {:.3g} m/s, and gravity allow", o.name == "height" ? "changes by" : "reaches",
                            seen, unit_of(dimensions().at(o.name)), t, most, speed),
                "without a `unit`, numbers are in SI units: are these millimetres, or milliseconds?");
}

}  // namespace

Dimension dimension_of(const std::string& observable) {
  if (observable == "position") return dimension::length;
  if (observable == "orientation") return dimension::angle;
  const auto found = dimensions().find(observable);
  return found == dimensions().end() ? dimension::none : found->second;
}

void turn_into_si(const YamlReader& entry, Observation& o) {
  if (o.name == "surface_angle" || o.name == "angle_of_repose") {
    if (o.unit.empty()) o.unit = "rad";
    if (o.unit != "deg" && o.unit != "rad") entry.at("unit").fail(fmt::format("`{}` is an angle, not in `{}`", o.name, o.unit), "write `unit: deg` or rad");
    const double factor = o.unit == "rad" ? 180 / std::numbers::pi : 1;
    for (double& value : o.value) value *= factor;
    o.scalar *= factor;
    o.sd *= factor;
    o.unit = "deg";
    const auto steep = std::find_if(o.value.begin(), o.value.end(), [](double value) { return std::abs(value) > steepest; });
    if (const double angle = steep == o.value.end() ? o.scalar : *steep; std::abs(angle) > steepest)
      entry.fail(fmt::format("`{}` of {:.4g} degrees; without a unit, angles are in radians", o.name, angle), "write `unit: deg` if they are degrees");
    return;
  }
  if (o.unit.empty()) return;
  const bool heights = o.kind == ObservableKind::profile || o.kind == ObservableKind::surface;
  const auto found = dimensions().find(heights ? "height" : o.name);
  if ((o.kind != ObservableKind::series && !heights) || found == dimensions().end()) return;
  double factor = 1;
  try {
    factor = parse_quantity("1 " + o.unit, found->second);
  } catch (const Error& problem) {
    entry.at("unit").fail(fmt::format("not a unit of `{}`: {}", o.name, problem.problem()),
                          fmt::format("it is measured in {}", unit_of(found->second)));
  }
  for (double& value : o.value) value *= factor;
  for (double& x : o.at) x *= factor;
  for (double& y : o.at_y) y *= factor;
  o.unit = unit_of(found->second);
}

std::vector<std::string> doubtful_scales(const BundleRun& run, const Scene& scene) {
  std::vector<std::string> doubts;
  for (const Observation& o : run.observations)
    for (const SceneBody& body : scene.bodies) {
      if (o.kind != ObservableKind::trajectory || body.name != o.body || o.time.empty()) continue;
      const double t = o.time.back(), seen = path_of(o, body.position).extent, expected = body.velocity.norm() * t;
      if (has_free_velocity(run, o.body) || seen == 0) continue;  // what the scene holds of a free start says nothing
      const bool too_long = seen > expected + 0.5 * standard_gravity * t * t, too_short = seen < expected && seen < shortest_slide;
      if (about_a_thousand(seen / expected) && (too_long || too_short))
        doubts.push_back(fmt::format("run {}: `{}` moves {:.3g} m within {:.3g} s, where its start velocity in the scene takes it {:.3g} m; are positions in metres, times in seconds?",
                                     run.id, o.body, seen, o.time.back(), expected));
    }
  return doubts;
}

void check_scales(const BundleRun& run, const Scene& scene) {
  for (const Observation& o : run.observations) {
    if (o.time.empty() || o.kind == ObservableKind::profile) continue;
    if (!scene.layer && o.time.back() > too_long * scene.duration)  // a layer takes as long as its spreader travels
      throw Error(fmt::format("run {}: {}: `{}`", run.id, o.file, o.name),
                  fmt::format("its times end at {:.6g} s, but the scene after {:.6g} s", o.time.back(), scene.duration),
                  "times are in seconds from the start of the scene: are these milliseconds, or a clock of their own? Else make `duration` longer");
    for (const SceneBody& body : scene.bodies) {
      if (body.name != o.body) continue;
      if (o.kind == ObservableKind::trajectory) check_lengths(run, o, body);
      if (o.kind == ObservableKind::series && (o.name == "height" || o.name == "speed")) check_series(run, o, body);
    }
  }
}

}  // namespace repose
