#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "analysis/diagnosis/diagnose.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"
#include "core/yaml_tree.hpp"
#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

const char* const drag = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}";

DiagnoseOptions quick() {
  DiagnoseOptions options;
  options.replicas = 199;
  return options;
}

/// The flights as another engine, or the same one solved in another way, would have flown them.
Bundle recorded_by(const Simulate& engine, const Flights& f, const std::function<void(SolverOptions&)>& solved) {
  Bundle bundle = flights(f);
  Random random(f.seed, 4);
  for (BundleRun& run : bundle.runs) {
    Scene truth = parse_scene(ball_scene(f.truth), "truth", run.set);
    solved(truth.solver);
    record_anew(run, engine, truth, f, random);
  }
  return bundle;
}

TEST(Diagnosis, ContradictsAConstantOfTheSceneWhereNothingElseExplains) {
  Flights f = six(1, drag);
  f.nominal = "{quadratic_drag: {coefficient: 0.3, fluid_density: 1.2}, linear_drag: {viscosity: 1.8e-5}}";
  f.truth = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}, linear_drag: {viscosity: 1.8e-5}}";
  const Diagnosis d = diagnose(flights(f), fly, quick());
  const FittedHypothesis& best = d.models[d.best];
  ASSERT_EQ(best.hypothesis.names(), std::vector<std::string>{"quadratic_drag"}) << best.hypothesis.label();
  ASSERT_EQ(best.parameters.size(), 1u);
  EXPECT_NEAR(best.parameters[0].value, 0.47, 0.02);
  EXPECT_NE(d.extended_scene.find("fluid_density: 1.2"), std::string::npos) << d.extended_scene;
}

TEST(Diagnosis, FindsDragNamesItAndProvesItOnRunsThatWereNotUsed) {
  const Bundle bundle = flights(six(1, drag));
  const Diagnosis d = diagnose(bundle, fly, quick());
  EXPECT_EQ(d.verdict.word, "missing");
  const FittedHypothesis& best = d.models[d.best];
  ASSERT_EQ(best.hypothesis.names(), std::vector<std::string>{"quadratic_drag"}) << best.hypothesis.label();
  ASSERT_EQ(best.parameters.size(), 1u);
  EXPECT_LT(best.parameters[0].lower, 0.47);
  EXPECT_GT(best.parameters[0].upper, 0.47);
  EXPECT_LT(best.parameters[0].upper - best.parameters[0].lower, 0.1);
  EXPECT_LE(d.lack_of_fit_p, 0.01);
  EXPECT_FALSE(d.bootstrapped);
  EXPECT_EQ(d.replicas, 199);
  EXPECT_EQ(best.held_out.runs.size(), 2u);
  EXPECT_GT(best.held_out.log_likelihood, d.models.front().held_out.log_likelihood + 20);
  EXPECT_LT(best.held_out.chi2_per_dof, 1.5);
  ASSERT_FALSE(d.where.empty());
  EXPECT_EQ(d.where.front().segment.phase, Phase::flight);
  ASSERT_EQ(d.compared.size(), d.run_ids.size());
  for (const Compared& c : d.compared) EXPECT_NEAR(c.until, 0.6, 1e-9) << c.run;  // nothing here is chaotic
}

TEST(Diagnosis, NoiseThatIsStatedTooLargeHidesNoShareOfWhatIsExplained) {
  Bundle bundle = flights(six(3, "{quadratic_drag: {coefficient: 0.015, fluid_density: 1.2}}"));
  bundle.noise["position"] = 1.35e-3;  // truth 1e-3: the fit leaves 0.55 per degree of freedom, and the nominal less than 1
  const Diagnosis d = diagnose(bundle, fly, quick());
  ASSERT_LT(d.models.front().fit.per_dof(), 1);
  EXPECT_LE(d.lack_of_fit_p, 0.01);
  EXPECT_NE(d.verdict.word, "unknown");
  EXPECT_NE(d.best, 0u);
  EXPECT_GT(d.explained, 0.8);
}

TEST(Diagnosis, ARunThatWasHeldOutAndIsMissedMakesNothingMissingUntrue) {
  Bundle bundle = flights(six(9, "{}"));
  bundle.split_given = true;
  for (std::size_t i = 0; i < bundle.runs.size(); ++i) bundle.runs[i].held_out = i >= 4;
  EXPECT_EQ(diagnose(bundle, fly, quick()).verdict.word, "none");
  bundle.runs[4].observations[0].position[12].z() += 0.3;  // 300 sigma
  const Diagnosis d = diagnose(bundle, fly, quick());
  EXPECT_EQ(d.verdict.word, "unknown");
  EXPECT_EQ(d.only_held_out, std::vector<std::string>{bundle.runs[4].id});
  ASSERT_FALSE(d.where.empty());
  EXPECT_EQ(d.run_ids[d.where.front().run], bundle.runs[4].id);
}

