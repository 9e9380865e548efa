// When is a mismatch physics, and when is it nothing, or nothing that is known?
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "analysis/diagnosis/diagnose.hpp"
#include "analysis/diagnosis/explained.hpp"
#include "analysis/diagnosis/maker_step.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"
#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

DiagnoseOptions quick() {
  DiagnoseOptions options;
  options.replicas = 199;
  return options;
}

bool is_candidate(const Bundle& bundle, const std::string& name) {
  const std::vector<Term> terms = possible_terms(bundle, natural_scale(realise(bundle.scene, 1)));
  return std::any_of(terms.begin(), terms.end(), [&](const Term& t) { return t.row->name == name; });
}

TEST(Alarm, AnEffectThatTheSceneSetsToNothingMayBeMissing) {
  for (const char* zero : {"0", "0.0", "0.00", "0e0", "-0.0"}) {
    Flights f = six();
    f.nominal = std::string("{linear_drag: {viscosity: 1.0e-5}, gravity_tilt: {x_deg: ") + zero + ", y_deg: " + zero + "}}";
    const Bundle bundle = flights(f);
    EXPECT_TRUE(is_candidate(bundle, "gravity_tilt")) << zero;
    EXPECT_FALSE(is_candidate(bundle, "linear_drag")) << zero;
    const std::vector<Term> stated = stated_terms(bundle, natural_scale(realise(bundle.scene, 1)));
    EXPECT_TRUE(std::none_of(stated.begin(), stated.end(), [](const Term& t) { return t.row->name == "gravity_tilt"; })) << zero;
  }
  Flights f = six();
  f.nominal = "{inertia: {factor: 1.0}}";
  EXPECT_TRUE(is_candidate(flights(f), "inertia"));
  f.nominal = "{inertia: {factor: 1.1}}";
  EXPECT_FALSE(is_candidate(flights(f), "inertia"));
}

/// Recorded by a maker of first order, `rate` times its step late, at this share of the scene's step.
Bundle stepped_by(double factor, double rate) {
  Bundle bundle = flights(six());
  Random random(1, 4);
  for (BundleRun& run : bundle.runs) {
    Scene made = parse_scene(ball_scene(), "made", run.set);
    made.solver.time_step *= factor;
    record_anew(run, fly_late_by(rate), made, six(), random);
  }
  return bundle;
}

TEST(Alarm, RecordingsThatAnotherSimulationSteppedMoreFinelyMissNothing) {
  // Of first order and at a quarter of the scene's step: several times the noise, and no start value imitates it.
  for (const double factor : {0.25, 1.0}) {
    const Diagnosis d = diagnose(stepped_by(factor, 12 / factor), fly_late_by(12 / factor), quick());
    EXPECT_EQ(d.verdict.word, "none") << factor;
    EXPECT_LT(d.models.front().held_out.chi2_per_dof, 1.5) << factor;
    EXPECT_EQ(parse_scene(d.extended_scene, "extended").solver.integration, Integration::symplectic_euler);
    EXPECT_TRUE(std::any_of(d.notes.begin(), d.notes.end(), [](const std::string& note) { return note.find("bear the step") != std::string::npos; })) << factor;
  }
}

TEST(Alarm, TheStepOfTheRecordingsMayLieBetweenThoseThatAreTried) {
  // A quarter of the step and one of second order both leave more than the noise, which grows with time as what an effect does.
  for (const double factor : {0.13, 0.5}) {
    const Diagnosis d = diagnose(stepped_by(factor, 45), fly_late_by(45), quick());
    EXPECT_EQ(d.verdict.word, "none") << factor;
    EXPECT_LT(d.models[d.best].held_out.chi2_per_dof, 1.5) << factor;
    EXPECT_NEAR(d.models[d.best].fit.layout.numerics.step_factor, factor, 0.03) << factor;
  }
}

TEST(Alarm, OnlyWhatLooksLikeAStepIsTakenForOne) {
  const double rate = 12;
  const Bundle stepped = stepped_by(0.1, rate);  // where a quarter is tried
  Flights f = six();
  f.loads = {{"ball", 0, 10, {0, 6e-5, 0}, Vec3::Zero()}};  // as small, and another way
  const auto mismatch = [&](const Bundle& bundle) {
    const Problem problem(bundle, {0, 1, 2}, fly_late_by(rate));
    const auto fitted = [&](const Hypothesis& h) { return minimise(problem, start_of(problem, problem.layout(h), {0, 1, 2}), {}); };
    return step_mismatch(problem, fitted({}), fitted({{{find_effect("uniform_force"), ""}}}), {}, {});
  };
  const StepMismatch step = mismatch(stepped), force = mismatch(flights(f));
  EXPECT_GT(step.size, 0.2);
  EXPECT_LE(step.size, step.allowed);
  EXPECT_TRUE(step.may_be_one);
  EXPECT_GT(force.size, 0.2);
  EXPECT_LE(force.size, force.allowed);
  EXPECT_FALSE(force.may_be_one);
}

