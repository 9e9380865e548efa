#pragma once
/// Builds small models for tests, body by body: the k-th body added has index k.
///
///   Model model = ModelBuilder()
///                     .material("grain", 1000)
///                     .law("grain", "grain", {.friction = 0.5})
///                     .floor("grain")
///                     .sphere("grain", 0.5, {.position = {0, 0, 0.5}, .velocity = {1, 0, 0}})
///                     .build();
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/model.hpp"

namespace repose::test {

/// Where a body is and how it moves at time 0: of the shape's own frame, as a user would write it in a scene.
struct Start {
  Vec3 position = Vec3::Zero();          ///< [m]
  Vec3 velocity = Vec3::Zero();          ///< of the shape's own origin [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< [rad/s], world frame
  Quat orientation = Quat::Identity();
};

class ModelBuilder {
 public:
  /// Materials must be declared before they are used. Pairs without a law get PairLaw{}: hard and frictionless.
  ModelBuilder& material(const std::string& name, double density = 1000);
  ModelBuilder& law(const std::string& a, const std::string& b, const PairLaw& law);
  ModelBuilder& gravity(const Vec3& gravity);
  ModelBuilder& effect(const Effect& effect);
  /// Periodic along an axis (0: x, 1: y); bodies that move are taken into the cell.
  ModelBuilder& periodic(int axis, double lower, double upper);

  /// A fixed half-space through `point` whose solid lies opposite to `normal` (made unit).
  ModelBuilder& floor(const std::string& material, const Vec3& normal = Vec3::UnitZ(),
                      const Vec3& point = Vec3::Zero());
  /// Bodies that move freely; mass and inertia from the material's density unless mass() or inertia() follows.
  ModelBuilder& sphere(const std::string& material, double radius, const Start& start = {});
  ModelBuilder& box(const std::string& material, const Vec3& half_extents, const Start& start = {});
  ModelBuilder& body(const std::string& material, const Shape& shape, const Start& start = {}, double scale = 1);
  /// A fixed body, or one of prescribed motion.
  ModelBuilder& wall(const std::string& material, const Shape& shape, const Pose& pose = {}, const Motion& motion = {});

  // What follows changes the body added last.
  ModelBuilder& named(const std::string& name);
  ModelBuilder& mass(double mass);                ///< [kg]; the inertia changes in proportion
  ModelBuilder& inertia(const Vec3& moments);     ///< [kg m^2], about the axes of the shape's own frame
  ModelBuilder& as_grain();                       ///< only after every body that is not a grain
  ModelBuilder& active(const std::vector<Interval>& times, double gate_tolerance);

  std::size_t size() const { return model_.bodies.size(); }
  /// The model, validated.
  Model build() const;

 private:
  int material_index(const std::string& name) const;
  int add_shape(const Shape& shape);
  void add(const Body& body, const Pose& pose, const Twist& twist);

  Model model_;
  std::map<std::pair<int, int>, PairLaw> laws_;
  std::vector<Start> starts_;  ///< as given, of each body
};

/// A shape of one primitive, described in the primitive's own frame.
Shape shape_of(const std::string& kind, const Primitive& primitive);

/// The quaternion that turns by `angle` [rad] about `axis`.
Quat turn(double angle, const Vec3& axis);

}  // namespace repose::test