TEST(Diagnosis, TheExtendedSceneGivesTheStatedScore) {
  const Bundle bundle = flights(six(2, drag));
  const Diagnosis d = diagnose(bundle, fly, quick());
  const FittedHypothesis& best = d.models[d.best];
  double squares = 0;
  std::size_t samples = 0;
  for (const std::size_t run : best.held_fit.runs) {
    YamlNode tree = parse_yaml(d.extended_scene, "extended");
    for (Eigen::Index k = 0; k < 3; ++k) set_path(tree, "bodies.ball.velocity." + std::to_string(k), std::to_string(best.held_fit.own[run][k]));
    const Scene scene = parse_scene(emit_yaml(tree), "extended");
    SimulationRequest request;
    request.scene = &scene;
    const BundleRun* recorded = nullptr;
    for (const BundleRun& r : bundle.runs)
      if (r.id == d.run_ids[run]) recorded = &r;
    const Observation& o = recorded->observations[0];
    Observation simulated;
    simulated.body = o.body;
    observe(fly(request), o.time, simulated);
    for (std::size_t i = 0; i < o.time.size(); ++i) squares += (simulated.position[i] - o.position[i]).squaredNorm();
    samples += 3 * o.time.size();
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(samples)) / best.held_out.rmse.at("position"), 1, 1e-3);
}

TEST(Diagnosis, TellsAWrongRulerFromPhysics) {
  Bundle bundle = flights(six(3, "{}"));
  for (BundleRun& run : bundle.runs)
    for (Vec3& x : run.observations[0].position) x *= 1.03;
  const Diagnosis d = diagnose(bundle, fly, quick());
  EXPECT_EQ(d.verdict.word, "measurement");
  ASSERT_EQ(d.models[d.best].hypothesis.names(), std::vector<std::string>{"length_scale"});
  EXPECT_NEAR(d.models[d.best].parameters[0].value, 1.03, 0.002);
}

/// Six flights, each with a kick at another time and in another direction: `fitted` [N] in the first four, `held_out` in the others, which are
/// held out.
Bundle kicked_flights(double fitted, double held_out) {
  Bundle bundle;
  Random random(9, 1);
  for (int n = 0; n < 6; ++n) {
    Flights f{.velocities = {{3.0 - n, 0.5 * n, 2}}, .noise = 2e-4, .seed = static_cast<std::uint64_t>(40 + n)};
    const double from = random.uniform(0.1, 0.4);
    f.loads = {{"ball", from, from + 0.08, (n < 4 ? fitted : held_out) * (random.rotation() * Vec3::UnitX()), Vec3::Zero()}};
    Bundle one = flights(f);
    one.runs[0].id = "kick-" + std::to_string(n);
    one.runs[0].held_out = n >= 4;
    if (n > 0) bundle.runs.push_back(one.runs[0]);
    if (n == 0) bundle = one;
  }
  bundle.split_given = true;
  return bundle;
}

TEST(Diagnosis, TellsAnOriginThatIsOffFromForces) {
  Bundle bundle = flights(six(4, "{}"));
  for (BundleRun& run : bundle.runs)
    for (Vec3& x : run.observations[0].position) x += Vec3(0.003, 0, -0.005);
  const Diagnosis d = diagnose(bundle, fly, quick());
  // Of a ball that does not turn, nobody can tell whether the ruler's origin is off or its centre of mass.
  EXPECT_EQ(d.verdict.indistinguishable, (std::vector<std::vector<std::string>>{{"sensor_bias", "center_of_mass_offset"}}));
  ASSERT_EQ(d.verdict.ranked.front().effects, std::vector<std::string>{"sensor_bias"});
  const std::vector<ParameterEstimate>& found = d.models[d.best].parameters;
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].name, "sensor_bias.bias.0");
  EXPECT_EQ(found[0].unit, "m");
  const Vec3 truth(0.003, 0, -0.005);
  for (std::size_t i = 0; i < 3; ++i) {
    // The 90 % interval, twice as wide: 0.1 % of draws are beyond.
    const double half = 0.5 * (found[i].upper - found[i].lower);
    EXPECT_NEAR(found[i].value, truth[static_cast<Eigen::Index>(i)], 2 * half);
    EXPECT_LT(half, 0.5e-3);
  }
}

