#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

std::string read_shape_name(const YamlReader& body, const Scene& scene) {
  const YamlReader reader = body.at("shape");
  const std::string name = reader.text();
  if (!scene.shapes.contains(name)) {
    std::vector<std::string> names;
    for (const auto& [known, shape] : scene.shapes) names.push_back(known);
    const Suggestion suggestion = suggest("no such shape:", name, names);
    reader.fail(suggestion.problem, suggestion.remedy);
  }
  return name;
}

void check_inertia(const YamlReader& reader, const Vec3& inertia) {
  const double largest = inertia.maxCoeff();
  if (largest > (inertia.sum() - largest) * (1 + 1e-9))
    reader.fail("no body has these moments: the largest exceeds the sum of the others",
                "give the three principal moments [xx, yy, zz] in kg m^2");
}

SceneBody read_body(const std::string& name, const YamlReader& reader, const Scene& scene) {
  reader.only({"shape", "material", "position", "orientation", "velocity", "angular_velocity", "fixed", "mass",
               "inertia", "motion"});
  SceneBody body;
  body.name = name;
  body.shape = read_shape_name(reader, scene);
  body.material = read_material_name(reader, scene);
  reader.read("position", body.position, any(dimension::length));
  reader.read("orientation", body.orientation);
  reader.read("velocity", body.velocity, any(dimension::velocity));
  reader.read("angular_velocity", body.angular_velocity, any(dimension::angular_velocity));
  reader.read("fixed", body.fixed);
  if (reader.has("mass")) body.mass = reader.at("mass").number(positive(dimension::mass));
  if (reader.has("inertia")) {
    body.inertia = reader.at("inertia").vector(positive(dimension::inertia));
    check_inertia(reader.at("inertia"), *body.inertia);
  }
  if (reader.has("motion")) body.motion = read_motion(reader.at("motion"), body.position);

  if (body.fixed && body.motion)
    reader.at("fixed").fail("a body with a prescribed `motion` cannot be fixed", "remove one of the two keys");
  const bool moves_freely = !body.fixed && !body.motion;
  if (moves_freely && !scene.shapes.at(body.shape).bounded())
    reader.fail(fmt::format("shape `{}` is infinite, so the body cannot move freely", body.shape), "add `fixed: true`");
  if (!moves_freely && (body.mass || body.inertia))
    reader.fail("a fixed or driven body has no mass of its own", "remove `mass` and `inertia`");
  if (!moves_freely && (reader.has("velocity") || reader.has("angular_velocity")) &&
      !(body.velocity.isZero(0) && body.angular_velocity.isZero(0)))
    reader.fail("a fixed or driven body cannot start with a velocity", "prescribe it: `motion: {velocity: [x, y, z]}`");
  return body;
}

}  // namespace

Motion read_motion(const YamlReader& block, const Vec3& pivot) {
  block.only({"velocity", "angular_velocity", "pivot", "start", "stop", "vibration_amplitude", "vibration_frequency",
              "vibration_phase_deg"});
  Motion motion;
  motion.pivot = pivot;
  block.read("velocity", motion.velocity, any(dimension::velocity));
  block.read("angular_velocity", motion.angular_velocity, any(dimension::angular_velocity));
  block.read("pivot", motion.pivot, any(dimension::length));
  block.read("start", motion.start, non_negative(dimension::time));
  block.read("stop", motion.stop, non_negative(dimension::time));
  block.read("vibration_amplitude", motion.vibration_amplitude, any(dimension::length));
  block.read("vibration_frequency", motion.vibration_frequency, non_negative(dimension::frequency));
  double phase = 0;
  block.read("vibration_phase_deg", phase, degrees(-3600, 3600));
  motion.vibration_phase = phase * std::numbers::pi / 180;
  if (motion.stop < motion.start) block.at("stop").fail("lies before `start`", "give a later time");
  if (!motion.vibration_amplitude.isZero(0) && motion.vibration_frequency == 0)
    block.fail("a vibration needs its frequency", "add `vibration_frequency: 50 Hz`");
  return motion;
}

void read_bodies(const YamlReader& block, Scene& scene) {
  for (const auto& [name, reader] : block.named()) scene.bodies.push_back(read_body(name, reader, scene));
  std::sort(scene.bodies.begin(), scene.bodies.end(),
            [](const SceneBody& a, const SceneBody& b) { return a.name < b.name; });
}

}  // namespace repose
