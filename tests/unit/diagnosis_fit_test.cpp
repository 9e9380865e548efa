#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include <Eigen/Dense>

#include "analysis/diagnosis/bootstrap.hpp"
#include "analysis/diagnosis/held_out.hpp"
#include "analysis/diagnosis/score.hpp"
#include "analysis/diagnosis/uncertainty.hpp"
#include "core/error.hpp"
#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

FitOptions steps(int iterations) {
  FitOptions options;
  options.iterations = iterations;
  return options;
}

Hypothesis of(const std::string& effect) { return {{{find_effect(effect), ""}}}; }

TEST(Fit, OfFreeFlightIsTheStraightLineOfLeastSquares) {
  const Bundle bundle = flights({.noise = 2e-3});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = minimise(problem, start_of(problem, problem.layout({}), all(bundle)), {});
  for (std::size_t run = 0; run < bundle.runs.size(); ++run) {
    const Observation& o = bundle.runs[run].observations[0];
    for (int k = 0; k < 3; ++k) {
      // x - x0 - g t^2 / 2 = v t: the slope through the origin.
      double tt = 0, tx = 0;
      for (std::size_t i = 0; i < o.time.size(); ++i) {
        const double t = o.time[i], fall = k == 2 ? 10 - 0.5 * 9.81 * t * t : 0;
        tt += t * t;
        tx += t * (o.position[i][k] - fall);
      }
      EXPECT_NEAR(fit.own[run][k], tx / tt, 2e-5) << run << " " << k;
    }
  }
  EXPECT_NEAR(fit.per_dof(), 1, 0.3);
  EXPECT_EQ(fit.parameters, 12);
}

