#include <gtest/gtest.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "analysis/bundle/sensor.hpp"
#include "analysis/diagnosis/bulk_candidate.hpp"
#include "analysis/diagnosis/bulk_data.hpp"
#include "analysis/diagnosis/bulk_emulator.hpp"
#include "analysis/diagnosis/bulk_posterior.hpp"
#include "analysis/diagnosis/bulk_sampling.hpp"
#include "analysis/diagnosis/bulk_statistics.hpp"
#include "analysis/diagnosis/bulk_summary.hpp"
#include "core/error.hpp"
#include "core/random.hpp"
#include "tests/unit/stand_in_heap.hpp"

namespace repose::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows of three correlated numbers of very unlike size.
MatrixXd packings(Index rows, Random& random) {
  MatrixXd x(rows, 3);
  for (Index i = 0; i < rows; ++i) {
    const double a = normal(random), b = normal(random), c = normal(random);
    x.row(i) << 30 + a, 1e-5 * (1 + 0.1 * (0.6 * a + 0.8 * b)), 2e-4 * (1 + 0.03 * c);
  }
  return x;
}

TEST(HotellingTest, OneNumberIsStudentsTest) {
  MatrixXd a(3, 1), b(4, 1);
  a << 1, 2, 3;
  b << 2, 4, 6, 8;
  const MeanTest test = same_mean(a, b, VectorXd::Zero(1));
  const double t = 3 / std::sqrt(4.4 * (1.0 / 3 + 1.0 / 4));
  EXPECT_NEAR(test.statistic, t * t, 1e-12);
  EXPECT_NEAR(test.p, 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(5), t)), 1e-12);
}

TEST(HotellingTest, FalseAlarmsComeAtTheirRate) {
  Random random(1, 1);
  int alarms = 0;
  constexpr int trials = 4000;
  for (int i = 0; i < trials; ++i) alarms += same_mean(packings(8, random), packings(10, random), VectorXd::Zero(3)).p < 0.05;
  EXPECT_NEAR(alarms, 0.05 * trials, 4 * std::sqrt(0.05 * 0.95 * trials));
}

TEST(HotellingTest, ASingleRunIsTestedToo) {
  Random random(2, 1);
  int alarms = 0;
  constexpr int trials = 4000;
  for (int i = 0; i < trials; ++i) alarms += same_mean(packings(1, random), packings(10, random), VectorXd::Zero(3)).p < 0.05;
  EXPECT_NEAR(alarms, 0.05 * trials, 4 * std::sqrt(0.05 * 0.95 * trials));
}

TEST(HotellingTest, SeesAShiftInAnyUnit) {
  Random random(3, 1);
  MatrixXd a = packings(8, random);
  a.col(2).array() *= 1.15;  // five standard deviations of a single run
  EXPECT_LT(same_mean(a, packings(10, random), VectorXd::Zero(3)).p, 1e-3);
}

TEST(HotellingTest, NothingIsTestedWhenEveryNumberWasFitted) {
  Random random(4, 1);
  const MeanTest test = same_mean(packings(8, random), packings(10, random), VectorXd::Zero(3), 3);
  EXPECT_EQ(test.dimensions, 0);
  EXPECT_EQ(test.p, 1);
}

TEST(HotellingTest, AStatedErrorMakesItMilder) {
  MatrixXd a(1, 1), b(4, 1);
  a << 33;
  b << 22, 23, 24, 23;
  VectorXd large(1);
  large << 100;
  EXPECT_LT(same_mean(a, b, VectorXd::Zero(1)).p, 0.01);
  EXPECT_GT(same_mean(a, b, large).p, 0.1);
}

TEST(FisherTest, TwoHalvesCombine) {
  const double p[] = {0.5, 0.5};
  EXPECT_NEAR(combined_p(p), 0.25 * (1 - std::log(0.25)), 1e-12);  // chi^2 of four degrees of freedom in closed form
}

TEST(ScatterTest, PoolsAboutMeansOfTheirOwn) {
  MatrixXd a(2, 1), b(3, 1);
  a << 0, 2;
  b << 100, 101, 102;
  const MatrixXd samples[] = {a, b};
  const Scatter s = pooled_scatter(samples);
  EXPECT_EQ(s.dof, 3);
  EXPECT_NEAR(s.covariance(0, 0), 4.0 / 3, 1e-12);
}

