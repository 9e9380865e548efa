#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>

#include "core/body_frame.hpp"
#include "core/error.hpp"
#include "core/scene.hpp"
#include "tests/support/model_builder.hpp"

namespace repose {
namespace {

using test::shape_of;

constexpr double pi = std::numbers::pi;

GrainPopulation powder(const std::string& name, std::size_t count) {
  GrainPopulation grains;
  grains.name = name;
  grains.material = "pa12";
  grains.count = count;
  grains.mix = {{"sphere", 1}, {"twin", 1}, {"sphere_cone", 2}};
  grains.size = {NormalSize{58e-6, 15e-6}, 30e-6, 100e-6};
  grains.fill.kind = FillRegion::Kind::frustum;
  grains.fill.base = {0, 0, 1e-3};
  grains.fill.radius_bottom = 0.4e-3;
  grains.fill.radius_top = 1e-3;
  grains.fill.height = 1e-3;
  grains.velocity = {0, 0, -0.1};
  return grains;
}

SceneBody scene_body(const std::string& name, const std::string& shape, const std::string& material,
                     const Vec3& position) {
  SceneBody body;
  body.name = name;
  body.shape = shape;
  body.material = material;
  body.position = position;
  return body;
}

/// A box that falls on a floor, beside a funnel full of powder.
Scene rich_scene() {
  Scene scene;
  scene.materials = {{"pa12", {"pa12", 1020}}, {"steel", {"steel", 7800}}};
  scene.pairs = {{{"pa12", "pa12"}, {.friction = 0.52}}, {{"pa12", "steel"}, {.friction = 1}}};
  scene.shapes = {{"brick", shape_of("box", Box{{3e-4, 2e-4, 1e-4}})}, {"ground", shape_of("half_space", HalfSpace{})}};
  SceneBody ground = scene_body("ground", "ground", "steel", {0, 0, 0});
  ground.fixed = true;
  SceneBody brick = scene_body("brick", "brick", "pa12", {0.01, 0, 0.01});
  brick.velocity = {0.1, 0.2, 0.3};
  brick.angular_velocity = {1, 2, 3};
  scene.bodies = {brick, ground};
  scene.tools = {{"funnel",
                  "steel",
                  Funnel{.outlet_diameter = 0.6e-3, .top_diameter = 3e-3, .thickness = 0.1e-3, .opens = 0.1},
                  {0, 0, 0.8e-3},
                  {}}};
  scene.grains = {powder("powder", 300)};
  scene.effects = {LinearDrag{1.8e-5}};
  scene.duration = 1;
  scene.frame_interval = 0.01;
  return scene;
}

void expect_refused(const std::function<void(Scene&)>& spoil, const std::string& text) {
  Scene scene = rich_scene();
  spoil(scene);
  try {
    realise(scene, 1);
    FAIL() << "accepted; expected a complaint with " << text;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    EXPECT_FALSE(error.remedy().empty());
  }
}

/// True if the two models hold the same grains of this population, bit for bit.
bool same_grains(const Model& a, const Model& b, const std::string& population) {
  const auto of = [&](const Model& model) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      const Body& body = model.bodies[i];
      if (body.role != BodyRole::grain || model.names[static_cast<std::size_t>(body.name)] != population) continue;
      numbers.push_back(body.scale);
      for (const double x : model.shapes[static_cast<std::size_t>(body.shape)].mass.inertia.diagonal())
        numbers.push_back(x);
      for (const double x : model.initial.position[i]) numbers.push_back(x);
      for (const double x : model.initial.orientation[i].coeffs()) numbers.push_back(x);
    }
    return numbers;
  };
  return of(a) == of(b);
}

TEST(Realise, BodiesThenToolsThenGrains) {
  const Model model = realise(rich_scene(), 7);
  ASSERT_EQ(model.bodies.size(), 2u + 2u + 300u);
  EXPECT_EQ(model.grain_count(), 300u);
  EXPECT_EQ(model.names, (std::vector<std::string>{"brick", "ground", "funnel", "powder"}));
  EXPECT_EQ(model.find_body("brick"), 0);
  EXPECT_EQ(model.find_body("ground"), 1);
  EXPECT_EQ(model.find_body("funnel"), 2);
  EXPECT_EQ(model.bodies[0].role, BodyRole::body);
  EXPECT_EQ(model.bodies[3].role, BodyRole::tool);
  EXPECT_EQ(model.bodies[4].role, BodyRole::grain);
  EXPECT_EQ(model.gravity, rich_scene().gravity);
  EXPECT_EQ(model.effects.size(), 1u);
  EXPECT_EQ(model.law(0, 0).friction, 0.52);
  EXPECT_EQ(model.law(0, 1).friction, 1);
  EXPECT_EQ(model.law(1, 0).friction, 1);
}