TEST(Fit, FindsADragCoefficientFromFarAway) {
  const Bundle bundle = flights({.truth = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}"});
  const Problem problem(bundle, all(bundle), fly);
  Fit start = start_of(problem, problem.layout(of("quadratic_drag")), all(bundle));
  start.shared[0] = 0.05;
  const Fit fit = minimise(problem, start, steps(30));
  const double se = standard_errors(problem, fit, 1)[0];
  EXPECT_LT(se, 0.02);
  EXPECT_NEAR(fit.shared[0], 0.47, 4 * se);
  EXPECT_LT(fit.per_dof(), 1.3);
}

TEST(Fit, LeavesStartValuesThatARunHardlyDeterminesWhereTheyWereRead) {
  const Bundle bundle = flights({});
  // The y velocity acts a millionth as it should: least squares alone would turn it to hundreds of metres a second for the sake of noise.
  const Problem problem(bundle, all(bundle), [&](const SimulationRequest& request) {
    History history = fly(request);
    const double weak = 1e-6 * request.scene->bodies[0].velocity.y();
    for (std::size_t i = 0; i < history.time.size(); ++i) history.bodies["ball"].position[i].y() = (0.01 + weak) * history.time[i];
    return history;
  });
  const Fit start = start_of(problem, problem.layout({}), all(bundle));
  const Fit fit = minimise(problem, start, steps(30));
  for (std::size_t run = 0; run < bundle.runs.size(); ++run) EXPECT_NEAR(fit.own[run][1], start.own[run][1], 20) << run;
}

TEST(Fit, SeesWhereBodiesHit) {
  const Bundle bundle = flights({});
  EXPECT_FALSE(Problem(bundle, {0}, fly).runs()[0].hits);
}

/// The ball is thrown back by a wall at 1 m as an engine does that sees it too late: at the first of its steps behind it.
Simulate thrown_back_late(double step) {
  return [step](const SimulationRequest& request) {
    History history = fly(request);
    const double v = request.scene->bodies[0].velocity.x(), hit = step * std::ceil(1 / (v * step));
    BodyTrack& ball = history.bodies["ball"];
    for (std::size_t i = 0; i < history.time.size(); ++i) {
      const double t = history.time[i];
      if (t > hit) ball.position[i].x() -= 2 * v * (t - hit);
      if (std::abs(t - hit) > 0.02) continue;
      ball.normal_force[i] = 1;
      ball.approach[i] = v;
    }
    return history;
  };
}

TEST(Fit, IsShakenOutOfTheStepBesideTheOneInWhichTheBodyHit) {
  Bundle bundle = flights({.noise = 1e-3});
  const double read_off = Problem(bundle, {0}, fly).runs()[0].start[0].step;
  const double v = 3, late = 1.6 * read_off / (v * v);  // start values that hit in neighbouring steps differ by as much
  const Simulate engine = thrown_back_late(late);
  Scene truth = bundle.scene;
  truth.bodies[0].velocity.x() = v;
  SimulationRequest request;
  request.scene = &truth;
  Observation seen = bundle.runs[0].observations[0];
  seen.position.clear();
  observe(engine(request), seen.time, seen);
  Random random(3, 1);
  for (std::size_t i = 0; i < seen.time.size(); ++i) bundle.runs[0].observations[0].position[i].x() = seen.position[i].x() + 1e-3 * normal(random);
  const Problem problem(bundle, {0}, engine);
  Fit stuck = start_of(problem, problem.layout({}), {0});
  ASSERT_TRUE(problem.runs()[0].hits);
  stuck.layout.numerics.backend = "late";
  stuck.own[0][0] = v + 1.6 * read_off;
  ASSERT_GT(minimise_own(problem, stuck, {0}, {}).per_dof(), 10);
  const Fit shaken_out = shaken(problem, evaluated(problem, stuck), {0}, {});
  EXPECT_LT(shaken_out.per_dof(), 1.3);
  EXPECT_NEAR(shaken_out.own[0][0], v, 0.1 * read_off);
}

TEST(HeldOut, AStuckRunIsBegunWhereAnotherHypothesisFitsIt) {
  const Bundle bundle = flights({.truth = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}"});
  const Problem problem(bundle, all(bundle), fly);
  const std::vector<std::size_t> train = {0, 1}, held = {2, 3};
  const Fit nominal = minimise(problem, start_of(problem, problem.layout({}), train), {});
  Fit drag = minimise(problem, start_of(problem, problem.layout(of("quadratic_drag")), train), steps(30));
  for (const std::size_t run : held) drag.own[run] *= 1e9;  // beyond the largest residual that is told: no slope leads back
  ASSERT_GT(minimise_own(problem, drag, held, {}).per_dof(), 1e6);
  const std::vector<Fit> fits = held_out_fits(problem, {&nominal, &drag}, held, {}, [](std::size_t) {});
  EXPECT_GT(fits[0].per_dof(), 3);
  EXPECT_LT(fits[1].per_dof(), 1.5);
  EXPECT_EQ(fits[1].shared, drag.shared);
  EXPECT_EQ(fits[1].parameters, fits[0].parameters) << "the drag was fitted to other runs, and takes no degree of freedom from these";
}

TEST(Fit, IsTheSameBitByBitAtAnyNumberOfThreads) {
  const Bundle bundle = flights({.truth = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}"});
  const Problem problem(bundle, all(bundle), fly);
  FitOptions many = steps(30);
  many.threads = 4;
  const Fit start = start_of(problem, problem.layout(of("finite_reynolds_drag")), all(bundle));
  const Fit one = minimise(problem, start, steps(30));
  for (int again = 0; again < 8; ++again) {
    const Problem afresh(bundle, all(bundle), fly);
    const Fit other = minimise(afresh, start_of(afresh, start.layout, all(bundle)), many);
    ASSERT_EQ(other.shared, one.shared);
    for (std::size_t run = 0; run < one.own.size(); ++run) ASSERT_EQ(other.own[run], one.own[run]);
    ASSERT_EQ(other.chi2, one.chi2);
  }
}

TEST(Fit, StaysWithinBounds) {
  // Buoyancy has no negative density: gravity that is too large in the recorded world drives it to its lower bound.
  const Bundle bundle = flights({.truth = "{uniform_force: {force: [0, 0, -0.002]}}"});
  const Problem problem(bundle, all(bundle), fly);
  Fit start = start_of(problem, problem.layout(of("buoyancy")), all(bundle));
  start.shared[0] = 1;
  const Fit fit = minimise(problem, start, steps(50));
  EXPECT_GE(fit.shared[0], fit.layout.shared[0].lower);
  EXPECT_LT(fit.shared[0], 0.1);
}

TEST(Fit, WithFrozenPhysicsTurnsOnlyTheRunsOwnValues) {
  const Bundle bundle = flights({.truth = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}"});
  const Problem problem(bundle, all(bundle), fly);
  Fit start = start_of(problem, problem.layout(of("quadratic_drag")), {0, 1});
  start.shared[0] = 0.3;
  const Fit held = minimise_own(problem, start, {2, 3}, {});
  EXPECT_EQ(held.shared[0], 0.3);
  EXPECT_EQ(held.runs, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(held.own[0], start.own[0]);
  EXPECT_NE(held.own[2], start.own[2]);
}

/// The ball explodes where its start is faster than 3.02 m/s along x: just beside the truth of the first run.
History explosive(const SimulationRequest& request) {
  if (request.scene->bodies[0].velocity.x() > 3.02 && request.scene->bodies[0].velocity.x() < 3.5)
    throw Error("", "exploded", "", Error::Kind::simulation);
  return fly(request);
}

TEST(Fit, WalksAroundPointsThatCannotBeSimulated) {
  const Bundle bundle = flights({.noise = 1e-4, .rate = 100});
  const Problem problem(bundle, {0}, explosive);
  Fit start = start_of(problem, problem.layout({}), {0});
  start.own[0][0] = 2.5;
  const Fit fit = minimise(problem, start, steps(50));
  EXPECT_NEAR(fit.own[0][0], 3, 0.01);
  EXPECT_LT(fit.per_dof(), 2);
}

TEST(Fit, SaysNothingOnStandardErrorWhereItIsInterrupted) {
  const Bundle bundle = flights({});
  bool interrupted = false;
  const Problem problem(bundle, {0}, [&](const SimulationRequest& request) {
    if (interrupted) throw Error("", "interrupted", "", Error::Kind::simulation);
    return fly(request);
  });
  Fit start = start_of(problem, problem.layout({}), {0});
  ::testing::internal::CaptureStderr();
  // The optimiser's coordinates round: of some starts it cannot simulate the first point again.
  for (int n = 0; n < 20; ++n) {
    start.own[0] << 2.9 + 0.011 * n, 0.01 + 0.007 * n, 1.9 + 0.013 * n;
    interrupted = false;
    start = evaluated(problem, start);
    interrupted = true;
    EXPECT_EQ(minimise(problem, start, {}).own[0], start.own[0]);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Fit, BegunWhereNothingRunsIsHandedBack) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, {0}, explosive);
  Fit start = start_of(problem, problem.layout({}), {0});
  start.own[0][0] = 3.2;
  const Fit fit = minimise(problem, start, {});
  EXPECT_TRUE(std::isinf(fit.chi2));
  EXPECT_EQ(fit.own[0][0], 3.2);
}

TEST(Jacobian, AgreesWithTheClosedForm) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = minimise(problem, start_of(problem, problem.layout(of("uniform_force")), all(bundle)), {});
  const RunJacobian j = jacobian(problem, fit, 1);
  ASSERT_EQ(j.own.cols(), 3);
  ASSERT_EQ(j.shared.cols(), 3);
  const double mass = 4.0 / 3 * 3.14159265358979 * 8e-6 * 50;
  for (const Channel& c : problem.runs()[1].channels)
    for (std::size_t i = 0; i < c.time.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const double t = c.time[i], same = k == c.axis ? 1 : 0;
        const Eigen::Index at = c.first + static_cast<Eigen::Index>(i);
        EXPECT_NEAR(j.own(at, k), same * t / c.noise, 1e-4 / c.noise);
        EXPECT_NEAR(j.shared(at, k), same * 0.5 * t * t / mass / c.noise, 1e-3 / mass / c.noise);
      }
}

TEST(Intervals, OfAProfileAreThoseOfTheCurvatureWhereTheModelIsLinear) {
  const Bundle bundle = flights({.truth = "{uniform_force: {force: [0.001, 0, 0]}}"});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = minimise(problem, start_of(problem, problem.layout(of("uniform_force")), all(bundle)), {});
  const double se = standard_errors(problem, fit, 1)[0];
  const Interval interval = profile_interval(problem, fit, 0, 0.4 * se, 1, {});  // a bad first guess
  EXPECT_NEAR(interval.upper - fit.shared[0], 1.645 * se, 0.08 * se);
  EXPECT_NEAR(fit.shared[0] - interval.lower, 1.645 * se, 0.08 * se);
  const Interval wide = profile_interval(problem, fit, 0, se, 3, {});
  EXPECT_NEAR(wide.upper - fit.shared[0], 3 * 1.645 * se, 0.25 * se);
}

TEST(Intervals, OfAProfileEndAtABound) {
  // Nothing but noise: zero viscosity is as good as little, so that the lower end is the bound.
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), fly);
  Fit start = start_of(problem, problem.layout(of("linear_drag")), all(bundle));
  start.shared[0] = 1e-6;
  const Fit fit = minimise(problem, start, {});
  const Interval interval = profile_interval(problem, fit, 0, 1e-6, 1, {});
  EXPECT_DOUBLE_EQ(interval.lower, fit.layout.shared[0].lower);
  // A force that grows with v bends the path by 0.11 a T^2 / 2 beside a free start: of 124 samples with 1 mm of noise, the standard error
  // of the viscosity is 7e-6 Pa s.
  EXPECT_GT(interval.upper, 2e-6);
  EXPECT_LT(interval.upper, 5e-5);
}

TEST(Intervals, CoverTheTruthAsOftenAsTheySay) {
  int covered = 0;
  constexpr int cases = 60;
  for (int n = 0; n < cases; ++n) {
    const Bundle bundle = flights({.velocities = {{3, 0, 2}, {2, 1, 3}}, .seed = static_cast<std::uint64_t>(100 + n), .truth = "{uniform_force: {force: [0.001, 0, 0]}}"});
    const Problem problem(bundle, all(bundle), fly);
    const Fit fit = minimise(problem, start_of(problem, problem.layout(of("uniform_force")), all(bundle)), {});
    const Interval interval = profile_interval(problem, fit, 0, standard_errors(problem, fit, 1)[0], 1, {});
    covered += interval.lower <= 0.001 && 0.001 <= interval.upper;
  }
  // 54 expected; binomial limits of 0.1 %.
  EXPECT_GE(covered, 45);
  EXPECT_LE(covered, 60);
}

/// Recordings whose clock is late, in run k by late + k * further [s].
Bundle late_flights(const Flights& f, double late, double further) {
  Bundle bundle = flights(f);
  for (std::size_t k = 0; k < bundle.runs.size(); ++k)
    for (double& t : bundle.runs[k].observations[0].time) t += late + static_cast<double>(k) * further;
  return bundle;
}

std::vector<ParameterEstimate> of_late_clocks(const Bundle& bundle) {
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = minimise(problem, start_of(problem, problem.layout(of("time_offset")), all(bundle)), {});
  return estimates(problem, fit, 1, false, 1, {});
}

TEST(Intervals, OfWhatEachRunHasForItselfAreThoseOfTheMean) {
  const std::vector<ParameterEstimate> found = of_late_clocks(late_flights({.noise = 1e-7}, 0.010, 0.001));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].name, "time_offset.offset");
  EXPECT_EQ(found[0].effect, "time_offset");
  // Of 0.010, 0.011, 0.012, 0.013: mean 0.0115, standard error 0.00129099 / 2, t(0.95, 3) = 2.353363.
  EXPECT_NEAR(found[0].value, 0.0115, 1e-6);
  EXPECT_NEAR(found[0].upper - found[0].value, 2.353363 * 0.00129099 / 2, 1e-6);
  EXPECT_NEAR(found[0].value - found[0].lower, 2.353363 * 0.00129099 / 2, 1e-6);
}

