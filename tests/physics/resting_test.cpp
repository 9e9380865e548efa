/// Bodies at rest: faces and sides that carry a body, and overlap that is removed without a velocity.
#include <algorithm>
#include <cmath>

#include "core/grain_shape.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/energy.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Resting : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Resting);

constexpr double g = 9.81;

/// A body that stands or lies on the floor stays as it is, and the floor carries its weight.
void expect_rest(const std::string& backend, const std::string& name, const Shape& shape, const Start& start,
                 int contacts) {
  const Model model =
      ModelBuilder().material("m").law("m", "m", {.friction = 0.5}).floor("m").body("m", shape, start).build();
  Simulation s(backend, model, precise(1e-3));
  const Quat first = s.state().orientation[1];
  const Vec3 place = s.position(1);
  s.run(500);
  const double reach = model.shapes.back().bounding_radius;
  EXPECT_GE(static_cast<int>(s.contacts().size()), contacts) << name;
  expect_answer({name + ": shift after 0.5 s / size", 0, (s.position(1) - place).norm() / reach, 1e-9, 0, 1}, backend);
  expect_answer({name + ": turn after 0.5 s [rad]", 0, first.angularDistance(s.state().orientation[1]), 1e-7, 0, 1},
                backend);
  expect_answer({name + ": load of the floor / weight", 1, s.force_on(1, 0).z() / (model.bodies[1].mass * g), 1e-9},
                backend);
}

TEST_P(Resting, BoxOnItsFaces) {
  const Vec3 half(0.03, 0.02, 0.05);
  const Shape box = shape_of("box", Box{half});
  expect_rest(GetParam(), "box on its small face", box, {.position = {0, 0, half.z()}}, 4);
  expect_rest(GetParam(), "box on its side", box,
              {.position = {0, 0, half.y()}, .orientation = turn(M_PI / 2, Vec3::UnitX())}, 4);
}

TEST_P(Resting, ConeOnItsSideAndOnItsBase) {
  const double radius = 0.02, height = 0.05, half_angle = std::atan2(radius, height);
  const Shape cone = shape_of("cone", Cone{radius, height});
  expect_rest(
      GetParam(), "cone on its side", cone,
      {.position = {0, 0, radius * std::cos(half_angle)}, .orientation = turn(half_angle + M_PI / 2, Vec3::UnitY())},
      2);
  expect_rest(GetParam(), "cone on its base", cone, {}, 3);
}

TEST_P(Resting, CylinderAndRoundConeOnTheirSides) {
  expect_rest(GetParam(), "cylinder on its side", shape_of("cylinder", Cylinder{0.02, 0.05}),
              {.position = {0, 0, 0.02}, .orientation = turn(M_PI / 2, Vec3::UnitX())}, 2);
  expect_rest(GetParam(), "cylinder on its end", shape_of("cylinder", Cylinder{0.02, 0.05}), {.position = {0, 0, 0.05}},
              3);
  // A sphere with its tangent cone: its lower generatrix is level once the axis dips by asin(radius / length).
  const double radius = 0.02, length = 0.04;
  expect_rest(GetParam(), "round cone on its side", shape_of("round cone", RoundCone{radius, 0.01, length}),
              {.position = {0, 0, radius}, .orientation = turn(std::asin((radius - 0.01) / length), Vec3::UnitY())}, 2);
}

TEST_P(Resting, TwinOnBothSpheres) {
  const Shape twin = make_shape("twin", {Part{Sphere{0.02}, {{-0.012, 0, 0}, Quat::Identity()}},
                                         Part{Sphere{0.02}, {{0.012, 0, 0}, Quat::Identity()}}});
  expect_rest(GetParam(), "twin lying", twin, {.position = {0, 0, 0.02}}, 2);
}

TEST_P(Resting, ATippedBoxFallsBackOnItsFace) {
  const Vec3 half(0.05, 0.05, 0.02);
  const double tip = 0.1;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = 0.5})
                          .floor("m")
                          .box("m", half,
                               {.position = {0, 0, half.x() * std::sin(tip) + half.z() * std::cos(tip)},
                                .orientation = turn(tip, Vec3::UnitY())})
                          .build();
  auto s = simulation(model, precise(1e-3));
  s.run(500);
  expect_answer({"tipped box: height of its centre after 0.5 s [m]", half.z(), s.position(1).z(), 1e-3}, GetParam());
  expect_answer({"tipped box: cosine of its tilt", 1, (s.state().orientation[1] * Vec3::UnitZ()).z(), 1e-5},
                GetParam());
  expect_answer({"tipped box: kinetic energy / m g half height", 0,
                 kinetic_energy(s) / (model.bodies[1].mass * g * half.z()), 1e-9, 0, 1},
                GetParam());
}

TEST_P(Resting, OverlapIsRemovedWithoutVelocity) {
  const double radius = 0.02;
  const Shape box = shape_of("box", Box{{0.02, 0.02, 0.02}});
  const Model model =
      ModelBuilder()
          .material("m")
          .law("m", "m", {.friction = 0.5, .rolling_friction = 0.1, .spinning_friction = 0.1, .restitution = 0.9})
          .gravity(Vec3::Zero())
          .floor("m")
          .sphere("m", radius, {.position = {0, 0, 0.8 * radius}})
          .sphere("m", radius, {.position = {1.7 * radius, 0, 1.1 * radius}})
          .sphere("m", 2 * radius, {.position = {0.5 * radius, 2 * radius, 2.5 * radius}})
          .body("m", box, {.position = {-2 * radius, -radius, 0.7 * radius}, .orientation = turn(0.3, {1, 2, 3})})
          .build();
  auto s = simulation(model, precise(1e-3));
  double fastest = 0, first = 0;
  s.run(100, [&](const Simulation& now) {
    if (first == 0) first = now.report().penetration;
    for (int i = 1; i <= 4; ++i) fastest = std::max({fastest, now.velocity(i).norm(), radius * now.spin(i).norm()});
  });
  note("overlap at the start / R", first / radius);
  EXPECT_GT(first, 0.2 * radius);
  EXPECT_EQ(fastest, 0) << "a velocity came from overlap";
  expect_answer({"overlapping bodies: fastest speed in 100 steps [m/s]", 0, fastest, 0, 0, 1}, GetParam());
  expect_answer({"overlapping bodies: overlap left / R", 0, s.report().penetration / radius, 2e-3, 0, 1}, GetParam());
}

TEST_P(Resting, OverlapUnderGravityGivesNoHop) {
  const double radius = 0.02, h = 1e-3;
  const Model model = ModelBuilder()
                          .material("m")
                          .law("m", "m", {.friction = 0.5, .restitution = 0.9})
                          .floor("m")
                          .sphere("m", radius, {.position = {0, 0, 0.9 * radius}})
                          .build();
  auto s = simulation(model, precise(h));
  double top = 0, fastest = 0;
  s.run(200, [&](const Simulation& now) {
    top = std::max(top, now.position(1).z());
    fastest = std::max(fastest, now.velocity(1).norm());
  });
  expect_answer({"overlapping sphere under gravity: highest centre / R", 1, top / radius, 1e-3}, GetParam());
  expect_answer({"overlapping sphere under gravity: fastest speed / g h", 0, fastest / (g * h), 1e-9, 0, 1},
                GetParam());
}

}  // namespace
}  // namespace repose::test
