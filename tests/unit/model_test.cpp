#include "core/model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/body_frame.hpp"
#include "core/error.hpp"
#include "core/grain_shape.hpp"
#include "tests/support/model_builder.hpp"

namespace repose {
namespace {

using test::ModelBuilder;
using test::shape_of;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// One of everything that a model can hold.
Model rich_model() {
  Motion motion;
  motion.velocity = {0.127, 0, 0};
  motion.angular_velocity = {0, -3.3, 0};
  motion.pivot = {0.1, 0.2, 0.3};
  motion.start = 0.1;
  motion.stop = 2.7;
  motion.vibration_amplitude = {0, 0, 0.001};
  motion.vibration_frequency = 60;
  const PairLaw law{.friction = 0.52,
                    .rolling_friction = 0.05,
                    .spinning_friction = 0.04,
                    .rolling_friction_length = 0.001,
                    .spinning_friction_length = 0.002,
                    .restitution = 0.2,
                    .cohesion = 0.3,
                    .cohesion_range = 1e-3};
  Model model = ModelBuilder()
      .material("pa12", 1020)
      .material("steel", 7800)
      .law("pa12", "pa12", law)
      .law("pa12", "steel", {.friction = 1})
      .floor("steel")
      .named("floor")
      .wall("steel", shape_of("roller", Cylinder{0.38, 1.5}), {{0, 0, 0.4}, test::turn(0.3, {1, 0, 0})}, motion)
      .named("roller")
      .wall("steel", shape_of("shutter", Revolved{{{0, -0.1}, {1, -0.1}, {1, 0}, {0, 0}}}))
      .active({{0, 0.5}, {1.5, 1e300}}, 1e-3)
      .box("pa12", {0.1, 0.2, 0.3},
           {.position = {1, 1, 1}, .velocity = {0.1, 0.7, -0.3}, .angular_velocity = {5, 6, 7}})
      .named("box")
      .body("pa12", make_grain_shape("sphere_cone"), {.position = {-1, 0, 2}, .velocity = {0, 0, -1.3}}, 0.058)
      .as_grain()
      .effect(GravityTilt{3, 4})
      .effect(UniformForce{{1, 2, 3}})
      .effect(LinearDrag{1.8e-5})
      .effect(FiniteReynoldsDrag{1.8e-5, 1.2})
      .build();
  model.bodies[1].yield = Yield{.load = 3, .mass = 0.5};
  return model;
}

void expect_invalid(const std::function<void(Model&)>& spoil, const std::string& place) {
  Model model = rich_model();
  spoil(model);
  try {
    validate(model);
    FAIL() << "accepted; expected a complaint about " << place;
  } catch (const Error& error) {
    EXPECT_NE(error.place().find(place), std::string::npos) << error.what();
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(Model, FindsBodiesByNameButNotGrains) {
  Model model = rich_model();
  EXPECT_EQ(model.find_body("floor"), 0);
  EXPECT_EQ(model.find_body("roller"), 1);
  EXPECT_EQ(model.find_body("box"), 3);
  EXPECT_EQ(model.find_body("missing"), -1);
  model.names.push_back("powder");
  model.bodies[4].name = 3;
  EXPECT_EQ(model.find_body("powder"), -1);
  EXPECT_EQ(model.grain_count(), 1u);
}

TEST(Model, ValidationAcceptsTheGoodAndNamesTheBad) {
  EXPECT_NO_THROW(validate(rich_model()));
  EXPECT_NO_THROW(validate(Model{}));
  expect_invalid([](Model& m) { m.materials[0].density = 0; }, "materials.pa12.density");
  expect_invalid([](Model& m) { m.materials[1].density = nan; }, "materials.steel.density");
  expect_invalid([](Model& m) { m.laws.pop_back(); }, "pairs");
  expect_invalid([](Model& m) { m.laws[1].friction = 0.9; }, "pairs.pa12-steel");
  expect_invalid([](Model& m) { m.laws[0].friction = -0.1; }, "pairs.pa12-pa12");
  expect_invalid([](Model& m) { m.laws[0].rolling_friction_length = nan; }, "pairs.pa12-pa12");
  expect_invalid([](Model& m) { m.laws[0].restitution = 1.01; }, "pairs.pa12-pa12");
  expect_invalid([](Model& m) { m.laws[0].cohesion_range = -1; }, "pairs.pa12-pa12");
  expect_invalid([](Model& m) { m.shapes[3].parts.clear(); }, "shape 3 (box)");
  expect_invalid([](Model& m) { m.shapes[3].parts[0].pose.orientation.w() = 2; }, "shape 3 (box)");
  expect_invalid([](Model& m) { m.bodies[3].shape = 5; }, "body 3 (box)");
  expect_invalid([](Model& m) { m.bodies[3].material = -1; }, "body 3 (box)");
  expect_invalid([](Model& m) { m.bodies[4].name = 3; }, "body 4");
  expect_invalid([](Model& m) { m.bodies[3].scale = 0; }, "body 3 (box)");
  expect_invalid([](Model& m) { m.bodies[3].mass = 0; }, "body 3 (box)");
  expect_invalid([](Model& m) { m.bodies[3].inertia.y() = nan; }, "body 3 (box)");
  expect_invalid([](Model& m) { m.bodies[3].radius = std::numeric_limits<double>::infinity(); }, "body 3 (box)");
  expect_invalid([](Model& m) { m.bodies[3].shape = 0; }, "body 3 (box)");  // a half-space that falls
  expect_invalid([](Model& m) { m.bodies[3].shape = 2; }, "body 3 (box)");  // a solid of revolution that falls
  expect_invalid([](Model& m) { m.bodies[3].active = {{0, 1}}; }, "body 3 (box)");
  expect_invalid([](Model& m) { m.bodies[0].mass = 1; }, "body 0 (floor)");
  expect_invalid([](Model& m) { m.bodies[0].radius = 1; }, "body 0 (floor)");
  expect_invalid([](Model& m) { m.bodies[1].motion.stop = 0; }, "body 1 (roller)");
  expect_invalid([](Model& m) { m.bodies[1].motion.velocity.x() = nan; }, "body 1 (roller)");
  expect_invalid([](Model& m) { m.bodies[1].motion.vibration_frequency = -1; }, "body 1 (roller)");
  expect_invalid([](Model& m) { m.bodies[1].yield->load = -1; }, "body 1 (roller)");
  expect_invalid([](Model& m) { m.bodies[1].yield->mass = 0; }, "body 1 (roller)");
  expect_invalid([](Model& m) { m.bodies[1].yield->load = nan; }, "body 1 (roller)");
  expect_invalid([](Model& m) { m.bodies[3].yield = Yield{1, 1}; }, "body 3 (box)");
  expect_invalid([](Model& m) { m.bodies[2].active[0] = {1, 1}; }, "body 2");
  expect_invalid([](Model& m) { m.bodies[2].gate_tolerance = -1; }, "body 2");
  expect_invalid([](Model& m) { m.bodies[0].role = BodyRole::grain; }, "body 1 (roller)");
  expect_invalid([](Model& m) { m.initial.velocity.pop_back(); }, "initial state");
  expect_invalid([](Model& m) { m.initial.time = nan; }, "initial state");
  expect_invalid([](Model& m) { m.initial.position[3].x() = nan; }, "initial state of body 3");
  expect_invalid([](Model& m) { m.initial.orientation[3].coeffs() *= 1.001; }, "initial state of body 3");
  expect_invalid([](Model& m) { m.gravity.z() = nan; }, "gravity");
  expect_invalid([](Model& m) { m.effects = {GravityTilt{nan, 0}}; }, "effects.gravity_tilt");
  expect_invalid([](Model& m) { m.effects = {UniformForce{{nan, 0, 0}}}; }, "effects.uniform_force.force");
  expect_invalid([](Model& m) { m.effects = {LinearDrag{0}}; }, "effects.linear_drag.viscosity");
  expect_invalid([](Model& m) { m.effects = {QuadraticDrag{-1, 1}}; }, "effects.quadratic_drag.coefficient");
  expect_invalid([](Model& m) { m.effects = {QuadraticDrag{1, 0}}; }, "effects.quadratic_drag.fluid_density");
  expect_invalid(
      [](Model& m) {
        m.effects = {FiniteReynoldsDrag{1, 0}};
      },
      "effects.finite_reynolds_drag.fluid_density");
  expect_invalid([](Model& m) { m.effects = {Buoyancy{-1}}; }, "effects.buoyancy.fluid_density");
  expect_invalid([](Model& m) { m.effects = {Magnus{nan, 1}}; }, "effects.magnus.lift");
  expect_invalid([](Model& m) { m.effects = {Magnus{1, 0}}; }, "effects.magnus.fluid_density");
  expect_invalid([](Model& m) { m.effects = {PeriodicForce{{1, 0, 0}, -1, 0}}; }, "effects.periodic_force");
}

/// The numbers of the primitives that rich_model() uses.
std::vector<double> numbers(const Primitive& primitive) {
  if (const auto* s = std::get_if<RoundCone>(&primitive)) return {s->radius_a, s->radius_b, s->length};
  if (const auto* s = std::get_if<Box>(&primitive)) return {s->half_extents.begin(), s->half_extents.end()};
  if (const auto* s = std::get_if<Cylinder>(&primitive)) return {s->radius, s->half_height};
  std::vector<double> list;
  if (const auto* s = std::get_if<Revolved>(&primitive))
    for (const Vec2& point : s->profile) list.insert(list.end(), point.begin(), point.end());
  return list;
}

void expect_same_bits(const Model& a, const Model& b) {
  EXPECT_EQ(a.laws, b.laws);
  for (std::size_t i = 0; i < a.shapes.size(); ++i) {
    const Shape &s = a.shapes[i], &t = b.shapes[i];
    EXPECT_EQ(s.mass.volume, t.mass.volume);
    EXPECT_EQ(s.mass.centre, t.mass.centre);
    EXPECT_EQ(s.mass.inertia, t.mass.inertia);
    EXPECT_EQ(s.own_frame.position, t.own_frame.position);
    EXPECT_EQ(s.bounding_radius, t.bounding_radius);
    for (std::size_t k = 0; k < s.parts.size(); ++k) {
      EXPECT_EQ(s.parts[k].pose.position, t.parts[k].pose.position);
      EXPECT_EQ(numbers(s.parts[k].primitive), numbers(t.parts[k].primitive));
    }
  }
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const Body &s = a.bodies[i], &t = b.bodies[i];
    EXPECT_EQ(s.scale, t.scale);
    EXPECT_EQ(s.mass, t.mass);
    EXPECT_EQ(s.inertia, t.inertia);
    EXPECT_EQ(s.radius, t.radius);
    EXPECT_EQ(s.volume, t.volume);
    EXPECT_EQ(s.motion, t.motion);
    EXPECT_EQ(s.gate_tolerance, t.gate_tolerance);
    ASSERT_EQ(s.active.size(), t.active.size());
    for (std::size_t k = 0; k < s.active.size(); ++k) {
      EXPECT_EQ(s.active[k].from, t.active[k].from);
      EXPECT_EQ(s.active[k].to, t.active[k].to);
    }
    EXPECT_EQ(a.initial.position[i], b.initial.position[i]);
    EXPECT_EQ(a.initial.orientation[i].coeffs(), b.initial.orientation[i].coeffs());
    EXPECT_EQ(a.initial.velocity[i], b.initial.velocity[i]);
    EXPECT_EQ(a.initial.angular_velocity[i], b.initial.angular_velocity[i]);
  }
  EXPECT_EQ(std::get<UniformForce>(a.effects[1]).force, std::get<UniformForce>(b.effects[1]).force);
  EXPECT_EQ(std::get<LinearDrag>(a.effects[2]).viscosity, std::get<LinearDrag>(b.effects[2]).viscosity);
  EXPECT_EQ(std::get<FiniteReynoldsDrag>(a.effects[3]).viscosity, std::get<FiniteReynoldsDrag>(b.effects[3]).viscosity);
}

TEST(FroudeScaling, ByAPowerOfFourAndBackGivesTheSameBits) {
  const Model model = rich_model();
  expect_same_bits(model, froude_scaled(froude_scaled(model, std::ldexp(1.0, -14)), std::ldexp(1.0, 14)));
}

TEST(FroudeScaling, EachQuantityByItsPowerOfTheLength) {
  const Model model = rich_model(), small = froude_scaled(model, 0.25);
  EXPECT_NO_THROW(validate(small));
  EXPECT_EQ(small.gravity, model.gravity);
  EXPECT_EQ(small.materials[0].density, model.materials[0].density);
  EXPECT_EQ(small.law(0, 0).friction, model.law(0, 0).friction);
  EXPECT_EQ(small.law(0, 0).rolling_friction, model.law(0, 0).rolling_friction);
  EXPECT_EQ(small.law(0, 0).restitution, model.law(0, 0).restitution);
  EXPECT_EQ(small.law(0, 0).rolling_friction_length, model.law(0, 0).rolling_friction_length / 4);
  EXPECT_EQ(small.law(0, 0).cohesion, model.law(0, 0).cohesion / 64);
  EXPECT_EQ(small.law(0, 0).cohesion_range, model.law(0, 0).cohesion_range / 4);
  EXPECT_EQ(small.bodies[3].mass, model.bodies[3].mass / 64);
  EXPECT_EQ(small.bodies[3].inertia, model.bodies[3].inertia / 1024);
  EXPECT_EQ(small.bodies[4].scale, model.bodies[4].scale);
  EXPECT_EQ(small.bodies[4].radius, model.bodies[4].radius / 4);
  EXPECT_EQ(small.bodies[1].motion.velocity, model.bodies[1].motion.velocity / 2);
  EXPECT_EQ(small.bodies[1].motion.angular_velocity, model.bodies[1].motion.angular_velocity * 2);
  EXPECT_EQ(small.bodies[1].motion.vibration_frequency, 120);
  EXPECT_EQ(small.bodies[2].active[0].to, 0.25);
  EXPECT_EQ(*small.bodies[1].yield, (Yield{3.0 / 64, 0.5 / 64}));
  EXPECT_EQ(small.initial.velocity[3], model.initial.velocity[3] / 2);
  EXPECT_EQ(small.initial.angular_velocity[3], model.initial.angular_velocity[3] * 2);
  EXPECT_EQ(std::get<LinearDrag>(small.effects[2]).viscosity, 1.8e-5 / 8);
  // The scaled shapes still have the mass and size of their bodies.
  const Shape& shape = small.shapes[4];
  const double scale = small.bodies[4].scale;
  EXPECT_NEAR(1020 * shape.mass.volume * scale * scale * scale, small.bodies[4].mass, 1e-14 * small.bodies[4].mass);
}

TEST(FroudeScaling, RefusesAFactorThatIsNoFactor) {
  EXPECT_THROW(froude_scaled(rich_model(), 0), Error);
  EXPECT_THROW(froude_scaled(rich_model(), -1), Error);
  EXPECT_THROW(froude_scaled(rich_model(), nan), Error);
}

TEST(BodyFrame, ThereAndBack) {
  const Shape shape =
      make_shape("hammer", {Part{Box{{0.05, 0.05, 0.3}}, Pose{{0.2, 0, 0.3}, test::turn(0.4, {1, 2, 3})}},
                            Part{Sphere{0.2}, Pose{{1, 0, 0.9}, Quat::Identity()}}});
  const Pose own{{3, 4, 5}, test::turn(1.1, {3, -1, 2})};
  for (const double scale : {1.0, 0.3}) {
    const Pose back = own_pose(shape, scale, body_pose(shape, scale, own));
    EXPECT_TRUE(back.position.isApprox(own.position, 1e-14));
    EXPECT_TRUE(back.orientation.toRotationMatrix().isApprox(own.orientation.toRotationMatrix(), 1e-14));
  }
  // A point of the sphere, described in the own frame, is where the body frame says it is.
  const Pose body = body_pose(shape, 1, own);
  EXPECT_TRUE(body.to_world(shape.parts[1].pose.position).isApprox(own.to_world({1, 0, 0.9}), 1e-14));
}

TEST(BodyFrame, VelocityOfTheCentreOfMass) {
  const Shape ball_on_arm = make_shape("ball", {Part{Sphere{0.1}, Pose{{2, 0, 0}, Quat::Identity()}}});
  const Twist twist = body_twist(ball_on_arm, 0.5, {}, {{1, 0, 0}, {0, 0, 3}});
  EXPECT_TRUE(twist.linear.isApprox(Vec3(1, 3, 0), 1e-15));  // the centre is at (1, 0, 0) after scaling
  EXPECT_EQ(twist.angular, Vec3(0, 0, 3));
}

TEST(BodyFrame, AlignedShapeIsTheSameSolid) {
  const Shape shape = shape_of("box", Box{{0.3, 0.2, 0.1}});
  const Shape aligned = aligned_with_own_frame(shape);
  EXPECT_TRUE(aligned.own_frame.orientation.isApprox(Quat::Identity(), 1e-15));
  const Pose own{{1, 2, 3}, test::turn(0.7, {1, 1, 0})};
  const Pose a = body_pose(shape, 1, own), b = body_pose(aligned, 1, own);
  for (const Vec3& point : {Vec3(0.29, 0.19, 0.09), Vec3(0.29, 0.19, 0.11), Vec3(0.31, 0, 0), Vec3(0, 0.19, 0)}) {
    const Vec3 world = own.to_world(point);
    EXPECT_EQ(contains(shape, a.to_local(world)), contains(aligned, b.to_local(world)));
  }
  const double volume = 8 * 0.3 * 0.2 * 0.1;
  EXPECT_NEAR(aligned.mass.inertia(0, 0), volume / 3 * (0.2 * 0.2 + 0.1 * 0.1), 1e-15);
  EXPECT_NEAR(aligned.mass.inertia(2, 2), volume / 3 * (0.3 * 0.3 + 0.2 * 0.2), 1e-15);
}

TEST(BodyFrame, DynamicBodyTakesMassFromItsShape) {
  const Body ball = dynamic_body(shape_of("sphere", Sphere{0.5}), 0, 0.2, 1000, 0);
  const double mass = 1000 * 4.0 / 3 * 3.14159265358979 * 1e-3;
  EXPECT_NEAR(ball.mass, mass, 1e-12);
  EXPECT_NEAR(ball.radius, 0.1, 1e-16);
  EXPECT_TRUE(ball.inertia.isApprox(Vec3::Constant(0.4 * mass * 0.01), 1e-13));
  EXPECT_THROW(dynamic_body(shape_of("half_space", HalfSpace{}), 0, 1, 1000, 0), Error);
}

}  // namespace
}  // namespace repose