TEST(ScatterTest, ShrinksChanceCorrelationsAndKeepsTrueOnes) {
  Random random(5, 1);
  const MatrixXd few[] = {packings(6, random)}, many[] = {packings(4000, random)};
  const auto correlation = [](const MatrixXd& c, Index i, Index j) { return c(i, j) / std::sqrt(c(i, i) * c(j, j)); };
  EXPECT_NEAR(correlation(shrunken_scatter(many).covariance, 0, 1), 0.6, 0.05);
  const MatrixXd raw = pooled_scatter(few).covariance, shrunk = shrunken_scatter(few).covariance;
  EXPECT_LT(std::abs(correlation(shrunk, 0, 2)), std::abs(correlation(raw, 0, 2)));
  EXPECT_EQ(raw.diagonal(), shrunk.diagonal());
}

TEST(NormalDensityTest, StandardNormalAtZero) {
  EXPECT_NEAR(log_normal_density(VectorXd::Zero(2), 4 * MatrixXd::Identity(2, 2)), -std::log(2 * std::numbers::pi) - std::log(4.0), 1e-12);
}

double hill(double u) { return 20 + 12 * (1 - std::exp(-u / 0.2)); }

TEST(EmulatorTest, FollowsASmoothCurveThroughFewNoisyPoints) {
  Random random(6, 1);
  constexpr Index n = 8;
  MatrixXd at(n, 1);
  VectorXd y(n);
  for (Index i = 0; i < n; ++i) {
    at(i, 0) = static_cast<double>(i) / (n - 1);
    y[i] = hill(at(i, 0)) + 0.3 * normal(random);
  }
  const Emulator emulator(at, y, VectorXd::Constant(n, 0.09));
  int within = 0;
  for (int i = 0; i <= 50; ++i) {
    const VectorXd u = VectorXd::Constant(1, 0.02 * i);
    const Emulator::Prediction p = emulator.at(u);
    EXPECT_NEAR(p.mean, hill(u[0]), 1.2);
    within += std::abs(p.mean - hill(u[0])) < 2 * std::sqrt(p.variance);
  }
  EXPECT_GE(within, 40);
}

TEST(EmulatorTest, IsLessSureFarFromItsPoints) {
  MatrixXd at(2, 1);
  at << 0.1, 0.2;
  VectorXd y(2);
  y << 1, 2;
  const Emulator emulator(at, y, VectorXd::Constant(2, 0.01));
  EXPECT_GT(emulator.at(VectorXd::Constant(1, 1.0)).variance, 5 * emulator.at(VectorXd::Constant(1, 0.15)).variance);
}

TEST(EmulatorTest, FindsTheAxisThatDoesNothing) {
  const MatrixXd at = space_filling(24, 2);
  VectorXd y(24);
  for (Index i = 0; i < 24; ++i) y[i] = hill(at(i, 0));
  const Emulator emulator(at, y, VectorXd::Constant(24, 1e-4));
  EXPECT_GT(emulator.lengths()[1], 2 * emulator.lengths()[0]);
}

// Known along both axes alone, the square between them is their sum as far as nothing says otherwise; one group would fall back to the mean there.
TEST(EmulatorTest, GroupsCarryWhatIsKnownOfEachAxisIntoTheSquare) {
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i <= 8; ++i) {
    places.emplace_back(i / 8.0, 0);
    if (i > 0) places.emplace_back(0, i / 8.0);
  }
  const auto n = static_cast<Index>(places.size());
  MatrixXd at(n, 2);
  VectorXd y(n);
  const auto f = [](const Eigen::Vector2d& u) { return 3 * u[0] + 2 * std::sin(3 * u[1]); };
  for (Index i = 0; i < n; ++i) {
    at.row(i) = places[static_cast<std::size_t>(i)].transpose();
    y[i] = f(places[static_cast<std::size_t>(i)]);
  }
  const Emulator added(at, y, VectorXd::Constant(n, 1e-4), {0, 1}), joint(at, y, VectorXd::Constant(n, 1e-4));
  double by_groups = 0, by_one = 0, deviates = 0;
  for (const double a : {0.3, 0.6, 0.9})
    for (const double b : {0.3, 0.6, 0.9}) {
      const Eigen::Vector2d u(a, b);
      const Emulator::Prediction p = added.at(u);
      by_groups += std::pow(p.mean - f(u), 2);
      by_one += std::pow(joint.at(u).mean - f(u), 2);
      deviates = std::max(deviates, std::abs(p.mean - f(u)) / std::sqrt(p.variance));
    }
  EXPECT_LT(by_groups, 0.5 * by_one);
  EXPECT_LT(deviates, 3);
  EXPECT_THROW(Emulator(at, y, VectorXd::Constant(n, 1e-4), {0}), Error);
}

