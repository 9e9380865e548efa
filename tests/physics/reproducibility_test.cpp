/// The same bytes at any thread count, and after save and restore; the same answer with a wider search.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "core/random.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/same_state.hpp"
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

bool same_forces(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].a != b[i].a || a[i].b != b[i].b || a[i].force != b[i].force || a[i].torque != b[i].torque) return false;
  return true;
}

/// Touching grains that are knocked about: enough bodies and contacts for a second thread to be woken.
Model knocked_lattice() {
  Model model = lattice(10, 8, 0.02, everything);
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
    options.max_iterations = 20;
    auto one = simulation(model, options);
    options.threads = 2;
    auto two = simulation(model, options);
    int fewest = std::numeric_limits<int>::max();
    for (int i = 0; i < 6; ++i) {
      one.step();
      two.step();
      ASSERT_EQ(one.report().iterations, two.report().iterations) << "step " << i;
      ASSERT_EQ(one.report().residual, two.report().residual) << "step " << i;
      fewest = std::min(fewest, one.report().contacts);
    }
    EXPECT_TRUE(same_state(one.state(), two.state()));
    EXPECT_TRUE(same_forces(one.contacts(), two.contacts()));
    // Of some bodies alone: the floor and two grains.
    const std::vector<int> bodies{0, 5, 170};
    std::vector<Contact> expected, found;
    for (const Contact& c : one.contacts())
      if (std::count(bodies.begin(), bodies.end(), c.a) + std::count(bodies.begin(), bodies.end(), c.b) > 0) expected.push_back(c);
    two.world().read_at(bodies, found);
    EXPECT_GT(expected.size(), 100u);
    EXPECT_TRUE(same_forces(found, expected));
    note("800 grains at 1 and 2 threads, same bytes after 6 steps, solver " + std::to_string(static_cast<int>(kind)) +
             ": fewest contacts",
         fewest);
    // Fewer than a thousand contacts are not given to a second thread.
    EXPECT_GT(fewest, 1000);
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

TEST_P(Reproducibility, SavedWithEveryContactEffectItContinuesBitForBit) {
  if (GetParam() != "dvi") GTEST_SKIP() << "promised by DVI alone";
  Model model = pile({.count = 60, .kinds = {"sphere", "twin"}, .law = everything});
  model.contact_effects = {RateDependentFriction{0.02, 0.1}, AnisotropicFriction{0.6, 20},
                           RateDependentRestitution{0.25, 0.1}, LiquidBridge{0.01, 5e-4}, ContactCompliance{1e3, 0.05}};
  auto through = simulation(model, usual(1e-3)), after = simulation(model, usual(1e-3));
  through.run(100);
  Frame frame;
  through.world().save(frame);
  after.restore(frame);
  through.run(80);
  after.run(80);
  EXPECT_TRUE(same_state(through.state(), after.state()));
  EXPECT_TRUE(same_forces(through.contacts(), after.contacts()));
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

/// Two runs of the same fall of 64 grains into a heap, the second with a search margin twice as wide.
class TwoMargins {
 public:
  TwoMargins(const std::string& backend, const Model& model, const SolverOptions& options)
      : narrow_(backend, model, options), wide_(backend, model, widened(options)) {}

  void step() {
    narrow_.step();
    wide_.step();
    idle_ = std::max(idle_, wide_.report().contacts - narrow_.report().contacts);
  }
  /// Largest distance between the two places of a grain / R.
  double shift() const {
    double worst = 0;
    for (int b = 5; b < static_cast<int>(narrow_.model().bodies.size()); ++b)
      worst = std::max(worst, (narrow_.position(b) - wide_.position(b)).norm() / 0.01);
    return worst;
  }
  double fastest() const {
    double speed = 0;
    for (const Vec3& v : narrow_.state().velocity) speed = std::max(speed, v.norm());
    return speed;
  }
  int idle() const { return idle_; }  ///< most contacts that only the wider search saw

 private:
  static SolverOptions widened(SolverOptions options) {
    options.search_margin = 2;
    return options;
  }

  Simulation narrow_, wide_;
  int idle_ = 0;
};

// A heap forgets its start exponentially fast, so the comparison ends while rounding is still small: after 0.06 s, with
// a residual of 1e-13, the two runs differ by 1e-12 R or less.
TEST_P(Reproducibility, ADoubledSearchMarginChangesNothing) {
  bool sees_more = true;
  for (const double restitution : {0.0, 0.3})
    for (const unsigned seed : {1u, 2u, 3u}) {
      PairLaw law = everything;
      law.restitution = restitution;
      // In such a step no grain moves further than the smallest margin, a fiftieth of its radius.
      const double h = 2e-4;
      TwoMargins runs(GetParam(), pile({.count = 64, .law = law, .seed = seed}), precise(h));
      double worst = 0;
      for (int i = 0; i < 300; ++i) {
        runs.step();
        worst = std::max(worst, runs.shift());
      }
      char name[128];
      std::snprintf(name, sizeof name,
                    "search margin doubled, 64 cohesive grains fall, e = %.1f, seed %u: largest shift / R", restitution,
                    seed);
      expect_answer({name, 0, worst, 1e-9, 0, 1}, GetParam());
      sees_more = sees_more && runs.idle() > 0;
    }
  expect_that("search margin doubled: the wider search sees more contacts", sees_more, GetParam());
}

// What grains move in a step may exceed the margin: then a blow that is handed on within one step can close a pair that
// was not looked at. It overlaps, and is met in the next step: the two runs part by no more than the speed of a bounce
// allows.
TEST_P(Reproducibility, ABlowHandedOnBeyondTheMarginIsMetAStepLater) {
  const double h = 1e-3;
  double worst = 0;
  for (const unsigned seed : {1u, 2u, 3u}) {
    TwoMargins runs(GetParam(), pile({.count = 64, .law = everything, .seed = seed}), precise(h));
    for (int i = 0; i < 60; ++i) {
      const double speed = runs.fastest();
      runs.step();
      if (runs.shift() < 1e-9) continue;
      worst = std::max(worst, runs.shift() * 0.01 / ((1 + everything.restitution) * speed * h));
      break;
    }
  }
  note("the same with steps of 1 ms, e = 0.3: first shift / (1 + e) v h, a limit", worst);
  EXPECT_LE(worst, 1);
}

}  // namespace
}  // namespace repose::test