TEST(Diagnosis, IsUnknownWhereTheForceIsInNoLibrary) {
  const Diagnosis d = diagnose(kicked_flights(0.01, 0.01), fly, quick());
  EXPECT_EQ(d.verdict.word, "unknown") << d.models[d.best].hypothesis.label();
  ASSERT_FALSE(d.where.empty());
  EXPECT_LE(d.where.front().p, 0.01);
}

TEST(Diagnosis, WhatFittedRunsShowWeaklyAndOthersNotAtAllIsChance) {
  constexpr double weak = 5.5e-5;  // just beyond what 199 replicas of the noise give
  const Diagnosis once = diagnose(kicked_flights(weak, 0), fly, quick());
  EXPECT_LE(once.lack_of_fit_p, level);
  EXPECT_EQ(once.verdict.word, "none");
  ASSERT_TRUE(once.held_out_p.has_value());
  EXPECT_GT(*once.held_out_p, 0.05);
  const Diagnosis twice = diagnose(kicked_flights(weak, 2 * weak), fly, quick());
  EXPECT_EQ(twice.verdict.word, "unknown");
  EXPECT_FALSE(twice.held_out_p.has_value());
  const Diagnosis beyond_doubt = diagnose(kicked_flights(0.01, 0), fly, quick());
  EXPECT_EQ(beyond_doubt.verdict.word, "unknown") << "a mishap in fitted runs is worth telling";
}

TEST(Diagnosis, BlamesTheContactLawWhereTheOtherOneExplains) {
  // An engine whose relaxed law gives each flight a kick of its own, which no effect of the library imitates.
  const auto engine = [](const SimulationRequest& request) {
    SimulationRequest kicked = request;
    const Vec3 v = request.scene->bodies[0].velocity;
    const double from = 0.1 + 0.05 * std::round(v.z());
    if (request.scene->solver.law == ContactLaw::relaxed) kicked.loads.push_back({"ball", from, from + 0.08, 0.003 * Vec3(std::cos(9 * from), std::sin(9 * from), 0), Vec3::Zero()});
    return fly(kicked);
  };
  const Bundle bundle = recorded_by(engine, six(8, "{}"), [](SolverOptions& solver) { solver.law = ContactLaw::relaxed; });
  const Diagnosis d = diagnose(bundle, engine, quick());
  EXPECT_EQ(d.verdict.word, "numerics");
  EXPECT_EQ(d.models[d.best].hypothesis.names(), std::vector<std::string>{"engine_law"});
  EXPECT_LT(d.models[d.best].held_out.chi2_per_dof, 1.5);
}

/// Two engines: the other one pushes each flight in a way of its own, which no effect of the library imitates.
History fly_in_either(const SimulationRequest& request) {
  SimulationRequest pushed = request;
  const double from = 0.1 + 0.05 * std::round(request.scene->bodies[0].velocity.z());
  if (request.backend == "other") pushed.loads.push_back({"ball", from, from + 0.08, 0.003 * Vec3(std::cos(9 * from), std::sin(9 * from), 0), Vec3::Zero()});
  return fly(pushed);
}

Bundle recorded_by_the_other(const Flights& flights) {
  const auto other = [](const SimulationRequest& request) {
    SimulationRequest there = request;
    there.backend = "other";
    return fly_in_either(there);
  };
  return recorded_by(other, flights, [](SolverOptions&) {});
}

TEST(Diagnosis, BlamesTheEngineThatMadeTheRecordings) {
  DiagnoseOptions options = quick();
  options.other_backends = {"other"};
  const Diagnosis d = diagnose(recorded_by_the_other(six(8, "{}")), fly_in_either, options);
  EXPECT_EQ(d.verdict.word, "numerics");
  EXPECT_EQ(d.models[d.best].hypothesis.names(), std::vector<std::string>{"engine_law"});
  EXPECT_LT(d.models[d.best].held_out.chi2_per_dof, 1.5);
  EXPECT_TRUE(std::any_of(d.notes.begin(), d.notes.end(), [](const std::string& note) { return note.find("--backend other") != std::string::npos; }));
}

