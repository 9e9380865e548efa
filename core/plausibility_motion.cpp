#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "core/plausibility_checks.hpp"

namespace repose {
namespace {

constexpr double fast = 100, absurdly_fast = 3000;  // [m/s]; 3 km/s: the speed of sound in solids
constexpr double absurd_gravity = 500;              // [m/s^2]
// Shares of sqrt(R/g), the time in which a grain falls about half its radius.
constexpr double coarse_step = 0.3, absurd_step = 10;
constexpr double many_steps = 1e7, too_many_steps = 1e10;
constexpr double contacts_per_grain = 3, usual_iterations = 60, seconds_per_contact = 50e-9;
constexpr double air_viscosity = 1.8e-5;          // [Pa s], 20 C
constexpr double bytes_per_grain_and_frame = 20;  // positions and orientations, compressed

std::string duration_text(double seconds) {
  if (seconds < 120) return fmt::format("{:.2g} s", seconds);
  if (seconds < 7200) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 172800) return fmt::format("{:.1f} h", seconds / 3600);
  return fmt::format("{:.3g} days", seconds / 86400);
}

double equal_radius(const Shape& shape) { return std::cbrt(shape.mass.volume * 0.75 / std::numbers::pi); }

bool is_free(const SceneBody& body) { return !body.fixed && !body.motion; }

// The smallest radius that moves freely, and what it belongs to.
struct Smallest {
  double radius = std::numeric_limits<double>::infinity();
  std::string place;
};

Smallest smallest_radius(const Scene& scene, const std::vector<PopulationFigures>& grains) {
  Smallest smallest;
  const auto offer = [&](double radius, const std::string& place) {
    if (radius < smallest.radius) smallest = {radius, place};
  };
  for (const PopulationFigures& g : grains) offer(0.5 * g.typical, "grains." + g.population->name);
  for (const SceneBody& body : scene.bodies)
    if (is_free(body)) offer(equal_radius(scene.shapes.at(body.shape)), "bodies." + body.name);
  return smallest;
}

// The height that something can fall through: from the highest start to the lowest obstacle.
double fall_height(const Scene& scene) {
  double top = -std::numeric_limits<double>::infinity(), low = std::numeric_limits<double>::infinity();
  for (const GrainPopulation& g : scene.grains)
    top = std::max(top, g.fill.kind == FillRegion::Kind::box ? g.fill.upper.z() : g.fill.base.z() + g.fill.height);
  for (const Tool& tool : scene.tools) low = std::min(low, tool.position.z());
  for (const SceneBody& body : scene.bodies) {
    if (is_free(body)) {
      top = std::max(top, body.position.z());
    } else {
      low = std::min(low, body.position.z());
    }
  }
  return std::isfinite(top) && std::isfinite(low) ? std::max(0.0, top - low) : 0;
}

double highest_start_speed(const Scene& scene) {
  double speed = 0;
  for (const GrainPopulation& g : scene.grains) speed = std::max(speed, g.velocity.norm());
  for (const SceneBody& body : scene.bodies) speed = std::max(speed, body.velocity.norm());
  for (const Tool& tool : scene.tools) speed = std::max(speed, tool.motion.velocity.norm());
  return speed;
}

bool contacts_possible(const Scene& scene) {
  std::size_t bodies = scene.bodies.size() + scene.tools.size();
  for (const GrainPopulation& g : scene.grains) bodies += g.count.value_or(2);
  return bodies > 1;
}

void check_speed(const std::string& place, double speed, Findings& findings) {
  if (speed > absurdly_fast)
    findings.refuse(place, fmt::format("{:.4g} m/s, beyond the speed of sound in solids", speed),
                    fmt::format("did you mean {:.4g} mm/s?", speed));
  else if (speed > fast)
    findings.warn(place, fmt::format("{:.4g} m/s", speed), fmt::format("did you mean {:.4g} mm/s?", speed));
}

void check_inertial_number(const Scene& scene, double radius, Findings& findings) {
  const double gravity = scene.gravity.norm();
  if (gravity == 0) return;
  for (const Tool& tool : scene.tools) {
    const std::string place = "tools." + tool.name;
    if (const Funnel* funnel = std::get_if<Funnel>(&tool.kind))
      findings.note(place, fmt::format("inertial number at the outlet, about d/D = {:.2g}",
                                       2 * radius / funnel->outlet_diameter));
    const double speed = tool.motion.velocity.norm();
    if (speed == 0) continue;
    // A shear zone of ten grains, loaded by its own weight.
    const double inertial = speed / (10 * std::sqrt(10 * gravity * 2 * radius));
    const std::string found = fmt::format("inertial number of the sheared layer, about {:.2g}", inertial);
    if (inertial > 1)
      findings.warn(place + ".motion", found + ": a gas of grains rather than a dense flow",
                    "check the tool's velocity");
    else
      findings.note(place + ".motion", found);
  }
}

}  // namespace

