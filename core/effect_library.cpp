#include "core/effect_library.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/scene.hpp"
#include "core/setup_effects.hpp"

namespace repose {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double standard_gravity = 9.81;    // [m/s^2]
constexpr double air_density = 1.2;          // [kg/m^3]

struct Range {
  double lower, nominal, upper;
};

EffectParameter parameter(const std::string& name, const Dimension& dimension, const Range& range) {
  EffectParameter p;
  p.name = name;
  p.unit = unit_of(dimension);
  p.dimension = dimension;
  p.lower = range.lower;
  p.nominal = range.nominal;
  p.upper = range.upper;
  return p;
}
EffectParameter in_degrees(const std::string& name, const Range& range) {
  EffectParameter p = parameter(name, dimension::none, range);
  p.unit = "deg";
  return p;
}
/// In the unit of the observable: the bounds count the largest value that it could have.
EffectParameter of_the_observable(const std::string& name) {
  EffectParameter p = parameter(name, dimension::none, {-1, 0, 1});
  p.unit = "observable";
  return p;
}
EffectParameter logarithmic(EffectParameter p) {
  p.log_scaled = true;
  return p;
}
EffectParameter natural(EffectParameter p) {
  p.natural = true;
  return p;
}
EffectParameter held(EffectParameter p) {
  p.held = true;
  return p;
}
EffectParameter vector3(EffectParameter p) {
  p.components = 3;
  return p;
}

/// A row of the `effects` block of a scene: its keys are effects.<name>.<parameter>.
EffectRow in_effects(const std::string& name, EffectSite site, const std::string& claim, const std::string& moves,
                     std::vector<EffectParameter> parameters) {
  EffectRow row{name, site, claim, moves, std::move(parameters), {}};
  for (EffectParameter& p : row.parameters) {
    p.key = "effects." + name + "." + p.name;
    row.keys.push_back(p.key);
  }
  return row;
}

/// The row of a law that has a plainer one for its limit.
EffectRow becoming(const std::string& limit, EffectRow row) {
  row.limit = limit;
  return row;
}

/// One key of the law of a pair.
EffectRow in_pairs(const std::string& name, const std::string& key, const std::string& claim, const std::string& moves,
                   EffectParameter p) {
  p.name = key;
  p.key = "pairs.*." + key;
  return {name, EffectSite::contact, claim, moves, {p}, {p.key}};
}

EffectRow without_keys(const std::string& name, const std::string& claim, const std::string& moves,
                       std::vector<EffectParameter> parameters) {
  return {name, EffectSite::measurement, claim, moves, std::move(parameters), {}};
}

EffectRow of_numerics(const std::string& name, const std::string& claim, const std::string& key) {
  return {name, EffectSite::numerics, claim, "the mismatch goes away with it", {}, {key}};
}

EffectParameter fluid_density() {
  return held(parameter("fluid_density", dimension::density, {0.1, air_density, 2000}));
}
EffectParameter viscosity() { return logarithmic(parameter("viscosity", dimension::viscosity, {1e-7, 0, 100})); }
EffectParameter frequency() {
  return natural(logarithmic(parameter("frequency", dimension::frequency, {1e-3, 0.05, 10})));
}
EffectParameter phase() { return parameter("phase", dimension::angle, {-std::numbers::pi, 0, std::numbers::pi}); }
EffectParameter reference_speed(const std::string& constant) {
  EffectParameter p = natural(held(logarithmic(parameter("reference_speed", dimension::velocity, {1e-3, 1, 1e3}))));
  p.held_beside = constant;
  return p;
}
EffectParameter coefficient(double upper) { return parameter("", dimension::none, {0, 0, upper}); }
EffectParameter factor(const std::string& name, double lower, double upper) {
  return logarithmic(parameter(name, dimension::none, {lower, 1, upper}));
}

std::vector<EffectRow> on_bodies() {
  const EffectSite body = EffectSite::body;
  return {
      in_effects("linear_drag", body, "A still fluid resists in proportion to speed and spin (Stokes).",
                 "speed, terminal speed, decay of spin", {viscosity()}),
      in_effects("quadratic_drag", body, "A still fluid resists with the square of speed.",
                 "fast flight, range, terminal speed",
                 {logarithmic(parameter("coefficient", dimension::none, {1e-3, 0, 1e3})), fluid_density()}),
      becoming("linear_drag", in_effects("finite_reynolds_drag", body,
                                         "A still fluid resists by Stokes' law with the correction for finite Reynolds numbers.",
                                         "speed, terminal speed, decay of spin", {viscosity(), fluid_density()})),
      in_effects("magnus", body, "A spinning body in a fluid is pushed across its path.",
                 "curved flight in proportion to spin and speed",
                 {parameter("lift", dimension::none, {-10, 0, 10}), fluid_density()}),
      in_effects("uniform_force", body, "A constant force acts on every body, whatever its size.",
                 "constant acceleration, larger for light bodies",
                 {natural(vector3(parameter("force", dimension::force, {-2, 0, 2})))}),
      in_effects("gravity_tilt", body, "The plumb line is not the z axis.", "constant sideways acceleration, drift",
                 {in_degrees("x_deg", {-30, 0, 30}), in_degrees("y_deg", {-30, 0, 30})}),
      in_effects("buoyancy", body, "The fluid around a body carries part of its weight.",
                 "a smaller fall, larger for light materials",
                 {logarithmic(parameter("fluid_density", dimension::density, {1e-2, 0, 2e4}))}),
      in_effects("periodic_force", body, "The whole scene is shaken: every body feels a periodic acceleration.",
                 "an oscillation at one frequency, the same for all bodies",
                 {natural(vector3(parameter("amplitude", dimension::acceleration, {-2, 0, 2}))), frequency(), phase()}),
  };
}

std::vector<EffectRow> at_contacts() {
  const EffectSite contact = EffectSite::contact;
  return {
      in_pairs("friction", "friction", "Surfaces resist sliding in proportion to the normal force (Coulomb).",
               "sliding distance, spin gained in impacts, angle of repose", coefficient(1.5)),
      in_pairs("rolling_friction", "rolling_friction", "Surfaces resist rolling in proportion to the normal force.",
               "slowing of rolling, rest on inclines, angle of repose", coefficient(0.5)),
      in_pairs("spinning_friction", "spinning_friction",
               "Surfaces resist spin about the normal in proportion to the normal force.", "decay of spin at rest",
               coefficient(0.5)),
      in_pairs("restitution", "restitution", "Impacts give back part of the normal velocity (Newton).",
               "rebound heights, times between impacts", coefficient(1)),
      in_pairs("cohesion", "cohesion", "Touching surfaces attract with a constant force.",
               "hanging grains, steep heaps, jerky flow",
               natural(logarithmic(parameter("", dimension::force, {1e-2, 0, 1e3})))),
      in_pairs("wall_friction", "friction", "Walls and tools resist sliding otherwise than grains among themselves.",
               "slip along walls, load on the base, roller force", coefficient(1.5)),
      in_effects("rate_dependent_friction", contact, "Friction depends on the speed of sliding, by its logarithm.",
                 "deceleration that changes with slip speed",
                 {parameter("slope", dimension::none, {-0.2, 0, 0.2}), reference_speed("friction")}),
      in_effects("anisotropic_friction", contact, "Friction is not the same along and across a direction.",
                 "sliding that turns aside", {factor("ratio", 0.2, 5), in_degrees("direction_deg", {-90, 0, 90})}),
      in_effects("rate_dependent_restitution", contact, "Fast impacts give back a smaller part than slow ones.",
                 "rebounds that depend on the speed of impact",
                 {parameter("exponent", dimension::none, {-0.5, 0, 0.5}), reference_speed("restitution")}),
      in_effects("liquid_bridge", contact, "Drops of liquid between surfaces pull until they rupture.",
                 "hanging grains, clusters, steep heaps",
                 {natural(logarithmic(parameter("force", dimension::force, {1e-2, 0, 1e3}))),
                  natural(logarithmic(parameter("rupture", dimension::length, {1e-3, 0.05, 0.5})))}),
      in_effects("contact_compliance", contact, "Contacts give way like a spring with a damper.",
                 "sag under load, duration of impacts, rebound",
                 {natural(logarithmic(parameter("stiffness", dimension::stiffness, {10, infinite, 1e7}))),
                  natural(logarithmic(parameter("damping", dimension::damping, {1e-3, 0, 1e4})))}),
      in_effects("thermal_softening", contact, "Cohesion grows with temperature.",
                 "what cohesion shows, hotter or colder",
                 {parameter("temperature", dimension::temperature, {200, softening_reference, 600}),
                  held(parameter("scale", dimension::temperature, {1, 50, 1000}))}),
  };
}

std::vector<EffectRow> of_the_setup() {
  const EffectSite setup = EffectSite::setup;
  return {
      in_effects("base_vibration", setup, "The ground vibrates up and down.", "creep and spread of what rests, jumps",
                 {natural(logarithmic(parameter("amplitude", dimension::length, {1e-4, 0, 1}))), frequency(), phase()}),
      in_effects("moving_wall_speed", setup, "Tools move faster or slower than prescribed.",
                 "arrival times, forces on tools, speed of what they push", {factor("factor", 0.2, 5)}),
      in_effects("grain_shape", setup, "Grains are longer or shorter than supposed.", "angle of repose, packing, flow",
                 {factor("aspect", 0.5, 2)}),
      in_effects("size_distribution", setup, "Grains are larger, smaller or more varied than supposed.",
                 "discharge, packing, roughness", {factor("mean_factor", 0.5, 2), factor("sd_factor", 0.2, 2)}),
      in_effects("inertia", setup, "Bodies are harder or easier to turn than their shape says.",
                 "rolling, spin gained in impacts", {factor("factor", 0.2, 5)}),
      in_effects("center_of_mass_offset", setup, "The centre of mass is not that of the shape.",
                 "wobble, rest positions, tumbling",
                 {natural(vector3(parameter("offset", dimension::length, {-0.5, 0, 0.5})))}),
  };
}

std::vector<EffectRow> of_the_measurement() {
  return {
      without_keys("length_scale", "Recorded lengths are the true ones times a factor.", "every length alike",
                   {factor("factor", 0.8, 1.25)}),
      without_keys("time_scale", "Recorded times are the true ones times a factor.", "every speed alike",
                   {factor("factor", 0.8, 1.25)}),
      without_keys("time_offset", "Recorded times are late by a constant.", "errors in proportion to speed",
                   {natural(parameter("offset", dimension::time, {-10, 0, 10}))}),
      without_keys("frame_tilt", "The axes of the recording are turned against the world's.",
                   "errors in proportion to distance",
                   {in_degrees("x_deg", {-15, 0, 15}), in_degrees("y_deg", {-15, 0, 15})}),
      without_keys("sensor_bias", "A sensor reads too much by a constant.", "a constant error",
                   {of_the_observable("bias")}),
  };
}

std::vector<EffectRow> of_the_numerics() {
  return {of_numerics("time_step", "The step of the simulation is too long.", "solver.time_step"),
          of_numerics("solver_tolerance", "The solver stops too early.", "solver.tolerance"),
          of_numerics("engine_law", "The engine solves another contact law, or is another engine.", "solver.law")};
}

}  // namespace

