#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

TEST(Noise, MissingSamplesBreakTheChain) {
  std::vector<double> x = with_noise(1000, 1e-3, 0, 4);
  for (std::size_t i = 0; i < x.size(); i += 17) x[i] = NAN;
  EXPECT_NEAR(noise_model(x).sd, 1e-3, 1.2e-4);
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
  whiten(w, phi);
  EXPECT_NEAR(w.squaredNorm() / static_cast<double>(w.size()), 1, 0.04);
  EXPECT_LT(neighbour_correlation(std::vector<double>(w.begin(), w.end())), 0.03);
}

TEST(Whitening, KeepsTheFirstSample) {
  Eigen::VectorXd x(2);
  x << 3, 5;
  whiten(x, 0.6);
  EXPECT_DOUBLE_EQ(x[0], 3);
  EXPECT_DOUBLE_EQ(x[1], (5 - 0.6 * 3) / 0.8);
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
