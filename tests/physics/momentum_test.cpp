/// Momentum and angular momentum: kept by every contact pair, whatever its law.
#include <algorithm>
#include <cmath>

#include "core/random.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/energy.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class MomentumOf : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(MomentumOf);

struct Change {
  double linear = 0, angular = 0;  ///< largest, relative to the sums of the bodies' magnitudes
  int contacts = 0;
  double work = 0;  ///< of all contacts / first energy
};

Change largest_change(const std::string& backend, const Model& model, int steps) {
  Simulation s(backend, model, precise(1e-3));
  const Momentum first = momentum(s);
  double linear = 0, angular = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const double p = model.bodies[i].mass * model.initial.velocity[i].norm();
    linear += p;
    angular += p * model.initial.position[i].norm() + spin_momentum(s, i).norm();
  }
  const double energy = kinetic_energy(s);
  Change change;
  s.run(steps, [&](const Simulation& now) {
    const Momentum present = momentum(now);
    change.linear = std::max(change.linear, (present.linear - first.linear).norm() / linear);
    change.angular = std::max(change.angular, (present.angular - first.angular).norm() / angular);
    change.contacts = std::max(change.contacts, now.report().contacts);
    change.work += now.report().contact_work / energy;
  });
  return change;
}

const PairLaw every_friction{.friction = 0.5,
                             .rolling_friction = 0.1,
                             .spinning_friction = 0.1,
                             .restitution = 0.4,
                             .cohesion = 0.02,
                             .cohesion_range = 1e-4};

TEST_P(MomentumOf, APairIsKept) {
  const Shape twin = make_shape("twin", {Part{Sphere{0.02}, {{0.012, 0, 0}, Quat::Identity()}},
                                         Part{Sphere{0.015}, {{-0.012, 0.004, 0}, Quat::Identity()}}});
  const Shape box = shape_of("box", Box{{0.02, 0.015, 0.01}}), egg = shape_of("egg", Ellipsoid{{0.03, 0.02, 0.015}});
  const Shape ball = shape_of("ball", Sphere{0.02});
  struct Pair {
    const char* name;
    const Shape *a, *b;
  };
  for (const Pair& pair : {Pair{"two spheres", &ball, &ball},
                           {"twin and sphere", &twin, &ball},
                           {"box and egg", &box, &egg},
                           {"twin and box", &twin, &box}}) {
    const Model model =
        ModelBuilder()
            .material("m")
            .law("m", "m", every_friction)
            .gravity(Vec3::Zero())
            .body("m", *pair.a,
                  {.position = {0.3, 0.2, 0.1},
                   .velocity = {1, 0.1, 0},
                   .angular_velocity = {3, -5, 8},
                   .orientation = turn(0.4, {1, 2, 3})})
            .body("m", *pair.b,
                  {.position = {0.37, 0.212, 0.106}, .velocity = {-0.7, 0, 0.1}, .angular_velocity = {-2, 4, 5}})
            .build();
    REPOSE_SKIP_UNSUPPORTED(model);
    const Change change = largest_change(GetParam(), model, 60);
    EXPECT_GT(change.contacts, 0);
    EXPECT_LT(change.work, -1e-3) << "the pair did not meet";
    expect_answer({std::string(pair.name) + ", change of momentum", 0, change.linear, 1e-14, 0, 1}, GetParam());
    expect_answer({std::string(pair.name) + ", change of angular momentum", 0, change.angular, 1e-13, 0, 1},
                  GetParam());
  }
}

TEST_P(MomentumOf, ACloudThatCollapsesIsKept) {
  Random random(3, 0);
  ModelBuilder builder;
  PairLaw law = every_friction;
  law.cohesion = 0;
  builder.material("m").law("m", "m", law).gravity(Vec3::Zero());
  for (int i = 0; i < 60; ++i) {
    const Vec3 at = 0.045 * Vec3(i % 4 - 1.5, i / 4 % 4 - 1.5, i / 16 - 1.5);
    const Start start{.position = at + Vec3(0.2, 0, 0),
                      .velocity = -8 * at,
                      .angular_velocity = {random.uniform(-9, 9), 0, 5},
                      .orientation = random.rotation()};
    if (i % 2)
      builder.sphere("m", 0.02, start);
    else
      builder.body("m", shape_of("egg", Ellipsoid{{0.022, 0.018, 0.015}}), start);
  }
  const Model model = builder.build();
  REPOSE_SKIP_UNSUPPORTED(model);
  const Change change = largest_change(GetParam(), model, 100);
  note("collapsing cloud of 60, most contacts", change.contacts);
  note("collapsing cloud of 60, work of all contacts / first energy", change.work);
  expect_answer({"collapsing cloud of 60, change of momentum", 0, change.linear, 1e-13, 0, 1}, GetParam());
  expect_answer({"collapsing cloud of 60, change of angular momentum", 0, change.angular, 1e-12, 0, 1}, GetParam());
}

}  // namespace
}  // namespace repose::test
