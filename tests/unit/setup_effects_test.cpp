#include "core/setup_effects.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/body_frame.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"

namespace repose {
namespace {

const char* const text = R"(
materials: {grain: {density: 1000}, steel: {density: 7800}}
pairs:
  grain-grain: {friction: 0.5, cohesion: 2.0e-6, cohesion_range: 1.0e-6}
  grain-steel: {friction: 0.2}
shapes: {brick: {type: box, size: [0.01, 0.02, 0.03]}, ground: {type: half_space, normal: [0, 0, 1]}}
bodies:
  brick: {shape: brick, material: grain, position: [0.1, 0, 0.05]}
  ground: {shape: ground, material: steel, fixed: true, position: [0, 0, -0.1]}
grains:
  powder: {material: grain, count: 20, mix: {ellipsoid: 1}, size: {normal: [2 mm, 0.2 mm], range: [1.5 mm, 2.5 mm]},
           fill: {box: {lower: [-0.02, -0.02, 0.01], upper: [0.02, 0.02, 0.06]}}}
tools:
  roller: {material: steel, position: [0, 0.2, 0.1], diameter: 0.05, width: 0.05, motion: {velocity: [0.1, 0, 0], angular_velocity: [0, 3, 0], stop: 2}}
  base: {type: plate, material: steel, size: [0.1, 0.1, 0.01]}
duration: 1
)";

Scene with(const std::string& effects) { return parse_scene(text, "test", {{"effects", effects}}); }

TEST(SetupEffects, TheGroundVibratesAndToolsAboveItDoNot) {
  const Scene scene = with("{base_vibration: {amplitude: 1 mm, frequency: 20, phase: 90 deg}}");
  const Motion& base = scene.tools[0].motion;
  ASSERT_EQ(scene.tools[0].name, "base");
  EXPECT_EQ(base.vibration_amplitude, Vec3(0, 0, 1e-3));
  EXPECT_EQ(base.vibration_frequency, 20);
  EXPECT_DOUBLE_EQ(base.vibration_phase, std::acos(-1.0) / 2);
  EXPECT_EQ(scene.tools[1].motion.vibration_amplitude, Vec3::Zero());
  ASSERT_TRUE(scene.bodies[1].motion);
  EXPECT_EQ(scene.bodies[1].motion->vibration_amplitude, Vec3(0, 0, 1e-3));
  EXPECT_FALSE(scene.bodies[0].motion);
  Scene again = scene;
  EXPECT_THROW(apply(BaseVibration{1e-3, 10, 0}, again), Error);
}

TEST(SetupEffects, PrescribedSpeedsTakeAFactor) {
  const Motion motion = with("{moving_wall_speed: {factor: 1.5}}").tools[1].motion;
  EXPECT_DOUBLE_EQ(motion.velocity.x(), 0.15);
  EXPECT_DOUBLE_EQ(motion.angular_velocity.y(), 4.5);
  EXPECT_EQ(motion.stop, 2);
}

TEST(SetupEffects, TheSpreaderOfALayerTakesAFactorWithoutAMotion) {
  const std::string layer = R"({spreader: roller, gap: 1 mm, speed: 0.1, to: 0.1, settle: 1, settle_time_step: 1.0e-4,
                                region: {lower: [0, 0], upper: [0.05, 0.05]}, surface: {cell: 1 mm, square: 2 mm}})";
  const auto with_layer = [&](const std::string& effects) {
    return parse_scene(text, "test", {{"layer", layer}, {"tools.roller.motion", "{}"}, {"effects", effects}});
  };
  EXPECT_DOUBLE_EQ(with_layer("{}").layer->speed, 0.1);
  const Scene faster = with_layer("{moving_wall_speed: {factor: 1.5}}");
  EXPECT_DOUBLE_EQ(faster.layer->speed, 0.15);
  EXPECT_DOUBLE_EQ(parse_scene(faster.text, "again").layer->speed, 0.15);  // once, not twice
  for (const char* factor : {"0", "-1"})
    EXPECT_THROW(with_layer(std::string("{moving_wall_speed: {factor: ") + factor + "}}"), Error);
}

TEST(SetupEffects, GrainsChangeShapeAndSize) {
  EXPECT_DOUBLE_EQ(with("{grain_shape: {aspect: 1.2}}").grains[0].aspect, 1.2);
  const SizeDistribution size = with("{size_distribution: {mean_factor: 2, sd_factor: 0.5}}").grains[0].size;
  EXPECT_DOUBLE_EQ(std::get<NormalSize>(size.law).mean, 4e-3);
  EXPECT_DOUBLE_EQ(std::get<NormalSize>(size.law).sd, 0.2e-3);
  EXPECT_DOUBLE_EQ(size.lower, 3.5e-3);
  EXPECT_DOUBLE_EQ(size.upper, 4.5e-3);
}

