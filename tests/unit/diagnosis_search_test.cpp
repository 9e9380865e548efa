#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

#include "analysis/diagnosis/search.hpp"
#include "analysis/diagnosis/shape.hpp"
#include "core/error.hpp"
#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

Fit nominal_fit(const Problem& problem) { return minimise(problem, start_of(problem, problem.layout({}), all(problem.bundle())), {}); }

Term term(const std::string& name) { return {find_effect(name), ""}; }

TEST(Nuisance, TakesOutWhatStartValuesImitate) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  const Nuisance nuisance(problem, fit);
  Eigen::MatrixXd line = Eigen::MatrixXd::Zero(nuisance.size(), 1);
  const Channel& x = problem.runs()[1].channels[0];
  for (std::size_t i = 0; i < x.time.size(); ++i) line(nuisance.first()[1] + x.first + static_cast<Eigen::Index>(i), 0) = x.time[i];
  EXPECT_EQ(nuisance.left_of(line).cols(), 0);
  const Eigen::MatrixXd bent = line.array().square().matrix();
  const Eigen::MatrixXd left = nuisance.left_of(bent);
  ASSERT_EQ(left.cols(), 1);
  EXPECT_NEAR(left.norm(), 1, 1e-9);
  EXPECT_NEAR(left.col(0).dot(line.col(0)) / line.norm(), 0, 1e-6);
}

// What is left of two columns that do nearly the same is the error of their differences, which holds the noise of the recording.
TEST(Nuisance, TakesNoWitnessFromWhatTwoColumnsHaveInCommon) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  const Nuisance nuisance(problem, fit);
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(nuisance.size(), 2);
  const Channel& x = problem.runs()[1].channels[0];
  for (std::size_t i = 0; i < x.time.size(); ++i) both(nuisance.first()[1] + x.first + static_cast<Eigen::Index>(i), 0) = x.time[i] * x.time[i];
  const Eigen::VectorXd noise = nuisance.residual().normalized() * both.col(0).norm();
  both.col(1) = -2 * both.col(0) + 1e-3 * noise;
  EXPECT_EQ(nuisance.left_of(both).cols(), 1);
  both.col(1) += noise;
  EXPECT_EQ(nuisance.left_of(both).cols(), 2);
}

TEST(Screening, BeginsWhereTheDataSayEvenIfRunsWereFollowedFromElsewhere) {
  const Bundle bundle = flights({.velocities = {{3, 0, 2}, {2, 1, 2}, {4, -1, 2}, {1, 2, 2}}, .truth = "{uniform_force: {force: [0.01, 0, 0]}}"});
  // A world that bends away from those who start elsewhere, as a ball does that misses what it should hit.
  Problem problem(bundle, all(bundle), [](const SimulationRequest& request) {
    History history = fly(request);
    const double off = request.scene->bodies[0].velocity.z() - 2;
    for (std::size_t i = 0; i < history.time.size(); ++i) history.bodies["ball"].position[i].z() += 10 * off * off * std::max(0.0, history.time[i] - 0.3);
    return history;
  });
  // As if the nominal had led its start values astray.
  for (std::size_t run = 0; run < problem.runs().size(); ++run) {
    Values astray(3);
    for (Eigen::Index i = 0; i < 3; ++i) astray[i] = problem.runs()[run].start[static_cast<std::size_t>(i)].start + 1;
    problem.follow(run, astray, Eigen::MatrixXd::Zero(3, 1));
  }
  const Fit fit = start_of(problem, problem.layout({}), all(bundle));
  ASSERT_GT(fit.per_dof(), 1000);
  const Screened s = screen(problem, fit, Nuisance(problem, fit), term("uniform_force"), 10);
  EXPECT_TRUE(s.from_data);
  EXPECT_NEAR(s.shared_start[0], 0.01, 0.01);
}