TEST(EmulatorTest, RefusesWhatIsNotFinite) {
  EXPECT_THROW(Emulator(MatrixXd::Zero(1, 1), VectorXd::Constant(1, std::nan("")), VectorXd::Ones(1)), Error);
}

TEST(CoordinateTest, GoesThereAndBack) {
  const Scene scene = parse_scene(heap_scene, "scene");
  Bundle bundle;
  bundle.scene = scene;
  bundle.runs.emplace_back();
  bundle.calibrate = {"pairs.grain-wall.friction"};
  for (const BulkCandidate& c : bulk_candidates(bundle, natural_scale(realise(scene, 1)), {}, 20))
    for (const Parameter& p : c.parameters)
      for (const double u : {0.0, 0.1, 0.5, 0.9, 1.0}) EXPECT_NEAR(coordinate_of(p, value_at(p, u)), u, 1e-9) << p.key;
}

TEST(CoordinateTest, NoCohesionLiesAtTheLowerEnd) {
  Bundle bundle;
  bundle.scene = parse_scene(heap_scene, "scene");
  bundle.runs.emplace_back();
  const auto all = bulk_candidates(bundle, natural_scale(realise(bundle.scene, 1)), {"cohesion", "grain_shape"}, 8);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(null_point(all[0], VectorXd())[0], 0);
  EXPECT_NEAR(null_point(all[1], VectorXd())[0], 0.5, 1e-12);
}

TEST(CandidateTest, RefusesAnUnknownEffectAndOneThatTheSceneHas) {
  Bundle bundle;
  bundle.scene = parse_scene(heap_scene, "scene");
  bundle.runs.emplace_back();
  const NaturalScale scale = natural_scale(realise(bundle.scene, 1));
  EXPECT_THROW(bulk_candidates(bundle, scale, {"rolling_frction"}, 8), Error);
  const auto stated = bulk_candidates(bundle, scale, {"friction"}, 8);  // 0.5, which may be wrong
  ASSERT_EQ(stated.size(), 1u);
  EXPECT_NEAR(value_at(stated[0].parameters[0], null_point(stated[0], VectorXd())[0]), 0.5, 1e-12);
  bundle.calibrate = {"pairs.grain-grain.friction"};
  EXPECT_THROW(bulk_candidates(bundle, scale, {"friction"}, 8), Error);
}

TEST(CandidateTest, TheFrictionOfWallsIsTriedAsItIsStated) {
  Bundle bundle;
  bundle.scene = parse_scene(heap_scene, "scene");
  bundle.runs.emplace_back();
  const NaturalScale scale = natural_scale(realise(bundle.scene, 1));
  const auto labels = [&](const std::vector<std::string>& wanted) {
    std::vector<std::string> result;
    for (const BulkCandidate& c : bulk_candidates(bundle, scale, wanted, 8))
      if (c.hypothesis.names().front().ends_with("friction") && stated_in(c.hypothesis) > 0) result.push_back(c.hypothesis.label());
    return result;
  };
  const std::vector<std::string> walls{"wall_friction (grain-plate)", "wall_friction (grain-wall)"};
  EXPECT_EQ(labels({"wall_friction"}), walls);
  EXPECT_EQ(labels({}), (std::vector<std::string>{"friction (grain-grain)", walls[0], walls[1]}));
  bundle.calibrate = {"pairs.grain-wall.friction"};
  EXPECT_EQ(labels({"wall_friction"}), (std::vector<std::string>{walls[0]}));
  // A funnel of the grains' own material has no friction of its own.
  std::string text = heap_scene;
  text.replace(text.find("funnel: {material: wall"), 23, "funnel: {material: grain");
  bundle.scene = parse_scene(text, "scene");
  EXPECT_EQ(labels({"friction"}), (std::vector<std::string>{"friction (grain-grain)"}));
}