TEST(Intervals, OfWhatASingleRunHasForItselfCoverTheTruthAsOftenAsTheySay) {
  int covered = 0;
  for (int n = 0; n < 60; ++n) {
    const Bundle bundle = late_flights({.velocities = {{3, 0, 2}}, .seed = static_cast<std::uint64_t>(300 + n)}, 0.010, 0);
    const ParameterEstimate found = of_late_clocks(bundle).at(0);
    covered += found.lower <= 0.010 && 0.010 <= found.upper;
  }
  // 54 expected; binomial limits of 0.1 %.
  EXPECT_GE(covered, 45);
  EXPECT_LT(covered, 60);
}

/// Flights whose first run has the path, the others the height alone, read `bias` too high, and in the last run after the path.
Bundle heights(double bias) {
  Bundle bundle = flights({.noise = 1e-4});
  bundle.noise = {{"position", 1e-4}, {"height", 1e-4}};
  for (std::size_t k = 1; k < bundle.runs.size(); ++k) {
    BundleRun& run = bundle.runs[k];
    const Observation path = run.observations[0];
    Observation height = path;
    height.kind = ObservableKind::series;
    height.name = "height";
    height.unit = "m";
    height.position.clear();
    for (const Vec3& x : path.position) height.value.push_back(x.z() + bias + 1e-3 * static_cast<double>(k));
    run.free.clear();
    run.observations = {height};
    if (k + 1 == bundle.runs.size()) run.observations = {path, height};
  }
  return bundle;
}