const std::vector<EffectRow>& effect_library() {
  static const std::vector<EffectRow> library = [] {
    std::vector<EffectRow> rows;
    for (auto* part : {on_bodies, at_contacts, of_the_setup, of_the_measurement, of_the_numerics})
      for (EffectRow& row : part()) rows.push_back(std::move(row));
    return rows;
  }();
  return library;
}

const EffectRow* find_effect(const std::string& name) {
  for (const EffectRow& row : effect_library())
    if (row.name == name) return &row;
  return nullptr;
}

NaturalScale natural_scale(const Model& model) {
  NaturalScale scale;
  double radius = 0, mass = 0;
  int count = 0;
  for (const Body& body : model.bodies) {
    if (!body.dynamic) continue;
    radius += body.radius;
    mass += body.mass;
    ++count;
  }
  if (count > 0) {
    scale.length = radius / count;
    scale.mass = mass / count;
  }
  const double gravity = model.gravity.norm();
  scale.time = std::sqrt(scale.length / (gravity > 0 ? gravity : standard_gravity));
  return scale;
}

EffectBounds bounds_of(const EffectParameter& p, const NaturalScale& scale) {
  double unit = 1;
  if (p.natural)
    unit = std::pow(scale.length, p.dimension.length) * std::pow(scale.mass, p.dimension.mass) *
           std::pow(scale.time, p.dimension.time);
  return {p.lower * unit, p.nominal * unit, p.upper * unit};
}