TEST(Realise, SeedAloneDecidesTheGrains) {
  const Model a = realise(rich_scene(), 7), b = realise(rich_scene(), 7), c = realise(rich_scene(), 8);
  EXPECT_TRUE(same_grains(a, b, "powder"));
  EXPECT_FALSE(same_grains(a, c, "powder"));
}

TEST(Realise, AnotherPopulationDoesNotChangeTheFirst) {
  Scene scene = rich_scene();
  const Model one = realise(scene, 7);
  GrainPopulation other = powder("another", 50);
  other.fill.base = {5e-3, 0, 1e-3};
  scene.grains.insert(scene.grains.begin(), other);
  const Model two = realise(scene, 7);
  EXPECT_EQ(two.grain_count(), 350u);
  EXPECT_TRUE(same_grains(one, two, "powder"));
}

TEST(Realise, GrainsHaveTheMassOfTheirSizeAndStartApart) {
  const Model model = realise(rich_scene(), 3);
  std::set<int> shapes;
  for (std::size_t i = 4; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    const Shape& shape = model.shapes[static_cast<std::size_t>(body.shape)];
    shapes.insert(body.shape);
    EXPECT_GE(body.scale, 30e-6);
    EXPECT_LE(body.scale, 100e-6);
    EXPECT_EQ(body.radius, 0.5 * body.scale);
    const double volume = pi / 6 * std::pow(body.scale, 3);
    EXPECT_NEAR(body.volume, volume, 1e-12 * volume);
    EXPECT_NEAR(body.mass, 1020 * volume, 1e-12 * 1020 * volume);
    const Vec3 inertia = 1020 * std::pow(body.scale, 5) * shape.mass.inertia.diagonal();
    EXPECT_LT((body.inertia - inertia).norm(), 1e-12 * inertia.norm());
    EXPECT_EQ(model.initial.velocity[i], Vec3(0, 0, -0.1));
    EXPECT_EQ(model.initial.angular_velocity[i], Vec3::Zero());
    for (std::size_t j = 4; j < i; ++j) {
      const double reach =
          shape.bounding_radius * body.scale +
          model.shapes[static_cast<std::size_t>(model.bodies[j].shape)].bounding_radius * model.bodies[j].scale;
      EXPECT_GT((model.initial.position[i] - model.initial.position[j]).norm(), reach);
    }
  }
  EXPECT_EQ(shapes.size(), 3u);
}

TEST(Realise, PopulationsOfOneRegionAreMixedAndOthersMustNotOverlap) {
  Scene scene = rich_scene();
  scene.grains = {powder("fine", 100), powder("coarse", 20)};
  scene.grains[1].size = {FixedSize{200e-6}, 0, 1};
  const Model model = realise(scene, 5);
  for (std::size_t i = 4; i < model.bodies.size(); ++i)
    for (std::size_t j = 4; j < i; ++j) {
      const auto reach = [&](std::size_t k) {
        return model.bodies[k].scale * model.shapes[static_cast<std::size_t>(model.bodies[k].shape)].bounding_radius;
      };
      EXPECT_GT((model.initial.position[i] - model.initial.position[j]).norm(), reach(i) + reach(j));
    }

  scene.grains[1].fill.base.z() += 1e-5;
  EXPECT_THROW(realise(scene, 5), Error);
}

TEST(Realise, DrawsUntilTheMassIsReached) {
  Scene scene = rich_scene();
  const double wanted = 4e-7;  // about 380 grains
  scene.grains[0].count.reset();
  scene.grains[0].total_mass = wanted;
  const Model model = realise(scene, 1);
  double mass = 0, last = 0;
  for (const Body& body : model.bodies)
    if (body.role == BodyRole::grain) mass += last = body.mass;
  EXPECT_GE(mass, wanted * (1 - 1e-12));
  EXPECT_LT(mass - last, wanted);
}