TEST(Diagnosis, TakesTheWaysOfAnEngineForNoSecondEffect) {
  DiagnoseOptions options = quick();
  const Bundle bundle = recorded_by_the_other(six(8, drag));
  const Diagnosis without = diagnose(bundle, fly_in_either, options);
  EXPECT_GT(without.models[without.best].held_out.chi2_per_dof, 1.5);  // else the engine's ways would not have mattered
  options.other_backends = {"other"};
  const Diagnosis d = diagnose(bundle, fly_in_either, options);
  EXPECT_EQ(d.verdict.word, "missing");
  EXPECT_EQ(d.models[d.best].hypothesis.names(), std::vector<std::string>{"quadratic_drag"});
  EXPECT_LT(d.models[d.best].held_out.chi2_per_dof, 1.5);
}

TEST(Diagnosis, NamesPhysicsAloneWhereTheStepIsTooCoarseAsWell) {
  // An engine whose error is a kick in proportion to its step; the recorded world has a quarter of the step, and drag.
  const auto engine = [](const SimulationRequest& request) {
    SimulationRequest kicked = request;
    const Vec3 v = request.scene->bodies[0].velocity;
    const double from = 0.1 + 0.05 * std::round(v.z());
    kicked.loads.push_back({"ball", from, from + 0.08, 3 * request.scene->solver.time_step * Vec3(std::cos(9 * from), std::sin(9 * from), 0), Vec3::Zero()});
    return fly(kicked);
  };
  const Bundle bundle = recorded_by(engine, six(12, drag), [](SolverOptions& solver) { solver.time_step /= 4; });
  const Diagnosis d = diagnose(bundle, engine, quick());
  EXPECT_EQ(d.verdict.word, "missing");
  EXPECT_EQ(d.models[d.best].hypothesis.names(), std::vector<std::string>{"quadratic_drag"});
  EXPECT_LT(d.models[d.best].held_out.chi2_per_dof, 1.5);
  EXPECT_NE(d.extended_scene.find("time_step: 0.0025"), std::string::npos) << d.extended_scene;
}

TEST(Diagnosis, TakesTheStepOfARecordedEngineForNoSecondEffect) {
  // Drag, recorded by an engine of first order at a quarter of the step: what it leaves is half the noise, and smooth.
  const Bundle bundle = recorded_by(fly_late_by(8), six(5, drag), [](SolverOptions& solver) { solver.time_step /= 4; });
  const Diagnosis d = diagnose(bundle, fly_late_by(8), quick());
  EXPECT_EQ(d.verdict.word, "missing");
  EXPECT_EQ(d.models[d.best].hypothesis.names(), std::vector<std::string>{"quadratic_drag"});
  EXPECT_EQ(parse_scene(d.extended_scene, "extended").solver.integration, Integration::symplectic_euler);
  EXPECT_TRUE(std::any_of(d.notes.begin(), d.notes.end(), [](const std::string& note) { return note.find("bear the step of an engine") != std::string::npos; }));
}

TEST(Diagnosis, BlamesAStepThatErrsByManyTimesTheNoise) {
  const Diagnosis d = diagnose(flights(six(1, "{}")), fly_late_by(100), quick());
  EXPECT_EQ(d.verdict.word, "numerics");
  EXPECT_EQ(d.models[d.best].hypothesis.names(), std::vector<std::string>{"time_step"});
  EXPECT_EQ(parse_scene(d.extended_scene, "extended").solver.integration, Integration::second_order);
  EXPECT_LT(d.models[d.best].held_out.chi2_per_dof, 1.5);
}

TEST(Diagnosis, TellsOfAStepThatErrsByLessAndBlamesNothing) {
  for (const double rate : {3.0, 20.0}) {
    const Diagnosis d = diagnose(flights(six(1, "{}")), fly_late_by(rate), quick());
    EXPECT_EQ(d.verdict.word, "none") << rate;
    EXPECT_GT(d.scene_error, 0.3) << rate;
    EXPECT_LT(d.scene_error, 10) << rate;
    EXPECT_TRUE(std::any_of(d.notes.begin(), d.notes.end(), [](const std::string& note) { return note.find("solver.integration") != std::string::npos; })) << rate;
  }
}

TEST(Diagnosis, RaisesFalseAlarmsAsRarelyAsItsDesign) {
  constexpr int cases = 120;
  int alarms = 0, low = 0;
  for (int n = 0; n < cases; ++n) {
    Flights f{.velocities = {{3, 0, 2}, {2, 1, 3}, {4, -1, 1}}, .rate = 40, .duration = 0.5, .seed = static_cast<std::uint64_t>(1000 + n)};
    DiagnoseOptions options = quick();
    options.seed = static_cast<std::uint64_t>(n);
    options.joint_fits = 1;
    const Diagnosis d = diagnose(flights(f), fly, options);
    alarms += d.verdict.word != "none";
    low += d.lack_of_fit_p <= 0.2;
  }
  RecordProperty("alarms", alarms);
  // 1.2 expected; six or more have a probability of 0.2 %.
  EXPECT_LE(alarms, 5);
  // p is twice the smaller of two: at most 24 expected below 0.2, with binomial limits of 0.1 %. Far fewer would be no p at all.
  EXPECT_LE(low, 38);
  EXPECT_GE(low, 6);
}

