#include "analysis/ledger.hpp"

#include <gtest/gtest.h>

#include "tests/support/model_builder.hpp"
#include "tests/unit/flying_world.hpp"

namespace repose {
namespace {

using test::ModelBuilder;

/// A ball on a plane that carries all but a chosen share of its weight.
class LeaningWorld final : public World {
 public:
  LeaningWorld(const Model& model, double carried) : model_(model), state_(model.initial), carried_(carried) {}
  StepReport step(double dt, const BodyLoads& loads) override {
    force_ = -carried_ * loads.force[1];
    state_.velocity[1] += dt / model_.bodies[1].mass * (loads.force[1] + (honest ? force_ : Vec3(2 * force_)));
    state_.position[1] += dt * state_.velocity[1];
    state_.time += dt;
    return {};
  }
  void read(Snapshot& state) const override { state = state_; }
  void read(std::vector<Contact>& contacts) const override {
    contacts.assign(1, {});
    contacts[0].a = 0;
    contacts[0].b = 1;
    contacts[0].force = force_;
  }
  void save(Frame& frame) const override { frame.state = state_; }
  void restore(const Frame& frame) override { state_ = frame.state; }
  bool honest = true;  ///< false: the contact gives twice what it says

 private:
  const Model& model_;
  Snapshot state_;
  double carried_;
  Vec3 force_ = Vec3::Zero();
};

Model ball_on_floor() { return ModelBuilder().material("a").floor("a").sphere("a", 0.1, {.position = {0, 0, 0.1}}).build(); }

Ledger after(MeteredWorld& world, const Model& model, int steps, double dt) {
  Snapshot state;
  BodyLoads loads;
  for (int i = 0; i < steps; ++i) {
    world.read(state);
    evaluate_loads(model, state, loads);
    world.step(dt, loads);
  }
  return world.ledger();
}

TEST(Ledger, FreeFallBalances) {
  const Model model = ball_on_floor();
  MeteredWorld world(model, std::make_unique<FlyingWorld>(model));
  const double h = 1e-3, g = 9.81, m = model.bodies[1].mass;
  const Ledger l = after(world, model, 100, h);
  EXPECT_LT(l.momentum_error, 1e-14);
  EXPECT_NEAR(l.kinetic, 0.5 * m * std::pow(100 * h * g, 2), 1e-12 * m);
  // Symplectic Euler loses m g^2 h^2 / 2 per step.
  EXPECT_NEAR(l.dissipated, 100 * 0.5 * m * g * g * h * h, 1e-12 * m);
  EXPECT_LT(l.energy_gain, 1e-14);
}

TEST(Ledger, LoadsOfTools) {
  const Model model = ball_on_floor();
  MeteredWorld world(model, std::make_unique<LeaningWorld>(model, 1));
  const Ledger l = after(world, model, 10, 1e-3);
  EXPECT_LT(l.momentum_error, 1e-14);
  const auto taken = world.take_impulses();
  EXPECT_NEAR(taken.time, 0.01, 1e-15);
  EXPECT_NEAR(taken.impulse[0].z(), -0.01 * 9.81 * model.bodies[1].mass, 1e-12);
  EXPECT_EQ(world.take_impulses().time, 0);
}

TEST(Ledger, AnEngineThatHidesAnImpulseIsFound) {
  const Model model = ball_on_floor();
  auto dishonest = std::make_unique<LeaningWorld>(model, 1);
  dishonest->honest = false;
  MeteredWorld world(model, std::move(dishonest));
  const Ledger l = after(world, model, 10, 1e-3);
  EXPECT_NEAR(l.momentum_error, 1, 1e-12);  // it flies upwards at g
  // After N steps it is h^2 g N (N + 1) / 2 higher at speed N g h: the fall of D over the work of loads.
  EXPECT_NEAR(l.energy_gain, 1 + 10.0 / 11, 1e-12);
}

}  // namespace
}  // namespace repose