void check_gravity_and_speeds(const Scene& scene, Findings& findings) {
  const double gravity = scene.gravity.norm();
  if (gravity > absurd_gravity)
    findings.refuse("gravity", fmt::format("{:.4g} m/s2", gravity), "did you mean [0, 0, -9.81]? gravity is in m/s2");
  else if (scene.gravity.z() > 0)
    findings.warn("gravity", "points upward: z is up", fmt::format("did you mean [0, 0, {:.4g}]?", -scene.gravity.z()));
  else if (gravity > 30)
    findings.warn("gravity", fmt::format("{:.4g} m/s2, more than on any solid planet", gravity), "check it");

  for (const GrainPopulation& g : scene.grains)
    check_speed("grains." + g.name + ".velocity", g.velocity.norm(), findings);
  for (const Tool& tool : scene.tools)
    check_speed("tools." + tool.name + ".motion.velocity", tool.motion.velocity.norm(), findings);
  for (const SceneBody& body : scene.bodies) {
    const double speed = body.motion ? body.motion->velocity.norm() : body.velocity.norm();
    check_speed("bodies." + body.name + ".velocity", speed, findings);
    const Shape& shape = scene.shapes.at(body.shape);
    if (shape.bounded())
      check_speed("bodies." + body.name + ".angular_velocity", body.angular_velocity.norm() * shape.bounding_radius,
                  findings);
  }
}

void check_step(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  const double step = scene.solver.time_step, steps = scene.duration / step;
  const std::string place = "solver.time_step";
  if (step > scene.duration) {
    findings.refuse(place,
                    fmt::format("a step of {:.4g} s is longer than the duration of {:.4g} s", step, scene.duration),
                    fmt::format("did you mean {:.3g}?", scene.duration / 1000));
    return;
  }
  if (steps > too_many_steps)
    findings.refuse(place, fmt::format("{:.3g} steps", steps), "lengthen the step or shorten the duration");
  else if (steps > many_steps)
    findings.warn(place, fmt::format("{:.3g} steps", steps), "a step of about 0.03 sqrt(R/g) is usually enough");

  const Smallest smallest = smallest_radius(scene, grains);
  if (std::isfinite(smallest.radius) && smallest.radius > 0 && contacts_possible(scene)) {
    const double gravity = scene.gravity.norm();
    if (gravity > 0) {
      const double fall_time = std::sqrt(smallest.radius / gravity);
      const std::string found = fmt::format("a step of {:.3g} s against sqrt(R/g) = {:.3g} s of {} (R = {})", step,
                                            fall_time, smallest.place, length_text(smallest.radius));
      const std::string remedy = fmt::format("set it to {:.1g} s or below", 0.05 * fall_time);
      if (step > absurd_step * fall_time)
        findings.refuse(place, found, remedy);
      else if (step > coarse_step * fall_time)
        findings.warn(place, found, remedy);
    }
    const double speed = std::max(highest_start_speed(scene), std::sqrt(2 * gravity * fall_height(scene)));
    if (speed * step > smallest.radius)
      findings.warn(place,
                    fmt::format("at {:.3g} m/s {} moves {:.3g} of its radii in one step", speed, smallest.place,
                                speed * step / smallest.radius),
                    fmt::format("set it to {:.1g} s or below", 0.5 * smallest.radius / speed));
    if (!grains.empty()) check_inertial_number(scene, smallest.radius, findings);
  }

  if (scene.frame_interval > scene.duration)
    findings.warn("frame_interval", "longer than the duration: only the first and last frames are kept", "shorten it");
  if (scene.frame_interval < step * (1 - 1e-9))
    findings.warn("frame_interval", "shorter than the step: one frame per step", "lengthen it");
  double bytes = 0;
  for (const PopulationFigures& g : grains) bytes += g.count * bytes_per_grain_and_frame;
  bytes *= scene.duration / std::max(scene.frame_interval, step);
  if (bytes > 20e9)
    findings.warn("frame_interval", fmt::format("the recording takes about {:.0f} GB", bytes / 1e9), "lengthen it");
}

void check_cost(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  double count = 0;
  for (const PopulationFigures& g : grains) count += g.count;
  if (count < 100) return;
  const double steps = scene.duration / scene.solver.time_step;
  const double seconds = steps * count * contacts_per_grain * usual_iterations * seconds_per_contact;
  const std::string found = fmt::format("{:.3g} steps, about {} on one thread if every step takes {:.0f} iterations",
                                        steps, duration_text(seconds), usual_iterations);
  if (seconds > 7 * 86400)
    findings.warn("duration", found, "simulate fewer grains, or a shorter time");
  else
    findings.note("duration", found);
}

void check_air(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings) {
  const bool has_drag = std::any_of(scene.effects.begin(), scene.effects.end(), [](const Effect& effect) {
    return std::holds_alternative<LinearDrag>(effect) || std::holds_alternative<QuadraticDrag>(effect) ||
           std::holds_alternative<FiniteReynoldsDrag>(effect);
  });
  if (has_drag) return;
  const double gravity = scene.gravity.norm(), speed = std::sqrt(2 * gravity * fall_height(scene));
  for (const PopulationFigures& g : grains) {
    const double density = scene.materials.at(g.population->material).density;
    const double terminal = density * gravity * g.typical * g.typical / (18 * air_viscosity);
    if (speed > terminal && terminal > 0)
      findings.note("effects", fmt::format("without air, {} fall at up to {:.2g} m/s; in air at {:.2g} m/s at most",
                                           "grains." + g.population->name, speed, terminal));
  }
}

}  // namespace repose