std::vector<std::string> places_of(const EffectRow& row, const Scene& scene) {
  std::vector<std::string> places;
  if (row.keys.empty() || row.keys.front().find('*') == std::string::npos) return places;
  for (const auto& [names, law] : scene.pairs) {
    const bool holds_wall = is_wall_material(scene, names.first) || is_wall_material(scene, names.second);
    if (row.name != "wall_friction" || holds_wall) places.push_back(names.first + "-" + names.second);
  }
  return places;
}

std::string key_at(const EffectParameter& parameter, const std::string& place) {
  std::string key = parameter.key;
  const std::size_t star = key.find('*');
  if (star != std::string::npos) key.replace(star, 1, place);
  return key;
}

std::vector<std::pair<std::string, std::string>> edits(const EffectRow& row,
                                                       std::span<const std::vector<double>> values,
                                                       const std::string& place) {
  if (values.size() != row.parameters.size())
    throw Error(row.name, fmt::format("{} lists of numbers for {} parameters", values.size(), row.parameters.size()),
                "give one list per parameter");
  std::vector<std::pair<std::string, std::string>> result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const EffectParameter& p = row.parameters[i];
    if (static_cast<int>(values[i].size()) != p.components)
      throw Error(row.name + "." + p.name, fmt::format("{} numbers for {}", values[i].size(), p.components),
                  "give as many numbers as the parameter has components");
    if (p.key.empty()) throw Error(row.name, "is not an effect of the scene", "apply it to the recording");
    const std::string key = key_at(p, place);
    if (place.empty() && key != p.key)
      throw Error(row.name + "." + p.name, "needs the name that stands for `*` in " + p.key, "see places_of()");
    // The shortest text that reads back to the same bits.
    const std::string text = fmt::format("{}", fmt::join(values[i], ", "));
    result.emplace_back(key, p.components == 1 ? text : "[" + text + "]");
  }
  return result;
}

}  // namespace repose
