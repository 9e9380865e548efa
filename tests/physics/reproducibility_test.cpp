/// The same bytes at any thread count, and after save and restore; the same answer with a wider search.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/random.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Reproducibility : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Reproducibility);

const PairLaw everything{.friction = 0.5,
                         .rolling_friction = 0.05,
                         .spinning_friction = 0.05,
                         .restitution = 0.3,
                         .cohesion = 0.01,
                         .cohesion_range = 1e-4};

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(static_cast<const void*>(a.data()), b.data(), a.size() * sizeof(T)) == 0;
}

bool same_state(const Snapshot& a, const Snapshot& b) {
  return a.time == b.time && same_bytes(a.position, b.position) && same_bytes(a.orientation, b.orientation) &&
         same_bytes(a.velocity, b.velocity) && same_bytes(a.angular_velocity, b.angular_velocity);
}

bool same_forces(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].a != b[i].a || a[i].b != b[i].b || a[i].force != b[i].force || a[i].torque != b[i].torque) return false;
  return true;
}

/// Touching grains, a few hundred, that are knocked about: enough contacts for the solver to wake a second thread.
Model knocked_lattice() {
  Model model = lattice(8, 8, 0.02, everything);
  Random random(2, 0);
  for (std::size_t i = 1; i < model.bodies.size(); ++i)
    model.initial.velocity[i] = 0.2 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  return model;
}

TEST_P(Reproducibility, OneThreadAndTwoGiveTheSameBytes) {
  const Model model = knocked_lattice();
  REPOSE_SKIP_UNSUPPORTED(model);
  for (const SolverKind kind : {SolverKind::gauss_seidel, SolverKind::apgd, SolverKind::barzilai_borwein}) {
    SolverOptions options = usual(1e-3);
    options.kind = kind;
    options.max_iterations = 40;
    auto one = simulation(model, options);
    options.threads = 2;
    auto two = simulation(model, options);
    for (int i = 0; i < 20; ++i) {
      one.step();
      two.step();
      ASSERT_EQ(one.report().iterations, two.report().iterations) << "step " << i;
      ASSERT_EQ(one.report().residual, two.report().residual) << "step " << i;
    }
    EXPECT_TRUE(same_state(one.state(), two.state()));
    EXPECT_TRUE(same_forces(one.contacts(), two.contacts()));
    // Fewer than a thousand contacts are not given to a second thread.
    EXPECT_GT(one.report().contacts, 1000);
  }
}

TEST_P(Reproducibility, ARunRepeatsItself) {
  const Model model = pile({.count = 100, .kinds = grain_shape_names(), .law = everything});
  REPOSE_SKIP_UNSUPPORTED(model);
  auto first = simulation(model, usual(1e-3)), second = simulation(model, usual(1e-3));
  EXPECT_TRUE(same_state(first.run(200).state(), second.run(200).state()));
}

TEST_P(Reproducibility, SaveAndRestoreContinueBitForBit) {
  if (GetParam() != "dvi") GTEST_SKIP() << "promised by DVI alone";
  const Model model = pile({.count = 100, .kinds = grain_shape_names(), .law = everything});
  for (const SolverKind kind : {SolverKind::gauss_seidel, SolverKind::apgd, SolverKind::barzilai_borwein}) {
    SolverOptions options = usual(1e-3);
    options.kind = kind;
    auto through = simulation(model, options), before = simulation(model, options), after = simulation(model, options);
    through.run(200);
    before.run(120);
    Frame frame;
    before.world().save(frame);
    after.restore(frame);
    EXPECT_TRUE(same_state(before.state(), after.state()));
    after.run(80);
    EXPECT_TRUE(same_state(through.state(), after.state())) << "solver " << static_cast<int>(kind);
    EXPECT_TRUE(same_forces(through.contacts(), after.contacts())) << "solver " << static_cast<int>(kind);
  }
}

TEST_P(Reproducibility, SavedInTheMiddleOfImpactsItContinuesToo) {
  if (GetParam() != "dvi") GTEST_SKIP() << "promised by DVI alone";
  const Model model = pile({.count = 48, .kinds = {"sphere", "twin"}, .law = everything, .fall = 2});
  auto through = simulation(model, usual(1e-3));
  for (int i = 0; i < 60; ++i) {
    Frame frame;
    through.world().save(frame);
    auto resumed = simulation(model, usual(1e-3));
    resumed.restore(frame);
    through.step();
    resumed.step();
    ASSERT_TRUE(same_state(through.state(), resumed.state())) << "saved after step " << i;
  }
}

/// Grains fall into a heap: a wider search finds more pairs, none of which may act. Largest shift / R of 64 grains.
double shift_by_margin(const std::string& backend, const PairLaw& law) {
  const Model model = pile({.count = 64, .law = law});
  SolverOptions options = precise(1e-3);
  Simulation narrow(backend, model, options);
  options.search_margin = 2;
  Simulation wide(backend, model, options);
  double worst = 0;
  int found = 0;
  // A heap forgets its start exponentially fast, so the comparison ends while rounding is still small.
  for (int i = 0; i < 60; ++i) {
    narrow.step();
    wide.step();
    found = std::max(found, wide.report().contacts - narrow.report().contacts);
    for (int b = 5; b < 69; ++b) worst = std::max(worst, (narrow.position(b) - wide.position(b)).norm() / 0.01);
  }
  EXPECT_GT(found, 0);
  return worst;
}

TEST_P(Reproducibility, ADoubledSearchMarginChangesNothing) {
  PairLaw law = everything;
  law.restitution = 0;
  expect_answer({"search margin doubled, 64 cohesive grains fall, e = 0: largest shift / R", 0,
                 shift_by_margin(GetParam(), law), 1e-8, 0, 1},
                GetParam());
  expect_answer({"search margin doubled, 64 cohesive grains fall, e = 0.3: largest shift / R", 0,
                 shift_by_margin(GetParam(), everything), 1e-8, 0, 1},
                GetParam());
}

}  // namespace
}  // namespace repose::test
