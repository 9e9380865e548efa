#include "analysis/diagnosis/changed_recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "analysis/bundle/scene_keys.hpp"
#include "core/error.hpp"
#include "core/quantity.hpp"
#include "core/scene_yaml.hpp"

namespace repose::diagnosis {
namespace {

using Of = Change::Of;

constexpr std::size_t most_bodies = 3;

std::optional<double> plain_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

/// A number that the experimenter set, for one run or another; start values, masses and sizes are changed by their kind.
bool is_setting(const Override& set) {
  for (const char* other : {"solver.", "effects.", "duration", "frame", "record", "shapes."})
    if (set.path.starts_with(other)) return false;
  for (const char* start : {".position", ".orientation", ".velocity", ".angular_velocity", ".mass", ".inertia"})
    if (set.path.find(start) != std::string::npos) return false;
  return plain_number(set.value).value_or(0) != 0;
}

bool moves_freely(const SceneBody& body) { return !body.fixed && !body.motion; }

bool turned_by(const Fit& fit, const std::string& key) {
  return std::any_of(fit.layout.shared.begin(), fit.layout.shared.end(), [&](const Parameter& p) { return overlap(p.key, key); });
}

/// The lengths of a shape that make its size, by their keys; none where it has others or none.
std::vector<std::pair<std::string, std::vector<double>>> lengths_of(const YamlNode& tree, const std::string& shape) {
  const YamlNode* node = node_at(tree, "shapes." + shape);
  std::vector<std::pair<std::string, std::vector<double>>> lengths;
  if (node == nullptr || node->kind != YamlNode::Kind::map) return {};
  for (const YamlEntry& entry : node->entries) {
    if (entry.key == "type" || entry.key == "aspect") continue;
    std::vector<double> numbers;
    try {
      if (entry.value.kind == YamlNode::Kind::scalar) numbers = {parse_quantity(entry.value.text, dimension::length)};
      for (const YamlNode& item : entry.value.items) numbers.push_back(parse_quantity(item.text, dimension::length));
    } catch (const Error&) {
      return {};  // a mesh's file, a compound's parts
    }
    lengths.emplace_back("shapes." + shape + "." + entry.key, numbers);
  }
  return lengths;
}

/// Can the shape be made larger? Not one that something fixed has too, nor where bodies lie on anything but half-spaces.
bool can_grow(const Scene& scene, const std::string& shape) {
  int movers = 0;
  for (const SceneBody& body : scene.bodies) {
    movers += moves_freely(body) ? 1 : 0;
    if (moves_freely(body)) continue;
    if (body.shape == shape || scene.shapes.at(body.shape).bounded()) return false;
  }
  return movers == 1 && scene.tools.empty() && scene.grains.empty() && scene.shapes.at(shape).bounded();
}

struct Setter {
  SetValues values;
  void set(const std::string& key, int component, double value) {
    Parameter p;
    p.key = key;
    p.component = component;
    p.lower = p.upper = value;
    values.parameters.push_back(p);
    values.values.push_back(value);
  }
  void set(const std::string& key, const Vec3& value) {
    for (int k = 0; k < 3; ++k) set(key, k, value[k]);
  }
};

struct Start {
  Vec3 value;
  bool free = false;
};

/// A start vector of the body as the run began: estimated where it is free.
Start start_of_body(const std::vector<Parameter>& free, const Values& own, const std::string& key, const Vec3& told) {
  Start start{told};
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i].use != Parameter::Use::scene || free[i].key != key || free[i].component < 0) continue;
    start.value[free[i].component] = own[static_cast<Eigen::Index>(i)];
    start.free = true;
  }
  return start;
}

/// A body with `factor` times the mass and `inertia` times the moments.
void change_mass(const Scene& scene, const SceneBody& body, double factor, double inertia, Setter& to) {
  const double mass = body.mass ? *body.mass : scene.materials.at(body.material).density * scene.shapes.at(body.shape).mass.volume;
  to.set("bodies." + body.name + ".mass", -1, factor * mass);
  if (body.inertia) to.set("bodies." + body.name + ".inertia", inertia * *body.inertia);
}

/// How far up the body must begin to lie `factor` times as far above what it touches.
Vec3 raised(const Scene& scene, const SceneBody& body, const Vec3& position, double factor) {
  Vec3 shift = Vec3::Zero();
  for (const SceneBody& floor : scene.bodies) {
    if (moves_freely(floor)) continue;
    for (const Part& part : scene.shapes.at(floor.shape).parts) {
      const auto* plane = std::get_if<HalfSpace>(&part.primitive);
      if (plane == nullptr) continue;
      const Vec3 normal = floor.orientation * (part.pose.orientation * plane->normal);
      const double distance = normal.dot(position - floor.position - floor.orientation * part.pose.position);
      if (distance > 0 && distance < 1.05 * scene.shapes.at(body.shape).bounding_radius) shift += (factor - 1) * distance * normal;
    }
  }
  return shift;
}

void change_start(const Scene& scene, const std::vector<Parameter>& free, const Values& own, const Change& change, Setter& to) {
  const bool height = change.of == Of::height;
  for (const SceneBody& body : scene.bodies) {
    if (!moves_freely(body)) continue;
    const std::string key = "bodies." + body.name + (change.of == Of::speed ? ".velocity" : change.of == Of::spin ? ".angular_velocity" : ".position");
    const Start start = start_of_body(free, own, key, change.of == Of::speed ? body.velocity : change.of == Of::spin ? body.angular_velocity : body.position);
    if (height ? !(start.value.z() > 0) || (!start.free && change.factor < 1) : start.value.isZero(0)) continue;
    for (int k = height ? 2 : 0; k < 3; ++k) to.set(key, k, change.factor * start.value[k]);
  }
}