TEST(Diagnosis, ABootstrapSaysSoAndAgreesWithTheNoiseOnlyNull) {
  DiagnoseOptions options = quick();
  options.bootstrap = 9;
  const Diagnosis nothing = diagnose(flights(six(5, "{}")), fly, options);
  EXPECT_TRUE(nothing.bootstrapped);
  EXPECT_EQ(nothing.replicas, 9);
  EXPECT_GT(nothing.lack_of_fit_p, 0.1);
  const Diagnosis something = diagnose(flights(six(5, drag)), fly, options);
  EXPECT_DOUBLE_EQ(something.lack_of_fit_p, 0.1);
}

TEST(Diagnosis, GivesTheSameAtAnyNumberOfThreads) {
  const Bundle bundle = flights(six(6, drag));
  DiagnoseOptions options = quick();
  const Diagnosis one = diagnose(bundle, fly, options);
  options.threads = 3;
  const Diagnosis three = diagnose(bundle, fly, options);
  EXPECT_EQ(one.extended_scene, three.extended_scene);
  EXPECT_EQ(one.lack_of_fit_p, three.lack_of_fit_p);
  ASSERT_EQ(one.verdict.ranked.size(), three.verdict.ranked.size());
  for (std::size_t i = 0; i < one.verdict.ranked.size(); ++i) EXPECT_EQ(one.verdict.ranked[i].probability, three.verdict.ranked[i].probability);
}

TEST(Diagnosis, AnInterruptionKeepsWhatWasFound) {
  int calls = 0;
  DiagnoseOptions options = quick();
  SimulationStore store;
  options.store = &store;
  options.interrupted = [&] { return ++calls > 40; };
  const Diagnosis d = diagnose(flights(six(7, drag)), fly, options);
  EXPECT_TRUE(d.interrupted);
  EXPECT_FALSE(d.models.empty());
  EXPECT_GT(store.size(), 100u);
}

// As the commands do it: the simulation that is interrupted throws.
TEST(Diagnosis, AnInterruptionWhereverItComesIsNoFailure) {
  const Bundle bundle = flights(six(7, drag));
  for (const int after : {200, 800, 1500, 3000}) {
    std::atomic<int> calls{0};
    const auto over = [&] { return calls > after; };
    const Simulate interruptible = [&](const SimulationRequest& request) {
      ++calls;
      if (over()) throw Error("", "interrupted", "", Error::Kind::simulation);
      return fly(request);
    };
    DiagnoseOptions options = quick();
    options.interrupted = over;
    EXPECT_TRUE(diagnose(bundle, interruptible, options).interrupted) << after;
  }
}

// A value that suits the fitted runs may be impossible in one that was held out.
TEST(Diagnosis, ARunThatCannotBeSimulatedAsFittedCountsAgainstTheFit) {
  Bundle bundle = flights(six(9, drag));
  bundle.split_given = true;
  bundle.runs[5].held_out = bundle.runs[4].held_out = true;
  const Simulate partly = [](const SimulationRequest& request) {
    const bool held = request.scene->bodies[0].velocity.norm() < 1.5;  // the fifth flight
    if (held && !request.scene->effects.empty()) throw Error("scene", "cannot run", "", Error::Kind::simulation);
    return fly(request);
  };
  const Diagnosis d = diagnose(bundle, partly, quick());
  EXPECT_NE(d.verdict.word, "missing");
  EXPECT_TRUE(std::all_of(d.residuals.begin(), d.residuals.end(), [](const ResidualSample& s) { return s.nominal.size() == s.time.size() && s.extended.size() == s.time.size(); }));
}

TEST(Diagnosis, CandidatesThatDoNothingToTheRecordingsAlarmNobody) {
  DiagnoseOptions options = quick();
  options.candidates = {"friction"};  // nothing touches
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const Diagnosis d = diagnose(flights(six(seed, "{}")), fly, options);
    EXPECT_EQ(d.verdict.word, "none") << seed;
    EXPECT_GT(d.lack_of_fit_p, 0.01) << seed;
  }
  options.candidates = {"moving_wall_speed"};
  EXPECT_THROW(diagnose(flights(six(1, "{}")), fly, options), Error);
}