TEST(SetupEffects, OtherLawsOfSizeChangeAlike) {
  Scene scene = with("{}");
  scene.grains[0].size = {.law = TableSize{{1, 2, 6}}};
  apply(SizeDistributionFactors{2, 0.5}, scene);
  EXPECT_EQ(std::get<TableSize>(scene.grains[0].size.law).values, (std::vector<double>{4, 5, 9}));
  EXPECT_THROW(apply(SizeDistributionFactors{1, 9}, scene), Error);
  scene.grains[0].size = {.law = LogNormalSize{2, 0.3}, .lower = 1, .upper = 4};
  apply(SizeDistributionFactors{3, 2}, scene);
  EXPECT_DOUBLE_EQ(std::get<LogNormalSize>(scene.grains[0].size.law).median, 6);
  EXPECT_DOUBLE_EQ(std::get<LogNormalSize>(scene.grains[0].size.law).log_sd, 0.6);
  EXPECT_DOUBLE_EQ(scene.grains[0].size.lower, 1.5);
  EXPECT_DOUBLE_EQ(scene.grains[0].size.upper, 24);
}

TEST(SetupEffects, InertiaFollowsTheOwnAxes) {
  const Model plain = realise(with("{}"), 1), changed = realise(with("{inertia: {factor: [1.05, 1, 1.1]}}"), 1),
              all = realise(with("{inertia: {factor: 1.5}}"), 1);
  for (const std::size_t i : {0u, 4u}) {
    ASSERT_TRUE(plain.bodies[i].dynamic);
    EXPECT_TRUE(all.bodies[i].inertia.isApprox(1.5 * plain.bodies[i].inertia, 1e-15));
    EXPECT_EQ(all.bodies[i].mass, plain.bodies[i].mass);
  }
  const Shape& shape = changed.shapes[static_cast<std::size_t>(changed.bodies[0].shape)];
  const Mat3 own = shape.own_frame.orientation.toRotationMatrix();
  const Mat3 before = own.transpose() * plain.bodies[0].inertia.asDiagonal() * own;
  const Mat3 after = own.transpose() * changed.bodies[0].inertia.asDiagonal() * own;
  EXPECT_NEAR(after(0, 0) / before(0, 0), 1.05, 1e-12);
  EXPECT_NEAR(after(1, 1) / before(1, 1), 1, 1e-12);
  EXPECT_NEAR(after(2, 2) / before(2, 2), 1.1, 1e-12);
  EXPECT_THROW(realise(with("{inertia: {factor: [1, 1, 9]}}"), 1), Error);
}

TEST(SetupEffects, AnOffCentreBodyStandsWhereItStood) {
  const Vec3 offset(1e-3, -2e-3, 3e-3);
  const Model plain = realise(with("{}"), 1),
              moved = realise(with("{center_of_mass_offset: {offset: [1 mm, -2 mm, 3 mm]}}"), 1);
  ASSERT_EQ(plain.bodies.size(), moved.bodies.size());
  for (std::size_t i = 0; i < plain.bodies.size(); ++i) {
    const Body &p = plain.bodies[i], &m = moved.bodies[i];
    const Shape &ps = plain.shapes[static_cast<std::size_t>(p.shape)],
                &ms = moved.shapes[static_cast<std::size_t>(m.shape)];
    const Pose pp{plain.initial.position[i], plain.initial.orientation[i]};
    const Pose mp{moved.initial.position[i], moved.initial.orientation[i]};
    const Pose own = own_pose(ps, p.scale, pp), own_moved = own_pose(ms, m.scale, mp);
    EXPECT_LT((own.position - own_moved.position).norm(), 1e-15);
    EXPECT_LT(own.orientation.angularDistance(own_moved.orientation), 1e-7);
    for (std::size_t k = 0; k < ps.parts.size(); ++k) {
      const Vec3 a = pp.position + pp.orientation * (p.scale * ps.parts[k].pose.position);
      const Vec3 b = mp.position + mp.orientation * (m.scale * ms.parts[k].pose.position);
      EXPECT_LT((a - b).norm(), 1e-15);
    }
    const Vec3 shift = mp.position - pp.position;
    EXPECT_LT((shift - (p.dynamic ? Vec3(own.orientation * offset) : Vec3::Zero())).norm(), 1e-15);
    EXPECT_EQ(p.inertia, m.inertia);
  }
}

TEST(SetupEffects, CohesionSoftensAndWallsTakeTheirFriction) {
  const Scene warm = with("{thermal_softening: {temperature: 313.15, scale: 20}}");
  EXPECT_NEAR((warm.pairs.at({"grain", "grain"}).cohesion), 2e-6 * std::exp(1.0), 1e-18);
  const Scene slick = with("{wall_friction: {friction: 0.05}}");
  EXPECT_EQ((slick.pairs.at({"grain", "steel"}).friction), 0.05);
  EXPECT_EQ((slick.pairs.at({"grain", "grain"}).friction), 0.5);
}

TEST(SetupEffects, AreKeptInTheTextOfTheScene) {
  const Scene scene = with("{size_distribution: {mean_factor: 2}, inertia: {factor: 1.5}}");
  EXPECT_NE(scene.text.find("mean_factor: 2"), std::string::npos);
  const Scene again = parse_scene(scene.text, "again");
  EXPECT_EQ(std::get<NormalSize>(again.grains[0].size.law).mean, 4e-3);
  EXPECT_EQ(again.inertia_factor, Vec3::Constant(1.5));
}

TEST(SetupEffects, RefusalsNameThePlace) {
  try {
    parse_scene(text, "test", {{"effects", "{wall_friction: {friction: 1}}"}, {"bodies.brick.material", "steel"}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(error.place().find("effects.wall_friction"), std::string::npos) << error.place();
  }
}

}  // namespace
}  // namespace repose