TEST(Intervals, OfASensorThatSomeRunsLackAreOfThoseThatHaveIt) {
  const Bundle bundle = heights(0.02);
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = minimise(problem, start_of(problem, problem.layout(of("sensor_bias")), all(bundle)), {});
  const std::vector<ParameterEstimate> found = estimates(problem, fit, 1, false, 1, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].name, "sensor_bias.bias");
  EXPECT_NEAR(found[0].value, 0.022, 1e-4);
  // 0.021, 0.022, 0.023: t(0.95, 2) = 2.919986 times 0.001 / sqrt(3).
  EXPECT_NEAR(found[0].upper - found[0].value, 2.919986e-3 / std::sqrt(3), 2e-4);
}

TEST(Intervals, OfTheRunsNeedSixAndAreOfTheSameSize) {
  Flights f{.truth = "{uniform_force: {force: [0.001, 0, 0]}}"};
  const Bundle few = flights(f);
  const Problem of_few(few, all(few), fly);
  EXPECT_TRUE(run_bootstrap(of_few, start_of(of_few, of_few.layout(of("uniform_force")), all(few)), 99, 1).empty());
  f.velocities.clear();
  for (int i = 0; i < 20; ++i) f.velocities.emplace_back(2 + 0.1 * i, 0.1 * i, 3 - 0.1 * i);
  const Bundle many = flights(f);
  const Problem problem(many, all(many), fly);
  const Fit fit = minimise(problem, start_of(problem, problem.layout(of("uniform_force")), all(many)), {});
  const double se = standard_errors(problem, fit, 1)[0];
  const std::vector<Interval> intervals = run_bootstrap(problem, fit, 999, 1);
  ASSERT_EQ(intervals.size(), 3u);
  EXPECT_GT(intervals[0].upper - intervals[0].lower, 0.5 * 2 * 1.645 * se);
  EXPECT_LT(intervals[0].upper - intervals[0].lower, 1.6 * 2 * 1.645 * se);
  EXPECT_LT(intervals[0].lower, fit.shared[0]);
  EXPECT_GT(intervals[0].upper, fit.shared[0]);
}

