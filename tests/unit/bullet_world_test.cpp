/// The Bullet backend against what else may use Bullet in the same process, and the options that it refuses.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <gtest/gtest.h>

#include "backends/bullet/world_bullet.hpp"
#include "core/effect.hpp"
#include "core/error.hpp"
#include "core/grain_shape.hpp"
#include "core/random.hpp"
#include "tests/support/model_builder.hpp"

namespace repose {
namespace {

Model heap() {
  test::ModelBuilder builder;
  builder.material("m").law("m", "m", {.friction = 0.5, .rolling_friction = 0.05, .restitution = 0.3}).floor("m");
  Random random(3, 0);
  const std::vector<std::string> names = grain_shape_names();
  for (int i = 0; i < 21; ++i)
    builder.body("m", make_grain_shape(names[static_cast<std::size_t>(i) % names.size()]),
                 {.position = {0.02 * (i % 3), 0.02 * (i / 3 % 3), 0.02 + 0.024 * (i / 9)}, .orientation = random.rotation()},
                 0.02);
  return builder.build();
}

Snapshot after(int steps, const Model& model) {
  const auto world = bullet::make_world(model, {});
  Snapshot state;
  BodyLoads loads;
  world->read(state);
  for (int i = 0; i < steps; ++i) {
    evaluate_loads(model, state, loads);
    world->step(1e-3, loads);
    world->read(state);
  }
  return state;
}

bool called = false;

TEST(BulletWorld, ProcessWideSettingsOfOthersDoNotReachIt) {
  const Model model = heap();
  const Snapshot alone = after(150, model);
  gContactBreakingThreshold = 7;
  gDbvtMargin = 3;
  gContactAddedCallback = [](btManifoldPoint&, const btCollisionObjectWrapper*, int, int, const btCollisionObjectWrapper*,
                             int, int) { return called = true; };
  gContactProcessedCallback = [](btManifoldPoint&, void*, void*) { return called = true; };
  gContactDestroyedCallback = [](void*) { return called = true; };
  gContactStartedCallback = [](btPersistentManifold* const&) { called = true; };
  gContactEndedCallback = [](btPersistentManifold* const&) { called = true; };
  gCalculateCombinedFrictionCallback = [](const btCollisionObject*, const btCollisionObject*) {
    called = true;
    return btScalar(9);
  };
  const Snapshot disturbed = after(150, model);
  EXPECT_FALSE(called);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    EXPECT_EQ(alone.position[i], disturbed.position[i]);
    EXPECT_EQ(alone.velocity[i], disturbed.velocity[i]);
    EXPECT_EQ(alone.orientation[i].coeffs(), disturbed.orientation[i].coeffs());
  }
  EXPECT_EQ(gContactBreakingThreshold, 7) << "and it leaves them alone";
  EXPECT_EQ(gDbvtMargin, 3);
}

TEST(BulletWorld, RefusesWhatItCannotDo) {
  const Model model = heap();
  EXPECT_TRUE(bullet::unsupported(model).empty());
  Model periodic = model;
  periodic.periodic = {{0, -1, 0}, {0, 1, 0}};
  EXPECT_EQ(bullet::unsupported(periodic), std::vector<std::string>{"periodic"});
  SolverOptions relaxed;
  relaxed.law = ContactLaw::relaxed;
  EXPECT_THROW(bullet::make_world(model, relaxed), Error);
  SolverOptions loose;
  loose.tolerance = 0;
  EXPECT_THROW(bullet::make_world(model, loose), Error);
}

}  // namespace
}  // namespace repose