TEST(Screening, GainIsThatOfLeastSquares) {
  const Bundle bundle = flights({.truth = "{uniform_force: {force: [0.0008, 0, 0]}}"});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  const Nuisance nuisance(problem, fit);
  const Screened s = screen(problem, fit, nuisance, term("uniform_force"), 10);
  // A force along x alone beside start values: chi^2 before and after, by a fit whose other components are held.
  Fit start = start_of(problem, problem.layout({{term("uniform_force")}}), fit.runs);
  double gain = 0;
  for (const Probe& probe : s.probes) gain = std::max(gain, gain_of(probe, nuisance.residual()));
  Eigen::MatrixXd columns(nuisance.size(), 1);
  for (std::size_t i = 0; i < fit.runs.size(); ++i)
    columns.col(0).segment(nuisance.first()[i], nuisance.size(i)) = jacobian(problem, start, i).shared.col(0);
  // Columns of start values and this one, directly.
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(nuisance.size(), 13);
  a.col(12) = columns.col(0);
  for (std::size_t i = 0; i < fit.runs.size(); ++i)
    a.block(nuisance.first()[i], static_cast<Eigen::Index>(3 * i), nuisance.size(i), 3) = jacobian(problem, fit, i).own;
  const Eigen::VectorXd x = a.colPivHouseholderQr().solve(-nuisance.residual());
  const double direct = nuisance.residual().squaredNorm() - (nuisance.residual() + a * x).squaredNorm();
  EXPECT_GT(direct, 100);
  EXPECT_NEAR(gain, direct, 0.01 * direct);
}

TEST(Screening, PutsTheEffectThatActsFirst) {
  const Bundle bundle = flights({.truth = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}"});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  const Nuisance nuisance(problem, fit);
  const double drag = screen(problem, fit, nuisance, term("quadratic_drag"), 10).reached;
  for (const char* other : {"uniform_force", "gravity_tilt", "buoyancy", "length_scale", "frame_tilt"})
    EXPECT_LT(drag, screen(problem, fit, nuisance, term(other), 10).reached) << other;
}

TEST(Screening, AnEffectThatDoesNothingHasNoProbe) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  const Nuisance nuisance(problem, fit);
  EXPECT_TRUE(screen(problem, fit, nuisance, {find_effect("rolling_friction"), "foam-stone"}, 10).probes.empty());
  EXPECT_TRUE(screen(problem, fit, nuisance, term("sensor_bias"), 10).probes.empty()) << "no series, no sensor to be wrong";
}

TEST(Screening, ASensorThatTheFirstRunLacksIsLookedAt) {
  Bundle bundle = flights({.noise = 1e-4});
  bundle.noise = {{"position", 1e-4}, {"height", 1e-4}};
  for (std::size_t k = 1; k < bundle.runs.size(); ++k) {
    Observation& o = bundle.runs[k].observations[0];
    o.kind = ObservableKind::series;
    o.name = "height";
    o.unit.assign(1, 'm');  // GCC 12 warns of "m"
    for (const Vec3& x : o.position) o.value.push_back(x.z() + 0.02);
    o.position.clear();
    bundle.runs[k].free.clear();
  }
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  const Nuisance nuisance(problem, fit);
  const Screened bias = screen(problem, fit, nuisance, term("sensor_bias"), 10);
  ASSERT_EQ(bias.probes.size(), 1u);
  EXPECT_EQ(bias.probes[0].basis.cols(), 3);
  EXPECT_LT(bias.reached, 0.01 * fit.chi2);
}

TEST(Screening, SeesTheOriginOfPositionsUnlessEachRunHasItsOwn) {
  Bundle bundle = flights({});
  const Term origin{find_effect("sensor_bias"), "position"};
  for (BundleRun& run : bundle.runs)
    for (Vec3& x : run.observations[0].position) x += Vec3(0.02, 0, -0.01);
  {
    const Problem problem(bundle, all(bundle), fly);
    const Fit fit = nominal_fit(problem);
    EXPECT_LT(screen(problem, fit, Nuisance(problem, fit), origin, 10).reached, 0.05 * fit.chi2);
  }
  for (BundleRun& run : bundle.runs) run.free.push_back("bodies.ball.position");
  const Problem problem(bundle, all(bundle), fly);
  const Fit fit = nominal_fit(problem);
  EXPECT_TRUE(screen(problem, fit, Nuisance(problem, fit), origin, 10).probes.empty()) << "in free flight one place is like another";
}

TEST(Hypothesis, OffersABiasForEachKindOfSensor) {
  Bundle bundle = flights({});
  const auto places = [&] {
    std::vector<std::string> found;
    for (const Term& t : possible_terms(bundle, natural_scale(realise(bundle.scene, 1))))
      if (t.row->name == "sensor_bias") found.push_back(t.place);
    return found;
  };
  EXPECT_EQ(places(), std::vector<std::string>{"position"});
  Observation height = bundle.runs[0].observations[0];
  height.kind = ObservableKind::series;
  height.name = "height";
  bundle.runs[0].observations.push_back(height);
  EXPECT_EQ(places(), (std::vector<std::string>{"", "position"}));
  for (BundleRun& run : bundle.runs) run.observations = {height};
  EXPECT_EQ(places(), std::vector<std::string>{""});
}