TEST(Replica, IsTheNominalPredictionWithNewNoise) {
  const Bundle bundle = flights({.truth = "{uniform_force: {force: [0.002, 0, 0]}}"});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = minimise(problem, start_of(problem, problem.layout({}), all(bundle)), {});
  EXPECT_GT(fit.per_dof(), 1.5);
  const Bundle replica = replica_of(problem, fit, 1, 0);
  ASSERT_EQ(replica.runs.size(), 4u);
  const Problem again(replica, all(replica), fly);
  const Fit refit = minimise(again, start_of(again, again.layout({}), all(replica)), {});
  EXPECT_NEAR(refit.per_dof(), 1, 0.3);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(refit.own[0][k], fit.own[0][k], 0.01);
  EXPECT_NE(replica_of(problem, fit, 1, 1).runs[0].observations[0].position[5], replica.runs[0].observations[0].position[5]);
  EXPECT_EQ(replica_of(problem, fit, 1, 0).runs[0].observations[0].position[5], replica.runs[0].observations[0].position[5]);
}

TEST(Score, IsTheLikelihoodAndTheErrorInSi) {
  const Bundle bundle = flights({.noise = 1e-3, .rate = 200});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = minimise(problem, start_of(problem, problem.layout({}), all(bundle)), {});
  const Score score = score_of(problem, fit);
  EXPECT_NEAR(score.rmse.at("position"), 1e-3, 1e-4);
  EXPECT_DOUBLE_EQ(score.chi2_per_dof, fit.chi2 / static_cast<double>(fit.samples - 12));
  double sum = 0;
  for (const double x : score.per_run) sum += x;
  EXPECT_NEAR(score.log_likelihood, sum, 1e-9);
  EXPECT_NEAR(sum, -0.5 * static_cast<double>(fit.samples) * std::log(2 * 3.14159265358979) - 0.5 * fit.chi2, 1e-6);
}

