#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/verdict.hpp"

namespace repose::diagnosis {
namespace {

Evidence model(const std::vector<std::string>& effects, double held_out, double scale = 1, double explained = 0.99) {
  Evidence e;
  e.effects = effects;
  for (const std::string& name : effects) e.sites.push_back(find_effect(name)->site);
  e.held_out = e.held_out_as_fitted = held_out;
  e.parameters = static_cast<int>(effects.size());
  e.form_parameters = e.parameters;
  e.lack_of_fit = scale;
  e.explained = effects.empty() ? 0 : explained;
  e.error_left = std::sqrt(1 - e.explained);  // as if all runs were alike
  return e;
}

double probability(const Verdict& v, const std::vector<std::string>& effects) {
  for (const Ranked& r : v.ranked)
    if (r.effects == effects) return r.probability;
  return -1;
}

void expect_sums_to_one(const Verdict& v) {
  double sum = 0;
  for (const Ranked& r : v.ranked) sum += r.probability;
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_GE(probability(v, {}), 0);
  EXPECT_GE(probability(v, {"unknown"}), 0);
  for (std::size_t i = 1; i < v.ranked.size(); ++i) EXPECT_LE(v.ranked[i].probability, v.ranked[i - 1].probability);
}

TEST(Verdict, NamesWhatTheHeldOutRunsSpeakFor) {
  const Verdict v = judge({model({}, -500, 3), model({"quadratic_drag"}, -100), model({"linear_drag"}, -150, 1.3)}, 0.002, 0.5);
  EXPECT_EQ(v.word, "missing");
  EXPECT_EQ(v.best, 1);
  EXPECT_GT(probability(v, {"quadratic_drag"}), 0.95);
  EXPECT_TRUE(v.indistinguishable.empty());
  expect_sums_to_one(v);
}

TEST(Verdict, CallsALawByItsPlainLimitWhereNothingBeyondItIsSeen) {
  Evidence general = model({"finite_reynolds_drag"}, -99.8);
  general.general = 1;
  const Verdict alike = judge({model({}, -500, 3), general, model({"linear_drag"}, -100)}, 0.002, 0.5);
  EXPECT_EQ(alike.word, "ambiguous");
  EXPECT_EQ(alike.best, 2);
  general.held_out = -95;
  EXPECT_EQ(judge({model({}, -500, 3), general, model({"linear_drag"}, -100)}, 0.002, 0.5).best, 1) << "what is seen beyond it decides";
}

TEST(Verdict, DoesNotCountAParameterTwiceThatHardlyMatters) {
  Evidence force = model({"uniform_force"}, -102.5);  // its third component is uncertain, which costs likelihood
  force.parameters = force.form_parameters = 3;
  force.held_out_as_fitted = -100.2;
  Evidence tilt = model({"gravity_tilt"}, -100);
  tilt.parameters = tilt.form_parameters = 2;
  const Evidence nominal = model({}, -500, 3);
  const Verdict alike = judge({nominal, tilt, force}, 0.002, 0.5);
  EXPECT_EQ(alike.word, "ambiguous");
  EXPECT_EQ(alike.best, 1);
  EXPECT_GT(probability(alike, {"uniform_force"}), 0.2);
  force.held_out_as_fitted = -102.5;
  EXPECT_EQ(judge({nominal, tilt, force}, 0.002, 0.5).word, "missing") << "as fitted it fits worse";
  force.held_out_as_fitted = -100.2;
  force.train_gain = -5;
  EXPECT_EQ(judge({nominal, tilt, force}, 0.002, 0.5).word, "missing") << "on the fitted runs it fits worse";
  force.train_gain = 0;
  force.general = 1;
  EXPECT_EQ(judge({nominal, tilt, force}, 0.002, 0.5).word, "missing") << "a law whose limit would do";
}

TEST(Verdict, IsNoneWithoutALackOfFitWhateverFitsBetter) {
  const Verdict v = judge({model({}, -110), model({"quadratic_drag"}, -100)}, 0.3, 1);
  EXPECT_EQ(v.word, "none");
  EXPECT_EQ(v.best, 0);
  EXPECT_GT(probability(v, {}), 0.9);
  expect_sums_to_one(v);
}

TEST(Verdict, IsUnknownWhereNothingExplainsTheMismatch) {
  const Verdict nothing = judge({model({}, -500, 3), model({"quadratic_drag"}, -510, 3, 0.1)}, 0.002, 0.002);
  EXPECT_EQ(nothing.word, "unknown");
  EXPECT_GT(probability(nothing, {"unknown"}), 0.8);
  const Verdict little = judge({model({}, -500, 3), model({"quadratic_drag"}, -400, 2.7, 0.3)}, 0.002, 0.002);
  EXPECT_EQ(little.word, "unknown");
  expect_sums_to_one(little);
}

TEST(Verdict, OfTwoThatAreAsGoodTheMeasurementIsBlamedFirst) {
  for (const double less : {0.0, 0.05}) {
    const Verdict v = judge({model({}, -500, 3), model({"center_of_mass_offset"}, -100), model({"sensor_bias"}, -100 - less)}, 0.002, 0.5);
    EXPECT_EQ(v.best, 2);
    EXPECT_EQ(v.ranked.front().effects, std::vector<std::string>{"sensor_bias"});
    EXPECT_EQ(v.word, "ambiguous");
  }
  EXPECT_EQ(judge({model({}, -500, 3), model({"center_of_mass_offset"}, -100), model({"sensor_bias"}, -100.5)}, 0.002, 0.5).best, 1);
}

TEST(Verdict, FittedRunsSpeakWhereHeldOutOnesDoNotShowTheMismatch) {
  const auto trained = [](Evidence e, double gain) {
    e.train_gain = gain;
    return e;
  };
  const std::vector<Evidence> silent{model({}, -100), trained(model({"inertia"}, -99.6), 90), trained(model({"uniform_force"}, -100.4), 20)};
  const Verdict v = judge(silent, 0.002, 0.5);
  EXPECT_EQ(v.word, "missing");
  EXPECT_EQ(v.best, 1);
  EXPECT_TRUE(v.by_fitted_runs);
  EXPECT_GT(probability(v, {"inertia"}), 0.9);
  expect_sums_to_one(v);
  EXPECT_EQ(judge(silent, 0.002, 0.002).word, "unknown") << "something is left";
  EXPECT_EQ(judge(silent, 0.002, 0.5, false).word, "unknown") << "no run counts twice";
  EXPECT_EQ(judge(silent, 0.2, 0.5).word, "none") << "nothing is missing";
  const Verdict against = judge({model({}, -100), trained(model({"inertia"}, -110), 90)}, 0.002, 0.5);
  EXPECT_EQ(against.word, "unknown") << "the held-out runs speak against it";
  EXPECT_FALSE(against.by_fitted_runs);
}

TEST(Verdict, NamesNothingThatImitatesDisplacementsAlone) {
  Evidence tilt = model({"gravity_tilt"}, -100, 38, 0.86);
  tilt.form_parameters = 2;
  tilt.error_left = 0.2;
  const Evidence nominal = model({}, -5e6, 100);
  EXPECT_EQ(judge({nominal, tilt}, 0.002, 0.002).word, "missing");
  tilt.accelerations = 0.1;
  EXPECT_EQ(judge({nominal, tilt}, 0.002, 0.002).word, "unknown");
  tilt.lack_of_fit = 1;
  EXPECT_EQ(judge({nominal, tilt}, 0.002, 0.002).word, "missing") << "what leaves noise has explained all";
}

TEST(Verdict, WhatLeavesManyTimesTheNoiseMustHaveTakenMostOfTheError) {
  // 74 sigma fell to 27.6: a strip of rougher ground, which a tilt of 17 degrees does half of.
  Evidence tilt = model({"gravity_tilt"}, -1000, 27.6, 0.82);
  tilt.error_left = 0.37;
  const Evidence nominal = model({}, -9000, 74);
  EXPECT_EQ(judge({nominal, tilt}, 0.002, 0.002).word, "unknown");
  tilt.error_left = 0.2;
  EXPECT_EQ(judge({nominal, tilt}, 0.002, 0.002).word, "missing");
  tilt.error_left = 0.37;
  tilt.lack_of_fit = 2;
  EXPECT_EQ(judge({nominal, tilt}, 0.002, 0.002).word, "missing") << "what engines and steps leave";
}

TEST(Verdict, AFlexibleEffectThatLeavesPlainlyMoreThanNoiseHasExplainedNothing) {
  const auto periodic = [](double scale, double explained) {
    Evidence e = model({"periodic_force"}, -100, scale, explained);
    e.form_parameters = 5;
    return e;
  };
  const Evidence nominal = model({}, -500, 3);
  EXPECT_EQ(judge({nominal, periodic(2, 0.9)}, 0.002, 0.002).word, "unknown");
  EXPECT_EQ(judge({nominal, periodic(2, 0.98)}, 0.002, 0.002).word, "missing");   // 1/2^5 left
  EXPECT_EQ(judge({nominal, periodic(1.2, 0.9)}, 0.002, 0.002).word, "missing");  // nearly noise
  EXPECT_EQ(judge({nominal, model({"quadratic_drag"}, -100, 2, 0.9)}, 0.002, 0.002).word, "missing");
}

TEST(Verdict, NamesThePartThatIsExplainedWhereThePairIsNot) {
  Evidence pair = model({"friction", "contact_compliance"}, -200, 4, 0.78);
  pair.form_parameters = 3;
  Evidence friction = model({"friction"}, -400, 5, 0.6);
  friction.error_left = 0.2;  // of most runs; of one body the tracker took another
  const Verdict v = judge({model({}, -1000, 8), friction, pair, model({"inertia"}, -700, 7, 0.2)}, 0.002, 0.002);
  EXPECT_EQ(v.word, "missing");
  EXPECT_EQ(v.best, 1);
  EXPECT_EQ(v.ranked.front().effects, std::vector<std::string>{"friction"});
  EXPECT_GT(probability(v, {"unknown"}), 0.2);
  expect_sums_to_one(v);
}

TEST(Verdict, AConstantThatTheSceneStatesIsWrongOnlyWhereThatIsPlainlyBetter) {
  Evidence stated = model({"friction"}, -100);
  stated.stated = 1;
  // As good as what the scene lacks: the scene is believed, and the two are no class.
  const Verdict believed = judge({model({}, -500, 3), model({"quadratic_drag"}, -100), stated}, 0.002, 0.5);
  EXPECT_EQ(believed.word, "missing");
  EXPECT_EQ(believed.best, 1);
  // Ten nats better: it is not.
  stated.held_out = -90;
  EXPECT_EQ(judge({model({}, -500, 3), model({"quadratic_drag"}, -100), stated}, 0.002, 0.5).best, 2);
  // A half of the mismatch is not enough to contradict the scene.
  stated.explained = 0.6;
  stated.lack_of_fit = 2;
  EXPECT_EQ(judge({model({}, -500, 3), stated}, 0.002, 0.002).word, "unknown");
}

TEST(Verdict, AShareJustBelowTheLimitIsNoReasonToPassOverARival) {
  // A pair fits best and explains little of it for its parameters; of two singles one explains 51 %, the other 49 %, alike on the held-out runs.
  Evidence nominal = model({}, -9000, 20), pair = model({"linear_drag", "uniform_force"}, -1900, 3, 0.6), linear = model({"linear_drag"}, -2100, 4, 0.51),
           quadratic = model({"quadratic_drag"}, -2000, 4, 0.49), buoyant = model({"buoyancy"}, -7000, 15, 0.2);
  nominal.per_run = {-3000, -3000, -3000};
  pair.per_run = {-650, -600, -650};
  linear.per_run = {-800, -600, -700};
  quadratic.per_run = {-600, -700, -700};
  buoyant.per_run = {-2300, -2400, -2300};
  pair.train_gain = 9500, linear.train_gain = 9000, quadratic.train_gain = 8900, buoyant.train_gain = 1000;
  pair.error_left = 0.15, linear.error_left = quadratic.error_left = 0.2;  // of most runs
  const Verdict v = judge({nominal, pair, linear, quadratic, buoyant}, 0.002, 0.002);
  EXPECT_EQ(v.word, "ambiguous");
  EXPECT_EQ(v.best, 2);
  ASSERT_EQ(v.indistinguishable.size(), 1u);
  EXPECT_EQ(v.indistinguishable.front(), (std::vector<std::string>{"linear_drag", "quadratic_drag"}));
}

TEST(Verdict, IsAmbiguousBetweenRivals) {
  const Verdict v = judge({model({}, -500, 3), model({"quadratic_drag"}, -100), model({"linear_drag"}, -101)}, 0.002, 0.5);
  EXPECT_EQ(v.word, "ambiguous");
  ASSERT_EQ(v.indistinguishable.size(), 1u);
  EXPECT_EQ(v.indistinguishable[0], (std::vector<std::string>{"quadratic_drag", "linear_drag"}));
  // A pair that holds the best is no rival of it.
  EXPECT_EQ(judge({model({}, -500, 3), model({"quadratic_drag"}, -100), model({"quadratic_drag", "linear_drag"}, -97)}, 0.002, 0.5).word,
            "missing");
  // One that does without it is.
  EXPECT_EQ(judge({model({}, -500, 3), model({"finite_reynolds_drag"}, -100), model({"quadratic_drag", "sensor_bias"}, -97)}, 0.002, 0.5).word,
            "ambiguous");
}

TEST(Verdict, WhatAllRivalsShareIsNotInDoubt) {
  const Verdict v = judge({model({}, -900, 5), model({"friction", "inertia"}, -100), model({"friction", "contact_compliance"}, -100.5)}, 0.002, 0.5);
  EXPECT_EQ(v.word, "ambiguous");
  ASSERT_EQ(v.indistinguishable.size(), 1u);
  EXPECT_EQ(v.indistinguishable.front(), (std::vector<std::string>{"inertia", "contact_compliance"}));
}

TEST(Verdict, ClassesHaveTheNearestThree) {
  const Verdict v = judge({model({}, -500, 3), model({"quadratic_drag"}, -100), model({"linear_drag"}, -100.3), model({"magnus"}, -100.2),
                           model({"buoyancy"}, -100.1)},
                          0.002, 0.5);
  ASSERT_EQ(v.indistinguishable.size(), 1u);
  EXPECT_EQ(v.indistinguishable[0], (std::vector<std::string>{"quadratic_drag", "buoyancy", "magnus"}));
}

Evidence over_runs(const std::vector<std::string>& effects, const std::vector<double>& per_run, double scale, double train_gain) {
  Evidence e = model(effects, 0, scale);
  for (const double one : per_run) e.held_out += one;
  e.per_run = per_run;
  e.train_gain = train_gain;
  return e;
}

TEST(Verdict, CountsRunsNotSamplesWhereTheBestLeavesMoreThanNoise) {
  // Linear drag loses by 600 nats in all, but wins two of the four runs.
  const std::vector<double> nothing = {-9000, -9000, -9000, -9000}, quadratic = {-300, -300, -300, -300}, linear = {-250, -220, -800, -530};
  const auto verdict = [&](double scale, double gain_of_linear, const std::vector<double>& of_linear) {
    return judge({over_runs({}, nothing, 20, 0), over_runs({"quadratic_drag"}, quadratic, scale, 1000),
                  over_runs({"linear_drag"}, of_linear, scale, gain_of_linear)},
                 0.002, 0.002);
  };
  const Verdict open = verdict(5, 950, linear);
  EXPECT_EQ(open.word, "ambiguous");
  EXPECT_LT(probability(open, {"quadratic_drag"}), 0.9);
  expect_sums_to_one(open);
  // Without anything systematic left, samples count.
  EXPECT_EQ(verdict(1.2, 950, linear).word, "missing");
  // Loses every run by about the same: told apart, however few the runs.
  EXPECT_EQ(verdict(5, 950, {-450, -440, -460, -455}).word, "missing");
  // A rival that hardly explains anything is none.
  EXPECT_EQ(verdict(5, 300, linear).word, "missing");
  // Nor is one that fails where it was not fitted, however much the runs scatter.
  EXPECT_EQ(verdict(5, 950, {-250, -220, -800, -30000}).word, "missing");
}

TEST(Verdict, OfMeasurementOrNumericsAlone) {
  EXPECT_EQ(judge({model({}, -500, 3), model({"length_scale"}, -100)}, 0.002, 0.5).word, "measurement");
  EXPECT_EQ(judge({model({}, -500, 3), model({"time_step"}, -100)}, 0.002, 0.5).word, "numerics");
  EXPECT_EQ(judge({model({}, -500, 3), model({"length_scale", "quadratic_drag"}, -100)}, 0.002, 0.5).word, "missing");
}

TEST(Verdict, AnEffectMoreMustEarnItsCost) {
  const Verdict dear = judge({model({}, -500, 3), model({"quadratic_drag"}, -100), model({"quadratic_drag", "magnus"}, -99)}, 0.002, 0.5);
  EXPECT_EQ(dear.best, 1);
  const Verdict earned = judge({model({}, -500, 3), model({"quadratic_drag"}, -100), model({"quadratic_drag", "magnus"}, -90)}, 0.002, 0.5);
  EXPECT_EQ(earned.best, 2);
}

TEST(Verdict, NumericsOfOtherThanTheNominalCostWhatAnEffectCosts) {
  Evidence inertia = model({"inertia"}, -99);
  inertia.solved = "engine_law";
  const Verdict dear = judge({model({}, -500, 3), model({"engine_law"}, -100), inertia}, 0.002, 0.5);
  EXPECT_EQ(dear.word, "numerics");
  EXPECT_EQ(dear.best, 1);
  const Verdict either = judge({model({}, -500, 3), model({"engine_law"}, -100), model({"time_step"}, -100), inertia}, 0.002, 0.5);
  EXPECT_EQ(either.word, "numerics");
  ASSERT_EQ(either.indistinguishable.size(), 1U);
  EXPECT_EQ(either.indistinguishable[0], (std::vector<std::string>{"engine_law", "time_step"}));
  inertia.held_out = -90;
  EXPECT_EQ(judge({model({}, -500, 3), model({"engine_law"}, -100), inertia}, 0.002, 0.5).word, "missing");
}

}  // namespace
}  // namespace repose::diagnosis