TEST(Hypothesis, FreesWhatTheSceneStates) {
  Bundle bundle = flights({.nominal = "{quadratic_drag: {coefficient: 0.3, fluid_density: 1}, gravity_tilt: {x_deg: 2}}"});
  const NaturalScale scale = natural_scale(realise(bundle.scene, 1));
  const auto labels = [&] {
    std::vector<std::string> names;
    for (const Term& t : stated_terms(bundle, scale)) names.push_back(Hypothesis{{t}}.label());
    return names;
  };
  EXPECT_EQ(labels(), (std::vector<std::string>{"quadratic_drag", "gravity_tilt", "friction (foam-stone)"}));
  const std::vector<Parameter> tilt = parameters_of(stated_terms(bundle, scale)[1], scale, {}).shared;
  ASSERT_EQ(tilt.size(), 2u);
  EXPECT_EQ(tilt[0].null, 2);
  EXPECT_EQ(tilt[0].start, 2);
  EXPECT_EQ(tilt[1].null, 0);
  // What is calibrated is free already; what a run sets has no one value.
  bundle.calibrate = {"effects.quadratic_drag.coefficient"};
  bundle.runs[0].set.push_back({"pairs.foam-stone", "{friction: 0.4}"});
  EXPECT_EQ(labels(), std::vector<std::string>{"gravity_tilt"});
}

TEST(Screening, SurvivesPointsThatCannotBeSimulated) {
  const Bundle bundle = flights({.truth = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}"});
  const Problem problem(bundle, all(bundle), [](const SimulationRequest& request) {
    for (const Effect& e : request.scene->effects)
      if (const auto* drag = std::get_if<QuadraticDrag>(&e); drag != nullptr && drag->coefficient > 2) throw Error("", "exploded", "", Error::Kind::simulation);
    return fly(request);
  });
  const Fit fit = nominal_fit(problem);
  const Nuisance nuisance(problem, fit);
  const Screened s = screen(problem, fit, nuisance, term("quadratic_drag"), 10);
  ASSERT_EQ(s.shared_start.size(), 1u);
  EXPECT_GT(s.shared_start[0], 0.1);
  EXPECT_LT(s.shared_start[0], 2);
}

TEST(Probe, OneSidedCountsOnlyAgainstTheDirection) {
  Eigen::VectorXd r(2);
  r << 3, 4;
  EXPECT_DOUBLE_EQ(gain_of({Eigen::MatrixXd::Identity(2, 2), false}, r), 25);
  EXPECT_DOUBLE_EQ(gain_of({Eigen::MatrixXd::Identity(2, 1), true}, r), 0);
  EXPECT_DOUBLE_EQ(gain_of({-Eigen::MatrixXd::Identity(2, 1), true}, r), 9);
  EXPECT_DOUBLE_EQ(gain_of({Eigen::MatrixXd(2, 0), true}, r), 0);
}

TEST(Probe, DeviatesOfDifferentDimensionsAreAlike) {
  // 99 % quantiles of chi^2 with 1, 3 and 10 degrees of freedom.
  for (const auto& [gain, k] : {std::pair{6.635, 1}, {11.345, 3}, {23.209, 10}}) EXPECT_NEAR(deviate(gain, k), 2.326, 0.06) << k;
  // Strengths: one in a hundred is one in a hundred, and far out in the tail the order of chances is kept where that of deviates is not.
  for (const auto& [gain, k] : {std::pair{6.635, 1}, {11.345, 3}, {23.209, 10}}) EXPECT_NEAR(strength(gain, k), std::sqrt(2 * std::log(100)), 1e-3) << k;
  for (const Eigen::Index k : {1, 3, 10}) EXPECT_NEAR(strength(200.001, k), strength(199.999, k), 0.02) << k;
  EXPECT_GT(strength(1300, 1), strength(1000, 3));
  EXPECT_GT(strength(1e6, 1), strength(1e6, 3));
  EXPECT_EQ(strength(0, 3), 0);
}

TEST(Probe, ShareOfNoiseThatReachesChi2) {
  // Quantiles from tables.
  for (const auto& [chi2, degrees, p] : {std::tuple{3.841, 1, 0.05}, {15.987, 10, 0.10}, {135.807, 100, 0.01}}) EXPECT_NEAR(p_of_chi2(chi2, degrees), p, 1e-4) << degrees;
}

/// Normal noise, or Student's t with 4 degrees of freedom, of variance 1.
Eigen::VectorXd noise_of(Random& random, Eigen::Index size, bool outliers) {
  Eigen::VectorXd e(size);
  for (double& x : e) {
    double scale = 1;
    if (outliers) {
      double chi2 = 0;
      for (int k = 0; k < 4; ++k) chi2 += std::pow(normal(random), 2);
      scale = std::sqrt(2 / chi2);
    }
    x = scale * normal(random);
  }
  return e;
}

/// Kolmogorov's distance of p values from uniform ones, of 400 recordings of `size` samples with a dozen probes, and the share at or below 1 %.
std::pair<double, double> p_values(bool outliers, bool narrow) {
  constexpr Eigen::Index size = 240;
  std::vector<Probe> probes;
  Random random(5, 1);
  for (int i = 0; i < 12; ++i) {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size, i % 4 + 1);
    for (double& x : (narrow ? columns.middleRows(20 * i, 6) : columns.middleRows(0, size)).reshaped()) x = normal(random);
    probes.push_back({Eigen::MatrixXd(columns.householderQr().householderQ() * Eigen::MatrixXd::Identity(size, columns.cols())), i % 4 == 0});
  }
  std::vector<double> p;
  for (int n = 0; n < 400; ++n) {
    const Eigen::VectorXd e = noise_of(random, size, outliers);
    double largest = -INFINITY;
    for (const Probe& probe : probes) largest = std::max(largest, deviate(gain_of(probe, e), probe.basis.cols()));
    p.push_back(null_of(probes, e, 499, static_cast<std::uint64_t>(n)).p(largest));
  }
  std::sort(p.begin(), p.end());
  double distance = 0;
  for (std::size_t i = 0; i < p.size(); ++i) distance = std::max(distance, std::abs(p[i] - (static_cast<double>(i) + 0.5) / static_cast<double>(p.size())));
  return {distance, static_cast<double>(std::upper_bound(p.begin(), p.end(), 0.01) - p.begin()) / static_cast<double>(p.size())};
}