TEST(SummaryTest, OfAConeAndASteadyStream) {
  Observation profile;
  profile.kind = ObservableKind::profile;
  profile.name = "heap";
  for (int i = 0; i <= 1000; ++i) {
    profile.at.push_back(1e-3 * i);
    profile.value.push_back(0.5 - 0.5e-3 * i);
  }
  Observation flow;
  flow.kind = ObservableKind::series;
  flow.name = "discharged_mass";
  for (int i = 0; i <= 100; ++i) {
    flow.time.push_back(0.01 * i);
    flow.value.push_back(std::clamp(2 * (0.01 * i - 0.2), 0.0, 1.0));
  }
  const std::vector<Observation> all{profile, flow};
  const auto value = [&](const std::string& name) {
    for (const BulkSummary& s : summaries_of(all))
      if (s.name == name) return value_of(s, all);
    return std::nan("");
  };
  EXPECT_NEAR(value("heap_slope"), std::atan(0.5) * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(value("heap_volume"), std::numbers::pi / 3 * 0.5, 1e-5);
  EXPECT_NEAR(value("heap_concavity"), 0, 1e-9);
  EXPECT_NEAR(value("heap_apex"), 0.5 * (1 - 2.0 / 9), 1e-3);
  EXPECT_NEAR(value("discharge_rate"), 2, 1e-9);
  EXPECT_NEAR(value("discharge_delay"), 0.25, 1e-9);
  EXPECT_NEAR(value("poured_mass"), 1, 1e-12);
}

Observation series_of(const char* name, const char* unit, const std::vector<double>& values) {
  Observation o;
  o.kind = ObservableKind::series;
  o.name = name;
  o.unit = unit;
  o.value = values;
  for (std::size_t i = 0; i < values.size(); ++i) o.time.push_back(0.1 * static_cast<double>(i));
  return o;
}

/// The summaries of these observations by their names: values, units and phases.
struct Told {
  double value = std::nan("");
  std::string unit, phase;
};
std::map<std::string, Told> told_of(const std::vector<Observation>& all) {
  std::map<std::string, Told> result;
  for (const BulkSummary& s : summaries_of(all)) result[s.name] = {value_of(s, all), s.unit, s.phase};
  return result;
}

TEST(SummaryTest, OfTheLoadsOnARollerAndTheAngleInADrum) {
  const auto told = told_of({series_of("roller_force_x", "N", {-1, -3, std::nan(""), -2}), series_of("roller_torque", "N m", {0.5, 0.5, 0.5}), series_of("surface_angle", "deg", {30, 34})});
  ASSERT_EQ(told.size(), 6u);
  EXPECT_NEAR(told.at("roller_force_x_mean").value, -2, 1e-12);  // a gap is no zero
  EXPECT_NEAR(told.at("roller_force_x_sd").value, 1, 1e-12);
  EXPECT_EQ(told.at("roller_force_x_mean").unit, "N");
  EXPECT_EQ(told.at("roller_force_x_mean").phase, "spread");
  EXPECT_NEAR(told.at("roller_torque_mean").value, 0.5, 1e-12);
  EXPECT_NEAR(told.at("roller_torque_sd").value, 0, 1e-12);
  EXPECT_EQ(told.at("roller_torque_mean").unit, "N m");
  EXPECT_NEAR(told.at("surface_angle_mean").value, 32, 1e-12);
  EXPECT_NEAR(told.at("surface_angle_sd").value, std::sqrt(8.0), 1e-12);
  EXPECT_EQ(told.at("surface_angle_mean").phase, "flow");
  const std::vector<Observation> single{series_of("roller_force_z", "N", {1, std::nan("")})};
  EXPECT_TRUE(std::isnan(told_of(single).at("roller_force_z_mean").value));
}

TEST(SummaryTest, OfTheLoadOnABaseTheLastTenthCounts) {
  std::vector<double> grams(40, 1.0);
  grams[35] = 100;  // a grain that strikes the base
  for (const std::size_t i : {36, 37, 38, 39}) grams[i] = 2.0 + 0.1 * static_cast<double>(i);
  const auto told = told_of({series_of("mass_on_base", "g", grams)});
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NEAR(told.at("load_on_base").value, 5.75, 1e-12);
  EXPECT_EQ(told.at("load_on_base").unit, "g");
  EXPECT_NEAR(told_of({series_of("mass_on_base", "g", {1, 2, 3})}).at("load_on_base").value, 3, 1e-12);
}

TEST(SummaryTest, OfASurfaceHeightAndRoughness) {
  Observation before, after;
  before.kind = after.kind = ObservableKind::surface;
  before.name = "layer_before";
  after.name = "layer_after";
  before.value = {0, 0, 0, 0};
  after.value = {5e-5, 7e-5, std::nan(""), 9e-5};  // a place that was not seen is none of height 0
  before.at = before.at_y = after.at = after.at_y = {0, 1, 2, 3};
  const auto told = told_of({before, after});
  ASSERT_EQ(told.size(), 4u);
  EXPECT_EQ(told.at("layer_before_mean").value, 0);
  EXPECT_EQ(told.at("layer_before_sd").value, 0);
  EXPECT_NEAR(told.at("layer_after_mean").value, 7e-5, 1e-18);
  EXPECT_NEAR(told.at("layer_after_sd").value, 2e-5, 1e-18);
  EXPECT_EQ(told.at("layer_after_sd").unit, "m");
  EXPECT_EQ(told.at("layer_after_sd").phase, "spread");
}

TEST(SummaryTest, ThreeAreChosenOnePerObservableFirst) {
  const auto three = three_of(summaries_of(stand_in_pour(parse_yaml(heap_scene, "scene"), 1)));
  ASSERT_EQ(three.size(), 3u);
  EXPECT_EQ(three[0].name, "angle_of_repose");
  EXPECT_EQ(three[1].name, "discharge_rate");
  EXPECT_EQ(three[2].name, "heap_apex");
}

TEST(SamplingTest, ASimulationIsReadAtTheRecordedTimes) {
  Observation made, taken;
  made.kind = taken.kind = ObservableKind::series;
  made.name = taken.name = "discharged_mass";
  made.time = {0, 1, 2};
  made.value = {0, 10, 20};
  taken.time = {-1, 0.5, 1.25, 1.5, 3};
  taken.value = {0, 0, std::nan(""), 0, 0};
  const Observation seen = sampled_like({made}, {taken}).front();
  EXPECT_EQ(seen.time, (std::vector<double>{-1, 0.5, 1.5, 3}));
  EXPECT_EQ(seen.value, (std::vector<double>{0, 5, 15, 20}));
}

// As far as the recorded times are concerned what is kept is the whole, and a late clock finds what came before and after them.
TEST(SamplingTest, WhatIsKeptOfASimulationServesAnyClock) {
  Observation made, taken;
  made.kind = taken.kind = ObservableKind::series;
  made.name = taken.name = "discharged_mass";
  for (int i = 0; i <= 4000; ++i) {
    made.time.push_back(1e-3 * i);
    made.value.push_back(std::sin(made.time.back()));
  }
  for (int i = 0; i <= 20; ++i) {
    taken.time.push_back(1 + 0.0503 * i);
    taken.value.push_back(0);
  }
  Observation kept = thinned_like({made}, {taken}).front();
  EXPECT_LT(kept.time.size(), 100u);
  EXPECT_EQ(kept.time.back(), 4);
  EXPECT_EQ(sampled_like({kept}, {taken}).front().value, sampled_like({made}, {taken}).front().value);
  for (double& t : kept.time) t -= 0.5;
  const Observation late = sampled_like({kept}, {taken}).front();
  EXPECT_NEAR(late.value.back(), std::sin(taken.time.back() + 0.5), 1e-3);
}

TEST(SamplingTest, AProfileIsReadAtTheRecordedPlaces) {
  Observation made, taken;
  made.kind = taken.kind = ObservableKind::profile;
  made.name = taken.name = "heap";
  made.at = {0.1, 0.3, 0.5};
  made.value = {5, 3, 1};
  taken.at = {0.6, -0.2, 0, 0.4, 0.61, 0.3};
  taken.value = {0, 0, 0, 0, 0, std::nan("")};
  const Observation seen = sampled_like({made}, {taken}).front();
  EXPECT_EQ(seen.at, (std::vector<double>{0, 0.2, 0.4, 0.6, 0.61}));
  const std::vector<double> expected{5, 4, 2, 0, 0};  // level at the axis; the line goes on to the end of the last ring
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(seen.value[i], expected[i], 1e-12) << i;
}

TEST(BulkDataTest, RunsOfOneSettingAreUsedAsLongAsTheShortestLasts) {
  Bundle bundle;
  for (const double end : {2.0, 4.0, 3.0, 1.0}) {
    Observation o;
    o.kind = ObservableKind::series;
    o.name = "discharged_mass";
    for (int i = 0; 0.1 * i <= end + 1e-9; ++i) {
      o.time.push_back(0.1 * i);
      o.value.push_back(0.1 * i);
    }
    o.value.back() = NAN;  // the last value is a sample earlier
    BundleRun run;
    run.id = std::to_string(static_cast<int>(end)) + "-s";
    run.observations = {o};
    bundle.runs.push_back(run);
  }
  bundle.runs.back().set = {{"tools.funnel.outlet", "0.02"}};
  std::vector<std::string> notes;
  const Bundle equal = of_equal_length(bundle, notes);
  const BulkSummary poured{"poured_mass", "discharged_mass", "flow", "kg"};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(value_of(poured, equal.runs[i].observations), 1.9, 1e-9) << i;
  EXPECT_NEAR(value_of(poured, equal.runs[3].observations), 0.9, 1e-9) << "a setting of its own";
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("of 4-s, 3-s is cut at 1.9 s, where that of 2-s ends"), std::string::npos) << notes[0];
  notes.clear();
  bundle.runs.resize(1);
  EXPECT_EQ(of_equal_length(bundle, notes).runs[0].observations[0].time.size(), 20u) << "of 21, the last without a value";
  EXPECT_TRUE(notes.empty());
}

