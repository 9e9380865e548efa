#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "analysis/bundle/sensor.hpp"
#include "analysis/diagnosis/observation_model.hpp"
#include "analysis/diagnosis/recorded_noise.hpp"
#include "core/random.hpp"
#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

std::vector<double> with_noise(std::size_t n, double sd, double phi, std::uint64_t seed) {
  Random random(seed, 1);
  std::vector<double> x;
  double e = normal(random);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n);
    x.push_back(2 * t - 4.9 * t * t + sd * e);
    e = phi * e + std::sqrt(1 - phi * phi) * normal(random);
  }
  return x;
}

TEST(Noise, IsFoundOnASmoothSignal) {
  const NoiseModel noise = noise_model(with_noise(2000, 1e-3, 0, 1));
  EXPECT_NEAR(noise.sd, 1e-3, 8e-5);
  EXPECT_EQ(noise.phi, 0);
}

TEST(Noise, FindsTheCorrelationInTime) {
  const NoiseModel noise = noise_model(with_noise(20000, 1e-3, 0.6, 2));
  EXPECT_NEAR(noise.phi, 0.6, 0.06);
  EXPECT_NEAR(noise.sd, 1e-3, 1e-4);
}

TEST(Noise, AKnownScatterTellsTheCorrelation) {
  // Few samples: the ratio of two strides would leave it open between 0.3 and 0.95.
  for (const double phi : {0.4, 0.6, 0.8}) EXPECT_NEAR(correlation_for(with_noise(900, 1e-3, phi, 5), 1e-3), phi, 0.1) << phi;
  EXPECT_EQ(correlation_for(with_noise(900, 1e-3, 0, 6), 1e-3), 0);
  EXPECT_EQ(correlation_for(with_noise(900, 1e-3, 0.6, 6), 0.5e-3), 0) << "more scatter than was given is no correlation";
}

TEST(Noise, ForgetsKinks) {
  std::vector<double> x = with_noise(1000, 1e-3, 0, 3);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += std::abs(static_cast<double>(i % 200) - 100) * 0.05;  // ten impacts
  EXPECT_NEAR(noise_model(x).sd, 1e-3, 1.5e-4);
}

TEST(Noise, HeavyTailsCountInFull) {
  // Student's t with four degrees of freedom, of unit variance; the median of differences alone gives 0.86.
  Random random(7, 1);
  std::vector<double> x;
  for (int i = 0; i < 20000; ++i) {
    const double chi2 = -2 * std::log(random.uniform() * random.uniform());
    x.push_back(normal(random) / std::sqrt(chi2 / 4) / std::sqrt(2));
  }
  EXPECT_NEAR(noise_model(x).sd, 1, 0.06);
}

TEST(Noise, AWeakCorrelationIsFoundInAsManySamplesAsARecordingHas) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) found += noise_model(with_noise(1700, 1e-3, 0.25, 100 + seed)).phi > 0.1;
  EXPECT_GE(found, 18);
}

TEST(Noise, MissingSamplesAreLeftOut) {
  for (const std::size_t every : {17, 2}) {
    std::vector<double> x = with_noise(1000, 1e-3, 0, 4);
    for (std::size_t i = 0; i < x.size(); i += every) x[i] = NAN;
    EXPECT_NEAR(noise_model(x).sd, 1e-3, 1.2e-4) << every;
    EXPECT_LT(noise_model(x).phi, 0.15) << every;
  }
  TimedSamples apart{{0, 1, 2, NAN, 0, 1, 2}, {0, 0, 0, NAN, 9, 9, 9}};
  for (int i = 0; i < 5; ++i) {
    apart.time.insert(apart.time.end(), {NAN, 0, 1, 2});
    apart.value.insert(apart.value.end(), {NAN, 9. * i, 0, 1});
  }
  EXPECT_EQ(noise_from_differences(apart), 0) << "no record has four samples";
}

/// 4 m/s, falling, seen about every 10 ms; each time off by up to `jitter` [s].
TimedSamples thrown(std::size_t n, double sd, double jitter, std::uint64_t seed) {
  Random random(seed, 2);
  TimedSamples x;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 0.01 * static_cast<double>(i) + jitter * (2 * random.uniform() - 1);
    x.time.push_back(t);
    x.value.push_back(4 * t - 4.905 * t * t + sd * normal(random));
  }
  return x;
}

TEST(Noise, UnevenTimesAreNoNoise) {
  EXPECT_LT(noise_from_differences(thrown(200, 0, 4e-3, 1)), 1e-12) << "a parabola has no third differences";
  const NoiseModel noise = noise_model(thrown(1000, 1e-3, 4e-3, 2));
  EXPECT_NEAR(noise.sd, 1e-3, 1e-4);
  EXPECT_EQ(noise.phi, 0);
}