TEST(Null, PValuesOfPureNoiseAreUniform) {
  // Kolmogorov's 0.1 % limit is 1.95 / 400^(1/2); an rms above 1 counts as noise that is stated too small, which moves the middle of the p values up.
  EXPECT_LT(p_values(false, false).first, 0.15);
  EXPECT_LE(p_values(false, false).second, 0.0275) << "0.1 % limit of a share of 1 % of 400";
}

TEST(Null, OutliersOfASensorAreNoMismatch) {
  // Of normal draws one in eight such recordings would be called a mismatch at 1 %.
  EXPECT_LE(p_values(true, true).second, 0.0275);
}

TEST(Null, PIsNeverBelowOneOverTheDrawsPlusOne) {
  NullDistribution null;
  null.largest = {1, 2, 3};
  EXPECT_DOUBLE_EQ(null.p(100), 0.25);
  EXPECT_DOUBLE_EQ(null.p(2.5), 0.5);
  EXPECT_DOUBLE_EQ(null.p(-1), 1);
}

TEST(Phases, AreToldByContactSpeedAndSlip) {
  History h;
  h.gravity = {0, 0, -9.81};
  BodyTrack track;
  const auto add = [&](const Vec3& velocity, const Vec3& spin, double normal, double slip, double approach) {
    h.time.push_back(0.001 * static_cast<double>(h.time.size()));
    track.position.emplace_back(0, 0, 0);
    track.velocity.push_back(velocity);
    track.spin.push_back(spin);
    track.normal_force.push_back(normal);
    track.slip_speed.push_back(slip);
    track.approach.push_back(approach);
  };
  add({1, 0, 0}, {0, 0, 0}, 0, 0, 0);
  add({1, 0, -1}, {0, 0, 0}, 0, 0, 0);
  add({1, 0, 0}, {0, 0, 0}, 100, 1, 1);
  add({1, 0, 0}, {0, 0, 0}, 1, 0.8, 0);
  add({1, 0, 0}, {0, 50, 0}, 1, 0.001, 0);
  add({0, 0, 0}, {0, 0, 0}, 1, 0, 0);
  add({1, 0, 0}, {0, 0, 0}, 1, 0.001, 0);  // on a belt
  const std::vector<Phase> expected{Phase::flight, Phase::flight, Phase::impact, Phase::sliding, Phase::rolling, Phase::rest, Phase::rest};
  EXPECT_EQ(phases_of(h, track, 0.02), expected);
}