TEST(Diagnosis, WhatRunsSetForThemselvesIsNoCandidate) {
  Bundle bundle = flights(six(1, "{}"));
  bundle.runs[0].set.push_back({"effects.linear_drag.viscosity", "1.0e-3"});
  const std::vector<Term> terms = possible_terms(bundle, natural_scale(realise(bundle.scene, 1)));
  EXPECT_TRUE(std::none_of(terms.begin(), terms.end(), [](const Term& t) { return t.row->name == "linear_drag"; }));
  EXPECT_TRUE(std::any_of(terms.begin(), terms.end(), [](const Term& t) { return t.row->name == "quadratic_drag"; }));
}

TEST(Diagnosis, SaysWhereTheStatedNoiseHidesEverything) {
  Bundle bundle = flights(six(1, drag));
  bundle.noise["position"] = 1;  // a millimetre was meant
  const Diagnosis d = diagnose(bundle, fly, quick());
  ASSERT_TRUE(d.overstated.contains("position"));
  EXPECT_LT(d.overstated.at("position"), 0.05);
  bundle.noise["position"] = 1e-3;
  EXPECT_TRUE(diagnose(bundle, fly, quick()).overstated.empty());
}

TEST(Diagnosis, TakesTheScatterForNoiseWhereTheBundleStatesLess) {
  Flights f = six(3);
  f.rate = 200;
  Bundle bundle = flights(f);
  bundle.noise["position"] = 2e-4;  // a fifth of the truth
  const Diagnosis d = diagnose(bundle, fly, quick());
  EXPECT_EQ(d.verdict.word, "none");
  ASSERT_TRUE(d.understated.contains("position"));
  EXPECT_NEAR(d.understated.at("position"), 1e-3, 1e-4);
  EXPECT_EQ(d.stated_noise.at("position"), 2e-4);
  f.truth = drag;
  bundle = flights(f);
  bundle.noise["position"] = 2e-4;
  EXPECT_TRUE(diagnose(bundle, fly, quick()).understated.empty()) << "more is left than the samples scatter by";
}

TEST(Diagnosis, ABootstrapThatIsInterruptedSaysNothing) {
  std::atomic<bool> stop{false};
  DiagnoseOptions options = quick();
  options.bootstrap = 99;
  options.progress = [&](const std::string& stage, double done, double) { stop = stop || (stage.starts_with("bootstrap") && done > 1); };
  options.interrupted = [&] { return stop.load(); };
  const Diagnosis d = diagnose(flights(six(5, drag)), fly, options);
  EXPECT_TRUE(d.interrupted);
  EXPECT_FALSE(d.bootstrapped);
  EXPECT_LE(d.lack_of_fit_p, 0.01);
  EXPECT_NE(d.verdict.word, "none");
}

TEST(Diagnosis, ANominalSceneThatCannotRunIsTheUsersToMend) {
  const Simulate broken = [](const SimulationRequest&) -> History { throw Error("scene", "cannot run", "mend it", Error::Kind::simulation); };
  try {
    diagnose(flights(six(8, "{}")), broken, quick());
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.problem(), "cannot run");
  }
}

TEST(Diagnosis, DoesNotChooseBetweenDragsThatTheRecordingsCannotPart) {
  // All balls fly at about the same speed for a short time: the two laws differ by less than a tenth of the noise.
  Flights f = six(10, "{quadratic_drag: {coefficient: 0.2, fluid_density: 1.2}}");
  f.velocities = {{4, 0, 0}, {0, 4, 0}, {-4, 0, 0}, {0, -4, 0}, {2.8, 2.8, 0}, {-2.8, 2.8, 0}};
  f.noise = 4e-3;
  f.duration = 0.3;
  const Diagnosis d = diagnose(flights(f), fly, quick());
  EXPECT_LE(d.lack_of_fit_p, 0.01);
  EXPECT_EQ(d.verdict.word, "ambiguous");
  const auto of = [&](const std::string& name) {
    for (const Ranked& r : d.verdict.ranked)
      if (r.effects == std::vector<std::string>{name}) return r.probability;
    return 0.0;
  };
  EXPECT_GT(of("quadratic_drag"), 0.05);
  EXPECT_GT(of("linear_drag"), 0.05);
  ASSERT_FALSE(d.suggested.empty());
}

}  // namespace
}  // namespace repose::diagnosis