TEST(Realise, OwnOriginAndFrameBecomeThoseOfTheBody) {
  // A ball at the end of a weightless offset: the user's origin is not the centre of mass.
  Scene scene = rich_scene();
  scene.grains.clear();
  scene.shapes["offset"] =
      make_shape("compound", {Part{Box{{3e-3, 2e-3, 1e-3}}, Pose{{0.05, 0, 0}, Quat::Identity()}}});
  SceneBody body = scene_body("thrown", "offset", "pa12", {1, 2, 3});
  body.orientation = test::turn(pi / 2, {0, 0, 1});
  body.velocity = {1, 0, 0};
  body.angular_velocity = {0, 0, 10};
  scene.bodies.push_back(body);
  const Model model = realise(scene, 1);
  const auto i = static_cast<std::size_t>(model.find_body("thrown"));
  EXPECT_TRUE(model.initial.position[i].isApprox(Vec3(1, 2.05, 3), 1e-14));
  EXPECT_TRUE(model.initial.velocity[i].isApprox(Vec3(1 - 0.5, 0, 0), 1e-13));
  EXPECT_EQ(model.initial.angular_velocity[i], Vec3(0, 0, 10));

  const Shape& shape = model.shapes[static_cast<std::size_t>(model.bodies[i].shape)];
  const Pose own = own_pose(shape, 1, {model.initial.position[i], model.initial.orientation[i]});
  EXPECT_TRUE(own.position.isApprox(Vec3(1, 2, 3), 1e-14));
  EXPECT_NEAR(own.orientation.angularDistance(body.orientation), 0, 1e-7);
  const double volume = 8 * 3e-3 * 2e-3 * 1e-3;
  EXPECT_NEAR(model.bodies[i].mass, 1020 * volume, 1e-12 * 1020 * volume);
  EXPECT_NEAR(model.bodies[i].radius, std::cbrt(0.75 * volume / pi), 1e-15);
}

/// Inertia tensor of a body in world axes.
Mat3 world_inertia(const Model& model, std::size_t i) {
  const Mat3 rotation = model.initial.orientation[i].toRotationMatrix();
  return rotation * model.bodies[i].inertia.asDiagonal() * rotation.transpose();
}

TEST(Realise, MassAndInertiaMayBeGiven) {
  Scene scene = rich_scene();
  scene.grains.clear();
  SceneBody& brick = scene.bodies[0];
  brick.orientation = test::turn(0.8, {1, 2, 3});
  const Mat3 natural = world_inertia(realise(scene, 1), 0);
  const double natural_mass = realise(scene, 1).bodies[0].mass;

  brick.mass = 3 * natural_mass;
  const Model heavy = realise(scene, 1);
  EXPECT_EQ(heavy.bodies[0].mass, 3 * natural_mass);
  EXPECT_TRUE(world_inertia(heavy, 0).isApprox(3 * natural, 1e-14));

  brick.inertia = Vec3(2e-14, 3e-14, 4e-14);
  const Mat3 rotation = brick.orientation.toRotationMatrix();
  const Model given = realise(scene, 1);
  EXPECT_TRUE(world_inertia(given, 0).isApprox(rotation * brick.inertia->asDiagonal() * rotation.transpose(), 1e-14));
  // The solid itself has not moved.
  const Pose pose{given.initial.position[0], given.initial.orientation[0]};
  const Shape& shape = given.shapes[static_cast<std::size_t>(given.bodies[0].shape)];
  EXPECT_TRUE(contains(shape, pose.to_local(brick.position + rotation * Vec3(2.9e-4, 1.9e-4, 0.9e-4))));
  EXPECT_FALSE(contains(shape, pose.to_local(brick.position + rotation * Vec3(1.9e-4, 2.9e-4, 0.9e-4))));
}

TEST(Realise, FixedAndPrescribedBodies) {
  Scene scene = rich_scene();
  Motion motion;
  motion.velocity = {0.127, 0, 0};
  scene.bodies[0].motion = motion;
  const Model model = realise(scene, 1);
  EXPECT_FALSE(model.bodies[0].dynamic);
  EXPECT_EQ(model.bodies[0].motion, motion);
  EXPECT_TRUE(std::isinf(model.bodies[0].radius));
  EXPECT_EQ(model.bodies[0].mass, 0);
  EXPECT_EQ(model.initial.velocity[0], Vec3::Zero());
  EXPECT_FALSE(model.bodies[1].dynamic);
}

