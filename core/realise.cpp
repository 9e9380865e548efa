#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/body_frame.hpp"
#include "core/error.hpp"
#include "core/grain_set.hpp"
#include "core/scene.hpp"

namespace repose {
namespace {

/// A shutter lets pass what overlaps it by more than this share of a grain's size.
constexpr double gate_share = 0.01;

/// Fills a Model from a Scene, in the order of Model::bodies.
class Realiser {
 public:
  explicit Realiser(const Scene& scene) : scene_(scene) {
    for (const auto& [name, material] : scene.materials) {
      if (!(material.density > 0) || !std::isfinite(material.density))
        throw Error("materials." + name + ".density", "the density must be positive and finite", "give it in kg/m^3");
      material_index_[name] = static_cast<int>(model_.materials.size());
      model_.materials.push_back({name, material.density});
    }
    model_.gravity = scene.gravity;
    model_.effects = scene.effects;
    model_.contact_effects = scene.contact_effects;
    model_.periodic = scene.periodic;
  }

  Model make(std::uint64_t seed) {
    const GrainSet set = make_grains(scene_, seed);
    for (const SceneBody& body : scene_.bodies) add(body);
    for (const Tool& tool : scene_.tools) add(tool);
    add(set);
    set_gate_tolerances(set.mean_size);
    set_laws();
    validate(model_);
    return std::move(model_);
  }

 private:
  void add(const SceneBody& body);
  void add(const Tool& tool);
  void add(const GrainSet& set);
  void set_gate_tolerances(double mean_grain_size);
  void set_laws();
  void change_inertia(const Shape& shape, Body& body, const std::string& place) const;

  int material(const std::string& name, const std::string& place) const {
    const auto found = material_index_.find(name);
    if (found == material_index_.end())
      throw Error(place + ".material", "there is no material " + name, "add it to materials, or name one of those");
    return found->second;
  }
  double density(int index) const { return model_.materials[static_cast<std::size_t>(index)].density; }
  int add_name(const std::string& name) {
    model_.names.push_back(name);
    return static_cast<int>(model_.names.size()) - 1;
  }
  int add_shape(const Shape& shape) {
    model_.shapes.push_back(shape);
    return static_cast<int>(model_.shapes.size()) - 1;
  }
  void add_body(const Body& body, const Pose& pose, const Twist& twist) {
    model_.bodies.push_back(body);
    model_.initial.position.push_back(body.dynamic ? scene_.periodic.wrapped(pose.position) : pose.position);
    model_.initial.orientation.push_back(pose.orientation);
    model_.initial.velocity.push_back(twist.linear);
    model_.initial.angular_velocity.push_back(twist.angular);
  }