void change_size(const Scene& scene, const YamlNode& tree, const std::vector<Parameter>& free, const Values& own, const Change& change, Setter& to) {
  for (const auto& [key, lengths] : lengths_of(tree, change.name))
    for (std::size_t k = 0; k < lengths.size(); ++k) to.set(key, lengths.size() == 1 ? -1 : static_cast<int>(k), change.factor * lengths[k]);
  for (const SceneBody& body : scene.bodies) {
    if (body.shape != change.name || !moves_freely(body)) continue;
    if (body.mass || body.inertia) change_mass(scene, body, std::pow(change.factor, 3), std::pow(change.factor, 5), to);
    const std::string key = "bodies." + body.name;
    const Vec3 position = start_of_body(free, own, key + ".position", body.position).value;
    if (const Vec3 shift = raised(scene, body, position, change.factor); !shift.isZero(0)) to.set(key + ".position", position + shift);
    const Vec3 spin = start_of_body(free, own, key + ".angular_velocity", body.angular_velocity).value;
    if (!spin.isZero(0)) to.set(key + ".angular_velocity", spin / change.factor);
  }
}

}  // namespace

std::string Change::words() const {
  switch (of) {
    case Of::nothing: return "the same start, recorded again";
    case Of::speed: return fmt::format("start at {} times the speed", factor);
    case Of::spin: return fmt::format("start with {} times the spin", factor);
    case Of::height: return fmt::format("start from {} times the height", factor);
    case Of::mass: return fmt::format("give the {} {} times the mass at the same size", name, factor);
    case Of::size: return fmt::format("give the {} {} times the size in the same material", name, factor);
    case Of::setting: return fmt::format("set {} to {} times its value", name, factor);
  }
  return "";
}

std::vector<Change> changes_of(const Problem& problem, const Fit& fit) {
  std::vector<Change> all{{Of::nothing}};
  std::set<std::string> settings, shapes;
  for (const RunData& run : problem.runs())
    for (const Override& set : run.run->set)
      if (is_setting(set)) settings.insert(set.path);
  const Scene& scene = problem.bundle().scene;
  const YamlNode tree = parse_yaml(scene.text, "scene");
  std::vector<std::string> bodies;
  for (const SceneBody& body : scene.bodies) {
    if (!moves_freely(body) || bodies.size() == most_bodies) continue;
    const std::string key = "bodies." + body.name;
    const bool turned = turned_by(fit, key + ".mass") || turned_by(fit, key + ".inertia") || turned_by(fit, "materials." + body.material + ".density");
    if (!turned) bodies.push_back(body.name);
    if (!turned && !turned_by(fit, "shapes." + body.shape) && can_grow(scene, body.shape) && !lengths_of(tree, body.shape).empty()) shapes.insert(body.shape);
  }
  for (const double factor : {0.5, 2.0, 4.0}) {
    for (const Of of : {Of::speed, Of::spin, Of::height}) all.push_back({of, factor});
    for (const std::string& key : settings) all.push_back({Of::setting, factor, key});
    if (factor <= 2)
      for (const std::string& shape : shapes) all.push_back({Of::size, factor, shape});
  }
  for (const double factor : {0.25, 0.5, 2.0, 4.0})
    for (const std::string& body : bodies) all.push_back({Of::mass, factor, body});
  return all;
}

SetValues changed(const Problem& problem, const Layout& layout, const Values& own, std::size_t run, const Change& change) {
  Setter to;
  const RunData& data = problem.runs()[run];
  if (change.of == Of::nothing) return {};
  if (change.of == Of::setting) {
    for (const Override& set : data.run->set)
      if (set.path == change.name)
        if (const auto value = plain_number(set.value)) to.set(set.path, -1, change.factor * *value);
    return to.values;
  }
  const Scene scene = read_scene(data.tree, problem.bundle().scene_file.string(), problem.bundle().scene_file.parent_path());
  const std::vector<Parameter>& free = layout.per_run[run];
  if (change.of == Of::size) {
    change_size(scene, data.tree, free, own, change, to);
  } else if (change.of == Of::mass) {
    for (const SceneBody& body : scene.bodies)
      if (body.name == change.name) change_mass(scene, body, change.factor, change.factor, to);
  } else {
    change_start(scene, free, own, change, to);
  }
  return to.values;
}

Fit with(Fit fit, std::size_t run, const SetValues& set) {
  std::vector<Parameter>& parameters = fit.layout.per_run[run];
  Values& own = fit.own[run];
  for (std::size_t i = 0; i < set.parameters.size(); ++i) {
    const Parameter& p = set.parameters[i];
    std::size_t at = 0;
    while (at < parameters.size() && !(parameters[at].use == p.use && parameters[at].key == p.key && parameters[at].component == p.component)) ++at;
    if (at == parameters.size()) {
      parameters.push_back(p);
      own.conservativeResize(own.size() + 1);
    }
    own[static_cast<Eigen::Index>(at)] = set.values[i];
  }
  return fit;
}

}  // namespace repose::diagnosis