TEST(Realise, ShutterLetsAHundredthOfAGrainPass) {
  Scene scene = rich_scene();
  const Model model = realise(scene, 1);
  double mean = 0;
  for (std::size_t i = 4; i < model.bodies.size(); ++i) mean += model.bodies[i].scale / 300;
  EXPECT_EQ(model.bodies[2].gate_tolerance, 0);
  EXPECT_NEAR(model.bodies[3].gate_tolerance, 0.01 * mean, 1e-12 * mean);
  ASSERT_EQ(model.bodies[3].active.size(), 1u);
  EXPECT_EQ(model.bodies[3].active[0].to, 0.1);

  scene.grains.clear();
  EXPECT_DOUBLE_EQ(realise(scene, 1).bodies[3].gate_tolerance, 0.01 * 2e-4);  // the brick is 0.2 mm high
}

TEST(Realise, PairsThatCanMeetNeedALaw) {
  Scene scene = rich_scene();
  scene.pairs.clear();
  try {
    realise(scene, 1);
    FAIL();
  } catch (const Error& error) {
    // Steel never meets steel: no body of steel can move.
    EXPECT_EQ(error.place(), "pairs");
    EXPECT_NE(error.problem().find("pa12-pa12, pa12-steel"), std::string::npos) << error.problem();
    EXPECT_EQ(error.problem().find("steel-steel"), std::string::npos);
  }
  // A single grain of pa12 has no other to meet.
  scene.bodies.erase(scene.bodies.begin());
  scene.grains[0].count = 1;
  scene.pairs = {{{"pa12", "steel"}, {}}};
  EXPECT_NO_THROW(realise(scene, 1));
}

TEST(Realise, RefusesWhatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused([](Scene& s) { s.bodies[0].shape = "bric"; }, "bodies.brick.shape");
  expect_refused([](Scene& s) { s.bodies[0].material = "pa13"; }, "bodies.brick.material");
  expect_refused([](Scene& s) { s.bodies[1].fixed = false; }, "bodies.ground.fixed");
  expect_refused([](Scene& s) { s.bodies[0].mass = 0; }, "bodies.brick.mass");
  expect_refused([](Scene& s) { s.bodies[0].inertia = Vec3(1, 1, 3); }, "bodies.brick.inertia");
  expect_refused([=](Scene& s) { s.bodies[0].inertia = Vec3(1, 1, nan); }, "bodies.brick.inertia");
  expect_refused([=](Scene& s) { s.bodies[0].position.x() = nan; }, "body 0");
  expect_refused([](Scene& s) { s.materials["pa12"].density = 0; }, "materials.pa12.density");
  expect_refused([](Scene& s) { s.tools[0].material = "wood"; }, "tools.funnel.material");
  expect_refused([](Scene& s) { std::get<Funnel>(s.tools[0].kind).thickness = 0; }, "tools.funnel.thickness");
  expect_refused([](Scene& s) { s.grains[0].material = "wood"; }, "grains.powder.material");
  expect_refused([](Scene& s) { s.grains[0].mix = {{"sphere", 0}}; }, "grains.powder.mix");
  expect_refused([](Scene& s) { s.grains[0].mix = {{"sphere", -1}}; }, "grains.powder.mix.sphere");
  expect_refused([](Scene& s) { s.grains[0].mix = {{"cube", 1}}; }, "cube");
  expect_refused([](Scene& s) { s.grains[0].count.reset(); }, "grains.powder");
  expect_refused([](Scene& s) { s.grains[0].total_mass = 1; }, "grains.powder");
  expect_refused([](Scene& s) { s.grains[0].count = 1'000'000'000; }, "grains.powder");
  expect_refused([](Scene& s) { s.grains[0].count.reset(), s.grains[0].total_mass = 1e9; }, "grains.powder");
  expect_refused([](Scene& s) { s.grains[0].fill.grow = false, s.grains[0].count = 20000; }, "grains.powder.fill");
  expect_refused([](Scene& s) { s.grains[0].size.law = FixedSize{-1}; }, "grains.powder.size");
  expect_refused([](Scene& s) { s.effects = {LinearDrag{-1}}; }, "effects.linear_drag");
}

}  // namespace
}  // namespace repose