TEST(Alarm, WhatIsRightButTooStrongGainsOnTheWayThere) {
  const auto leaving = [](double a, double b) {
    Fit fit;
    fit.residual = {Eigen::Vector2d(a, b)};
    return fit;
  };
  const Fit nominal = leaving(3, 1);
  EXPECT_DOUBLE_EQ(gain_towards(nominal, leaving(-3, 1)), 9) << "twice too strong: no better itself";
  EXPECT_DOUBLE_EQ(gain_towards(nominal, leaving(2, 1)), 9) << "too weak";
  EXPECT_EQ(gain_towards(nominal, leaving(4, 1)), 0) << "the other way";
  EXPECT_EQ(gain_towards(nominal, nominal), 0);
}

TEST(Alarm, AConstantForceTakesTheDisplacementOfAPushThatPassesAndNotItsAcceleration) {
  Flights f = six();
  const auto both = [&] {
    const Bundle bundle = flights(f);
    const Problem problem(bundle, {0, 1, 2}, fly);
    const auto fitted = [&](const Hypothesis& h) { return minimise(problem, start_of(problem, problem.layout(h), {0, 1, 2}), {}); };
    const Fit nominal = fitted({}), constant = fitted({{{find_effect("uniform_force"), ""}}});
    return std::pair(share_explained(nominal, constant), share_of_accelerations(problem, nominal, constant));
  };
  f.loads = {{"ball", 0.25, 0.35, {0.012, 0, 0}, Vec3::Zero()}};  // 7 m/s^2 for a tenth of a second
  const auto [displacement, acceleration] = both();
  EXPECT_GT(displacement, 0.6);
  EXPECT_LT(acceleration, 0.4);
  f.loads = {{"ball", 0, 10, {0.0012, 0, 0}, Vec3::Zero()}};
  EXPECT_GT(both().second, 0.99);
  f.loads.clear();
  EXPECT_GT(both().second, 0.5) << "noise";
}

TEST(Alarm, TheErrorThatIsLeftIsNotThatOfOneLostRun) {
  Flights f = six(2, "{uniform_force: {force: [0.002, 0, 0]}}");
  Bundle bundle = flights(f);
  const auto left = [&] {
    const Problem problem(bundle, all(bundle), fly);
    const auto fitted = [&](const Hypothesis& h) { return minimise(problem, start_of(problem, problem.layout(h), all(bundle)), {}); };
    const Fit nominal = fitted({}), force = fitted({{{find_effect("uniform_force"), ""}}});
    return std::pair(error_left(nominal, force), error_left(nominal, nominal));
  };
  bundle.noise["position"] = 1e-3;
  EXPECT_LT(left().first, 0.1);
  EXPECT_EQ(left().second, 1);
  // The tracker took another body: nothing explains this run, and it is as far off as all others together.
  Observation& lost = bundle.runs[1].observations[0];
  for (std::size_t i = 0; i < lost.position.size(); ++i) lost.position[i].y() += 0.1 * std::sin(30 * lost.time[i]);
  EXPECT_LT(left().first, 0.25);
}

TEST(Alarm, WhereNothingCanBeTestedThatIsSaid) {
  Flights f = six(1, "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}");
  Bundle bundle = flights(f);
  for (BundleRun& run : bundle.runs) {  // two points and a free velocity
    Observation& o = run.observations[0];
    o.time = {o.time.front(), o.time.back()};
    o.position = {o.position.front(), o.position.back()};
    run.free = {"bodies.ball.velocity", "bodies.ball.position"};
  }
  bundle.noise["position"] = 1e-3;
  const Diagnosis d = diagnose(bundle, fly, quick());
  EXPECT_FALSE(d.tested);
  EXPECT_EQ(d.verdict.word, "none");
  for (const Ranked& r : d.verdict.ranked) EXPECT_LE(r.probability, 0.5);
  EXPECT_TRUE(diagnose(flights(six()), fly, quick()).tested);
}

TEST(Alarm, AnInterruptionAfterTheSearchIsToldAsOne) {
  const Bundle bundle = flights(six(1, "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}"));
  for (const std::string stage : {"runs that were held out", "intervals of the parameters", "a recording that would tell more"}) {
    std::atomic<bool> over{false};
    const Simulate interruptible = [&](const SimulationRequest& request) {
      if (over) throw Error("", "interrupted", "", Error::Kind::simulation);
      return fly(request);
    };
    DiagnoseOptions options = quick();
    options.interrupted = [&] { return over.load(); };
    options.progress = [&](const std::string& now, double, double) { over = over || now == stage; };
    const Diagnosis d = diagnose(bundle, interruptible, options);
    EXPECT_TRUE(over) << stage;
    EXPECT_TRUE(d.interrupted) << stage;
    EXPECT_EQ(d.models[d.best].hypothesis.names(), std::vector<std::string>{"quadratic_drag"}) << stage;
    for (const FittedHypothesis& model : d.models) {
      EXPECT_TRUE(std::isfinite(model.held_out.chi2_per_dof)) << stage;
      EXPECT_TRUE(std::isfinite(model.predicted)) << stage;
    }
  }
}

}  // namespace
}  // namespace repose::diagnosis