TEST(Noise, CorrelatedNoiseAtUnevenTimesHasItsScatterAndCorrelation) {
  Random random(4, 2);
  TimedSamples x;
  double e = normal(random), before = 0;
  for (int i = 0; i < 20000; ++i) {
    const double t = i + 0.4 * (2 * random.uniform() - 1), phi = std::pow(0.4, t - before);
    if (i > 0) e = phi * e + std::sqrt(1 - phi * phi) * normal(random);
    before = t;
    x.time.push_back(t);
    x.value.push_back(e);
  }
  const NoiseModel noise = noise_model(x);
  EXPECT_NEAR(noise.sd, 1, 0.1);
  EXPECT_NEAR(noise.phi, 0.4, 0.06);
  EXPECT_NEAR(correlation_for(x, 1), 0.4, 0.03);
}

TEST(Noise, AtEqualTimesIsThatOfPlainDifferences) {
  const TimedSamples x = thrown(400, 1e-3, 0, 3);
  EXPECT_EQ(noise_from_differences(x), noise_from_differences(x.value));
  EXPECT_EQ(noise_from_differences(x, 2), noise_from_differences(x.value, 2));
}

TEST(Noise, ExactOrShortSignalsHaveNone) {
  EXPECT_EQ(noise_model(std::vector<double>(100, 3.0)).sd, 0);
  EXPECT_EQ(noise_model(std::vector<double>{1, 2, 3, 4, 5}).sd, 0);
  EXPECT_EQ(noise_model({}).sd, 0);
}

TEST(Noise, OfABundleIsTheGivenOneOrThatOfAllRunsAndAxes) {
  Bundle bundle = flights({.noise = 2e-3, .rate = 400});
  EXPECT_NEAR(recorded_noise(bundle, {0, 1, 2, 3}).at("position").sd, 2e-3, 3e-4);
  bundle.noise["position"] = 5e-3;
  EXPECT_EQ(recorded_noise(bundle, {0, 1, 2, 3}).at("position").sd, 5e-3);
}

TEST(Noise, OfABundleWithUnevenTimesOrEmptyRowsIsThatOfTheSensor) {
  const Flights f{.noise = 2e-3, .rate = 400};
  Bundle holes = flights(f), jitter = flights({.noise = 0, .rate = 400});
  Random random(3, 1);
  for (std::size_t run = 0; run < holes.runs.size(); ++run) {
    std::vector<Vec3>& position = holes.runs[run].observations[0].position;
    for (std::size_t i = 1; i < position.size(); i += 2) position[i].setConstant(NAN);
    Observation& o = jitter.runs[run].observations[0];
    for (double& t : o.time) t += 0.4 / f.rate * (2 * random.uniform() - 1);
    const Vec3 v = f.velocities[run];
    for (std::size_t i = 0; i < o.time.size(); ++i) {
      const double t = o.time[i];
      o.position[i] = v * t - Vec3(0, 0, 4.905 * t * t) + f.noise * Vec3(normal(random), normal(random), normal(random));
    }
  }
  EXPECT_NEAR(recorded_noise(holes, {0, 1, 2, 3}).at("position").sd, f.noise, 2e-4);
  EXPECT_NEAR(recorded_noise(jitter, {0, 1, 2, 3}).at("position").sd, f.noise, 2e-4);
}

TEST(Noise, OfABundleIsNeverBelowTheResolution) {
  const Bundle exact = flights({.noise = 0});
  // The largest range of an axis over the runs, 4 m/s for 0.6 s, of which a ten-thousandth counts.
  EXPECT_NEAR(recorded_noise(exact, {0, 1, 2, 3}).at("position").sd, 1e-4 * 2.4, 1e-6);
}

TEST(Noise, OfABallThatSpinsFastIsNotTakenForCorrelated) {
  Bundle bundle = flights({});
  Random random(7, 1);
  for (BundleRun& run : bundle.runs) {
    Observation& o = run.observations.front();
    o.time.clear();
    o.position.clear();
    for (int i = 0; i < 200; ++i) {
      const double t = 0.01 * i;
      const Vec3 noise(normal(random), normal(random), normal(random));
      o.time.push_back(t);
      o.position.push_back(Vec3::Constant(NAN));
      o.orientation.push_back(rotation_of(3e-3 * noise) * Quat(Eigen::AngleAxisd(50 * t, Vec3(1, 0.2, 0).normalized())));
    }
  }
  const NoiseModel noise = recorded_noise(bundle, {0, 1, 2, 3}).at("orientation");
  EXPECT_NEAR(noise.sd, 3e-3, 5e-4);
  EXPECT_LT(noise.phi, 0.1);
}