  const Scene& scene_;
  Model model_;
  std::map<std::string, int> material_index_;
  std::map<std::string, int> shape_index_;  ///< of Scene::shapes already used as they are
};

/// No mass distribution has a moment larger than the sum of the other two.
void check_inertia(const Vec3& moments, const std::string& place) {
  const bool positive = moments.allFinite() && moments.minCoeff() > 0;
  if (!positive || 2 * moments.maxCoeff() > moments.sum() * (1 + 1e-6))
    throw Error(place + ".inertia", "no body has these moments of inertia",
                "give three positive moments, none larger than the sum of the other two");
}

void Realiser::change_inertia(const Shape& shape, Body& body, const std::string& place) const {
  const Vec3& factor = scene_.inertia_factor;
  if (factor == Vec3::Ones()) return;
  body.inertia = scaled_inertia(shape, body.inertia, factor);
  // Equal factors keep the proportions, and a factor of all is the user's own claim.
  if (factor.x() != factor.y() || factor.y() != factor.z()) check_inertia(body.inertia, "effects.inertia for " + place);
}

void Realiser::add(const SceneBody& body) {
  const std::string place = "bodies." + body.name;
  const auto entry = scene_.shapes.find(body.shape);
  if (entry == scene_.shapes.end())
    throw Error(place + ".shape", "there is no shape " + body.shape, "add it to shapes, or name one of those");
  Shape shape = entry->second;
  const bool dynamic = !body.fixed && !body.motion;
  int index = 0;
  const bool off_centre = dynamic && !scene_.center_of_mass_offset.isZero(0);
  if (dynamic && body.inertia) {
    check_inertia(*body.inertia, place);
    shape = aligned_with_own_frame(shape);
  }
  if (off_centre) shape = with_centre_offset(shape, scene_.center_of_mass_offset);
  if (off_centre || (dynamic && body.inertia)) {
    index = add_shape(shape);
  } else {
    const auto [known, is_new] = shape_index_.try_emplace(body.shape, static_cast<int>(model_.shapes.size()));
    if (is_new) add_shape(shape);
    index = known->second;
  }

  const int material_index = material(body.material, place);
  const Pose own{body.position, body.orientation.normalized()};
  const Pose pose = body_pose(shape, 1, own);
  if (!dynamic) {
    Body fixed = prescribed_body(index, material_index, body.motion.value_or(Motion{}));
    fixed.name = add_name(body.name);
    add_body(fixed, pose, {});
    return;
  }
  if (!(shape.mass.volume > 0) || !shape.bounded())
    throw Error(place + ".fixed", "a " + shape.kind + " has no finite mass and cannot move freely",
                "write fixed: true or give it a motion");
  Body free = dynamic_body(shape, index, 1, density(material_index), material_index);
  if (body.mass) {
    if (!(*body.mass > 0) || !std::isfinite(*body.mass))
      throw Error(place + ".mass", "the mass must be positive", "give a mass in kg, or leave it out");
    free.inertia *= *body.mass / free.mass;
    free.mass = *body.mass;
  }
  if (body.inertia) free.inertia = *body.inertia;
  change_inertia(shape, free, place);
  free.name = add_name(body.name);
  add_body(free, pose, body_twist(shape, 1, own, {body.velocity, body.angular_velocity}));
}

void Realiser::add(const Tool& tool) {
  const int material_index = material(tool.material, "tools." + tool.name);
  const int name = add_name(tool.name);
  for (const ToolBody& piece : build_tool(tool)) {
    Body body = prescribed_body(add_shape(piece.shape), material_index, tool.motion);
    body.role = BodyRole::tool;
    body.name = name;
    body.active = piece.active;
    body.yield = tool.yield;
    add_body(body, piece.pose, {});
  }
}

void Realiser::add(const GrainSet& set) {
  // Hundreds of thousands: room for exactly these.
  const std::size_t all = model_.bodies.size() + set.grains.size();
  model_.bodies.reserve(all);
  model_.initial.position.reserve(all);
  model_.initial.orientation.reserve(all);
  model_.initial.velocity.reserve(all);
  model_.initial.angular_velocity.reserve(all);
  const int first_shape = static_cast<int>(model_.shapes.size());
  model_.shapes.insert(model_.shapes.end(), set.shapes.begin(), set.shapes.end());
  std::vector<int> names, materials;
  for (const GrainPopulation& population : scene_.grains) {
    names.push_back(add_name(population.name));
    materials.push_back(material(population.material, "grains." + population.name));
  }
  for (const PlacedGrain& grain : set.grains) {
    const auto population = static_cast<std::size_t>(grain.population);
    const Shape& shape = set.shapes[static_cast<std::size_t>(grain.shape)];
    const int index = materials[population];
    Body body = dynamic_body(shape, first_shape + grain.shape, grain.size, density(index), index);
    body.radius = 0.5 * grain.size;
    body.role = BodyRole::grain;
    body.name = names[population];
    change_inertia(shape, body, "grains." + scene_.grains[population].name);
    Vec3 centre = grain.placement.position;
    if (!scene_.center_of_mass_offset.isZero(0)) {
      const Vec3 offset = scene_.center_of_mass_offset / grain.size;
      body.shape = add_shape(with_centre_offset(shape, offset));
      centre += grain.placement.orientation * (shape.own_frame.orientation * scene_.center_of_mass_offset);
    }
    add_body(body, {centre, grain.placement.orientation}, {scene_.grains[population].velocity, Vec3::Zero()});
  }
}

void Realiser::set_gate_tolerances(double mean_grain_size) {
  double size = mean_grain_size;
  if (size == 0) {
    size = std::numeric_limits<double>::infinity();
    for (const Body& body : model_.bodies)
      if (body.dynamic)
        for (const Part& part : model_.shapes[static_cast<std::size_t>(body.shape)].parts)
          size = std::min(size, body.scale * smallest_extent(part.primitive));
    if (!std::isfinite(size)) size = 0;
  }
  for (Body& body : model_.bodies)
    if (!body.active.empty()) body.gate_tolerance = gate_share * size;
}

void Realiser::set_laws() {
  const std::size_t n = model_.materials.size();
  std::vector<std::size_t> bodies(n, 0), dynamic(n, 0);
  for (const Body& body : model_.bodies) {
    ++bodies[static_cast<std::size_t>(body.material)];
    if (body.dynamic) ++dynamic[static_cast<std::size_t>(body.material)];
  }
  const auto can_meet = [&](std::size_t a, std::size_t b) {
    if (a == b) return dynamic[a] > 0 && bodies[a] > 1;
    return (dynamic[a] > 0 && bodies[b] > 0) || (dynamic[b] > 0 && bodies[a] > 0);
  };

  model_.laws.assign(n * n, PairLaw{});
  std::string missing;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a; b < n; ++b) {
      const std::string &first = model_.materials[a].name, &second = model_.materials[b].name;
      const auto law = scene_.pairs.find({first, second});
      if (law != scene_.pairs.end())
        model_.laws[a * n + b] = model_.laws[b * n + a] = law->second;
      else if (can_meet(a, b))
        missing += (missing.empty() ? "" : ", ") + first + "-" + second;
    }
  }
  if (!missing.empty())
    throw Error("pairs", "bodies of these materials can meet, but there is no law for: " + missing,
                "add each under pairs, names in alphabetical order, for example {friction: 0.5}");
}

}  // namespace

Model realise(const Scene& scene, std::uint64_t seed) { return Realiser(scene).make(seed); }

}  // namespace repose