// A held-out run may lie where the fitted ones leave no weight that a double could hold.
TEST(PosteriorTest, AFarHeldOutRunIsUnlikelyAndNotImpossible) {
  BulkData data;
  data.summaries = {{"a", "a", "heap", "1"}};
  data.extra = VectorXd::Zero(1);
  BulkSetting setting;
  setting.train = MatrixXd::Constant(8, 1, 0.1);
  setting.held = MatrixXd::Constant(1, 1, 0.9);
  data.settings = {setting};
  const Predict line = [](const VectorXd& u) { return BulkPrediction{{u}, {VectorXd::Zero(1)}}; };
  const BulkPosterior p = posterior_of(data, line, MatrixXd::Constant(1, 1, 1e-5), 1);
  ASSERT_EQ(p.held_of_run.size(), 1u);
  EXPECT_TRUE(std::isfinite(p.held_of_run.front()));
  EXPECT_LT(p.held_of_run.front(), -1000);
}

TEST(PosteriorTest, OfALineIsNormal) {
  BulkData data;
  data.summaries.resize(1);
  data.extra = VectorXd::Zero(1);
  data.settings.resize(1);
  data.settings[0].train = MatrixXd(4, 1);
  data.settings[0].train << 4.9, 5.1, 5.3, 4.7;
  data.settings[0].held = MatrixXd(0, 1);
  const Predict line = [](const VectorXd& u) { return BulkPrediction{{VectorXd::Constant(1, 10 * u[0])}, {VectorXd::Zero(1)}}; };
  const BulkPosterior p = posterior_of(data, line, MatrixXd::Constant(1, 1, 0.64), 1);
  EXPECT_NEAR(p.best[0], 0.5, 0.002);
  EXPECT_NEAR(p.sd(0), 0.04, 0.001);
  EXPECT_NEAR(p.quantile(0, 0.95) - p.quantile(0, 0.05), 2 * 1.645 * 0.04, 0.005);
}

}  // namespace
}  // namespace repose::diagnosis