TEST(Whitening, MakesCorrelatedNoiseIndependentOfUnitVariance) {
  const double phi = 0.7;
  std::vector<double> x = with_noise(20000, 1, phi, 5);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(x.size());
    x[i] -= 2 * t - 4.9 * t * t;
  }
  EXPECT_NEAR(neighbour_correlation(x), phi, 0.03);
  Eigen::VectorXd w = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  std::vector<double> even(x.size());
  std::iota(even.begin(), even.end(), 0.0);
  whiten(w, phi, even);
  EXPECT_NEAR(w.squaredNorm() / static_cast<double>(w.size()), 1, 0.04);
  EXPECT_LT(neighbour_correlation(std::vector<double>(w.begin(), w.end())), 0.03);
}

TEST(Whitening, KeepsTheFirstSample) {
  Eigen::VectorXd x(2);
  x << 3, 5;
  whiten(x, 0.6, std::vector<double>{0, 0.1});
  EXPECT_DOUBLE_EQ(x[0], 3);
  EXPECT_DOUBLE_EQ(x[1], (5 - 0.6 * 3) / 0.8);
}

TEST(Whitening, FollowsTheTimes) {
  // AR(1) noise of a sample each millisecond, of which two of three in the first half and one of three in the second were kept.
  const double phi = 0.8;
  std::vector<double> noise = with_noise(60000, 1, phi, 8), time, kept;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(noise.size());
    if (i % 3 == 0 || (i % 3 == 1 && i < noise.size() / 2)) {
      time.push_back(1e-3 * static_cast<double>(i));
      kept.push_back(noise[i] - (2 * t - 4.9 * t * t));
    }
  }
  std::vector<double> intervals = {time[1] - time[0], time[2] - time[1], time.back() - time[time.size() - 2]};
  EXPECT_NEAR(intervals[0], 1e-3, 1e-9);
  EXPECT_NEAR(intervals[1], 2e-3, 1e-9);
  EXPECT_NEAR(intervals[2], 3e-3, 1e-9);
  Eigen::VectorXd w = Eigen::Map<const Eigen::VectorXd>(kept.data(), static_cast<Eigen::Index>(kept.size()));
  whiten(w, phi * phi, time);  // of the interval in the middle, 2 ms
  std::vector<double> of_interval[3];
  for (std::size_t i = 1; i < time.size(); ++i)
    of_interval[std::lround((time[i] - time[i - 1]) / 1e-3) - 1].push_back(w[static_cast<Eigen::Index>(i)]);
  for (const std::vector<double>& each : of_interval) {
    double squares = 0;
    for (const double x : each) squares += x * x;
    EXPECT_NEAR(squares / static_cast<double>(each.size()), 1, 0.06);
  }
  EXPECT_LT(neighbour_correlation(std::vector<double>(w.begin(), w.end())), 0.03);
}

TEST(Whitening, ASampleThatComesTwiceIsNoOutlier) {
  const std::vector<double> each = correlations(0.6, std::vector<double>{0, 1, 1.000001, 2, 3, 4});
  EXPECT_EQ(each[0], 0);
  EXPECT_EQ(each[1], 0.6);
  EXPECT_EQ(each[2], 0.95);
  EXPECT_EQ(each[4], 0.6);
}

TEST(Likelihood, IsTheGaussianDensity) {
  Eigen::VectorXd w(2);
  w << 1, -2;
  const double scale = 1.5;
  double expected = 0;
  for (const double x : w) expected += std::log(std::exp(-0.5 * x * x / (scale * scale)) / (scale * std::sqrt(2 * std::numbers::pi)));
  EXPECT_NEAR(gaussian_log_likelihood(w, scale), expected, 1e-12);
}

TEST(RecordedNoise, ReadingsInStepsOfTheNoiseScatterByATwelfthMore) {
  constexpr double sd = 1e-3;
  Flights f;
  f.noise = sd;
  f.rate = 1000;
  Bundle bundle = flights(f);
  bundle.noise["position"] = sd;
  EXPECT_EQ(recorded_noise(bundle, {0, 1, 2, 3}).at("position").sd, sd);
  for (BundleRun& run : bundle.runs)
    for (Vec3& x : run.observations[0].position)
      for (double& c : x) c = sd * std::round(c / sd);
  const double both = sd * std::sqrt(1 + 1.0 / 12);
  EXPECT_NEAR(recorded_noise(bundle, {0, 1, 2, 3}).at("position").sd, both, 0.02 * sd);
  bundle.noise["position"] = 1.1 * sd;  // whoever stated it knew the step
  EXPECT_EQ(recorded_noise(bundle, {0, 1, 2, 3}).at("position").sd, 1.1 * sd);
}

}  // namespace
}  // namespace repose::diagnosis