TEST(Score, CountsHowWellTheFrozenPhysicsIsKnown) {
  // Straight-line residuals: p(held | fitted) = p(both) / p(fitted), from fits of both together.
  const Bundle bundle = flights({.truth = "{uniform_force: {force: [0.0008, 0, 0]}}"});
  const Problem problem(bundle, all(bundle), fly);
  const Layout layout = problem.layout(of("uniform_force"));
  const auto fitted = [&](const std::vector<std::size_t>& runs) { return minimise(problem, start_of(problem, layout, runs), steps(50)); };
  const Fit train = fitted({0}), both = fitted({0, 1, 2, 3}), held = minimise_own(problem, train, {1, 2, 3}, steps(50));
  const Eigen::MatrixXd known = information_of(problem, train), more = information_of(problem, held);
  const double exact = 0.5 * (train.chi2 + held.chi2 - both.chi2) - 0.5 * std::log((known + more).determinant() / known.determinant());
  EXPECT_NEAR(worth_of_uncertainty(problem, train, held, 1, {}), exact, 0.02);
  EXPECT_GT(std::abs(exact), 0.1);
  const Fit nominal = minimise(problem, start_of(problem, problem.layout({}), {0}), {});
  EXPECT_EQ(worth_of_uncertainty(problem, nominal, minimise_own(problem, nominal, {1}, {}), 1, {}), 0);
}

TEST(Score, DoesNotBelieveSlopesThatASimulationDoesNotBearOut) {
  const Bundle bundle = flights({.truth = "{uniform_force: {force: [0.003, 0, 0]}}"});
  // A world in which no force pushes harder than the one that was fitted.
  const auto worth = [&](double hardest) {
    const Problem problem(bundle, all(bundle), [hardest](const SimulationRequest& request) {
      Scene scene = *request.scene;
      for (Effect& effect : scene.effects)
        if (auto* force = std::get_if<UniformForce>(&effect)) force->force.x() = std::min(force->force.x(), hardest);
      SimulationRequest there = request;
      there.scene = &scene;
      return fly(there);
    });
    Fit fit = start_of(problem, problem.layout(of("uniform_force")), {0});
    fit.shared[0] = 0.001;
    fit = minimise_own(problem, evaluated(problem, std::move(fit)), {0}, steps(50));
    return worth_of_uncertainty(problem, fit, minimise_own(problem, fit, {1, 2, 3}, steps(50)), 1, steps(50));
  };
  EXPECT_GT(worth(1), 2);
  EXPECT_LT(worth(0.001), 0);
}

TEST(Score, OfTwoModelsIsPairedByRun) {
  Score nominal, extended;
  nominal.per_run = {-10, -20, -30, -40};
  extended.per_run = {-8, -17, -28, -37};
  const PairedGain gain = paired_gain(nominal.per_run, extended.per_run);
  // Differences 2, 3, 2, 3: mean 2.5, standard deviation 0.577, t = 8.66 with three degrees of freedom.
  EXPECT_NEAR(gain.effect_size, 2.5 / 0.57735, 1e-4);
  EXPECT_NEAR(gain.p, 0.0016, 2e-4);
  EXPECT_NEAR(paired_gain(extended.per_run, nominal.per_run).p, 1 - gain.p, 1e-9);
  nominal.per_run = extended.per_run = {-1};
  EXPECT_EQ(paired_gain(nominal.per_run, extended.per_run).p, 1);
}

TEST(Score, ProvesByTheRatioOfErrorsWhatDiffersInSizeBetweenRuns) {
  const std::vector<double> before{4, 25, 90}, after{1.0, 0.95, 1.1};
  EXPECT_NEAR(p_of_smaller_errors(before, after), 0.0387, 1e-3);  // ln: 1.386, 3.270, 4.405; t = 3.42, two degrees of freedom
  const std::vector<double> nearly{1.02, 0.99, 1.0}, same{1.0, 1.0, 1.0};
  EXPECT_GT(p_of_smaller_errors(nearly, same), 0.2);
  EXPECT_EQ(p_of_smaller_errors(std::vector<double>{5}, std::vector<double>{1}), 1);
  EXPECT_LT(p_of_smaller_errors(std::vector<double>{3, 3.1}, std::vector<double>{0, 0}), 0.05) << "recordings without noise";
}

}  // namespace
}  // namespace repose::diagnosis