TEST(Segments, PartAPathAtPhasesAndIntoPiecesThatCoverIt) {
  const Bundle bundle = flights({});
  SimulationRequest request;
  request.scene = &bundle.scene;
  request.until = 0.6;
  History h = fly(request);
  for (std::size_t i = 30; i < 45; ++i) h.bodies["ball"].normal_force[i] = 1, h.bodies["ball"].slip_speed[i] = 1;
  const std::vector<Segment> segments = segments_of(h, "ball", 0.6, 4);
  EXPECT_GE(segments.size(), 4u);
  EXPECT_EQ(segments.front().from, 0);
  EXPECT_NEAR(segments.back().to, 0.6, 1e-9);
  for (std::size_t i = 1; i < segments.size(); ++i) EXPECT_EQ(segments[i].from, segments[i - 1].to);
  for (const Segment& s : segments) EXPECT_EQ(s.phase, s.from > 0.295 && s.to < 0.455 ? Phase::sliding : Phase::flight) << s.from;
}

TEST(Segments, JoinedHaveTheMeansOverTheirTime) {
  Segment a{"ball", Phase::flight, 0, 0.1}, b{"ball", Phase::flight, 0.1, 0.4};
  a.speed = 1, b.speed = 2;
  a.velocity = Vec3(1, 0, 0), b.velocity = Vec3(0, 2, 0);
  const Segment both = joined(a, b);
  EXPECT_EQ(both.from, 0);
  EXPECT_EQ(both.to, 0.4);
  EXPECT_NEAR(both.speed, 1.75, 1e-12);
  EXPECT_NEAR((both.velocity - Vec3(0.25, 1.5, 0)).norm(), 0, 1e-12);
}

TEST(Shape, NamesTheVariableAndItsPower) {
  std::vector<Located> located;
  Random random(1, 1);
  for (std::size_t run = 0; run < 3; ++run)
    for (int i = 0; i < 6; ++i) {
      Located l;
      l.run = run;
      const double speed = 1 + static_cast<double>((i * 7 + static_cast<int>(run) * 5) % 11);
      l.segment.velocity = speed * random.rotation()._transformVector(Vec3::UnitX());
      l.segment.speed = speed;
      l.segment.height = random.uniform();
      l.segment.time = 0.1 * i;
      l.force = -0.02 * speed * l.segment.velocity;
      l.force_se = Vec3::Constant(0.01);
      located.push_back(l);
    }
  const std::vector<Dependence> found = dependence_of(located);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().variable, "speed");
  EXPECT_EQ(found.front().curve, "quadratic");
  EXPECT_GT(found.front().explained, 0.95);
  for (Located& l : located) l.force = -0.02 * l.segment.velocity;
  EXPECT_EQ(dependence_of(located).front().curve, "linear");
  EXPECT_TRUE(dependence_of({located[0], located[1], located[2]}).empty());
}

TEST(Pairs, ThatCancelAreFoundThoughNeitherHelpsAlone) {
  // Two directions that almost cancel: their difference is what the residuals show.
  constexpr Eigen::Index size = 50;
  Eigen::VectorXd a = Eigen::VectorXd::Zero(size), b = a;
  a[0] = 1;
  b[0] = -std::cos(0.1);
  b[1] = std::sin(0.1);
  Screened first, second, other;
  first.term = term("linear_drag");
  second.term = term("buoyancy");
  other.term = term("magnus");
  first.probes = {{a, true}};
  second.probes = {{b, true}};
  other.probes = {{Eigen::VectorXd::Unit(size, 5), true}};
  const Eigen::VectorXd r = -(40 * a + 40 * b);
  EXPECT_LT(gain_of(first.probes[0], r), 1);
  const std::vector<ScreenedPair> pairs = screen_pairs({first, other, second}, r, 10);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].first, 0u);
  EXPECT_EQ(pairs[0].second, 2u);
  EXPECT_NEAR(pairs[0].gain, r.squaredNorm(), 1e-9);
}

}  // namespace
}  // namespace repose::diagnosis
