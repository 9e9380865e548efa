#include "tests/support/model_builder.hpp"

#include <algorithm>
#include <stdexcept>

#include "core/body_frame.hpp"

namespace repose::test {

Shape shape_of(const std::string& kind, const Primitive& primitive) {
  return make_shape(kind, {Part{primitive, Pose{}}});
}

Quat turn(double angle, const Vec3& axis) { return Quat(Eigen::AngleAxisd(angle, axis.normalized())); }

ModelBuilder& ModelBuilder::material(const std::string& name, double density) {
  model_.materials.push_back({name, density});
  return *this;
}

ModelBuilder& ModelBuilder::law(const std::string& a, const std::string& b, const PairLaw& law) {
  laws_[std::minmax({material_index(a), material_index(b)})] = law;
  return *this;
}

ModelBuilder& ModelBuilder::gravity(const Vec3& gravity) {
  model_.gravity = gravity;
  return *this;
}

ModelBuilder& ModelBuilder::effect(const Effect& effect) {
  model_.effects.push_back(effect);
  return *this;
}

ModelBuilder& ModelBuilder::periodic(int axis, double lower, double upper) {
  model_.periodic.lower[axis] = lower;
  model_.periodic.upper[axis] = upper;
  return *this;
}

ModelBuilder& ModelBuilder::floor(const std::string& material, const Vec3& normal, const Vec3& point) {
  return wall(material, shape_of("half_space", HalfSpace{normal.normalized()}), {point, Quat::Identity()});
}

ModelBuilder& ModelBuilder::sphere(const std::string& material, double radius, const Start& start) {
  return body(material, shape_of("sphere", Sphere{radius}), start);
}

ModelBuilder& ModelBuilder::box(const std::string& material, const Vec3& half_extents, const Start& start) {
  return body(material, shape_of("box", Box{half_extents}), start);
}

ModelBuilder& ModelBuilder::body(const std::string& material, const Shape& shape, const Start& start, double scale) {
  const int index = material_index(material);
  const double density = model_.materials[static_cast<std::size_t>(index)].density;
  const Pose own{start.position, start.orientation.normalized()};
  add(dynamic_body(shape, add_shape(shape), scale, density, index), body_pose(shape, scale, own),
      body_twist(shape, scale, own, {start.velocity, start.angular_velocity}));
  starts_.back() = start;
  return *this;
}

ModelBuilder& ModelBuilder::wall(const std::string& material, const Shape& shape, const Pose& pose,
                                 const Motion& motion) {
  add(prescribed_body(add_shape(shape), material_index(material), motion), body_pose(shape, 1, pose), {});
  return *this;
}

ModelBuilder& ModelBuilder::named(const std::string& name) {
  const auto known = std::find(model_.names.begin(), model_.names.end(), name);  // of a population: that of all its grains
  model_.bodies.back().name = static_cast<int>(known - model_.names.begin());
  if (known == model_.names.end()) model_.names.push_back(name);
  return *this;
}

ModelBuilder& ModelBuilder::mass(double mass) {
  Body& last = model_.bodies.back();
  last.inertia *= mass / last.mass;
  last.mass = mass;
  return *this;
}

ModelBuilder& ModelBuilder::inertia(const Vec3& moments) {
  Body& last = model_.bodies.back();
  Shape& shape = model_.shapes[static_cast<std::size_t>(last.shape)];
  shape = aligned_with_own_frame(shape);
  last.inertia = moments;
  const Start& start = starts_.back();
  const Pose pose = body_pose(shape, last.scale, {start.position, start.orientation.normalized()});
  model_.initial.position.back() = pose.position;
  model_.initial.orientation.back() = pose.orientation;
  return *this;
}

ModelBuilder& ModelBuilder::as_grain() {
  model_.bodies.back().role = BodyRole::grain;
  return *this;
}

ModelBuilder& ModelBuilder::active(const std::vector<Interval>& times, double gate_tolerance) {
  model_.bodies.back().active = times;
  model_.bodies.back().gate_tolerance = gate_tolerance;
  return *this;
}

Model ModelBuilder::build() const {
  Model model = model_;
  const std::size_t n = model.materials.size();
  model.laws.assign(n * n, PairLaw{});
  for (const auto& [pair, law] : laws_) {
    const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
    model.laws[a * n + b] = model.laws[b * n + a] = law;
  }
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].dynamic) model.initial.position[i] = model.periodic.wrapped(model.initial.position[i]);
  validate(model);
  return model;
}

int ModelBuilder::material_index(const std::string& name) const {
  for (std::size_t i = 0; i < model_.materials.size(); ++i)
    if (model_.materials[i].name == name) return static_cast<int>(i);
  throw std::invalid_argument("the material " + name + " was not declared");
}

int ModelBuilder::add_shape(const Shape& shape) {
  model_.shapes.push_back(shape);
  return static_cast<int>(model_.shapes.size()) - 1;
}

void ModelBuilder::add(const Body& body, const Pose& pose, const Twist& twist) {
  model_.bodies.push_back(body);
  model_.initial.position.push_back(pose.position);
  model_.initial.orientation.push_back(pose.orientation);
  model_.initial.velocity.push_back(twist.linear);
  model_.initial.angular_velocity.push_back(twist.angular);
  starts_.push_back({pose.position, twist.linear, twist.angular, pose.orientation});
}

}  // namespace repose::test
