#include "analysis/diagnosis/probe.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>

#include "analysis/bundle/sensor.hpp"
#include "core/random.hpp"

namespace repose::diagnosis {
namespace {

constexpr std::uint64_t stream = 77;
constexpr Eigen::Index together = 64;  // draws that are projected at once
constexpr Eigen::Index enough = 30;    // samples, to tell how noise is distributed
constexpr double understated = 1.1, outlier = 8;  // of the noise; what is larger is no outlier of a sensor

/// From the products Q^T r of all probes, one under the other.
double largest_deviate(const std::vector<Probe>& probes, const Eigen::VectorXd& products) {
  double largest = -std::numeric_limits<double>::infinity();
  Eigen::Index at = 0;
  for (const Probe& probe : probes) {
    const Eigen::Index k = probe.basis.cols();
    if (k == 0) continue;
    const double gain = probe.one_sided && products[at] > 0 ? 0 : products.segment(at, k).squaredNorm();
    largest = std::max(largest, deviate(gain, k));
    at += k;
  }
  return largest;
}

/// What draws are taken from; empty: normal numbers.
Eigen::VectorXd noise_like(const Eigen::VectorXd& residual) {
  const double rms = std::sqrt(residual.squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, residual.size())));
  if (residual.size() < enough || !(rms > 0) || !std::isfinite(rms)) return {};
  return (residual / rms).cwiseMax(-outlier).cwiseMin(outlier) * std::clamp(rms, 1.0, understated);
}

}  // namespace

double gain_of(const Probe& probe, const Eigen::VectorXd& residual) {
  if (probe.basis.cols() == 0) return 0;
  const Eigen::VectorXd product = probe.basis.transpose() * residual;
  return probe.one_sided && product[0] > 0 ? 0 : product.squaredNorm();
}

double deviate(double gain, Eigen::Index k) {
  if (k == 0) return -std::numeric_limits<double>::infinity();
  const double n = static_cast<double>(k), width = 2 / (9 * n);
  return (std::cbrt(gain / n) - 1 + width) / std::sqrt(width);
}

double strength(double gain, Eigen::Index k) {
  if (k == 0) return 0;
  constexpr double far_out = 200;  // P is near 1e-43 there, and the leading term of its asymptotic series good to a hundredth
  const double half = 0.5 * static_cast<double>(k);
  const double ln_p = gain < far_out ? std::log(p_of_chi2(gain, k)) : -0.5 * gain + (half - 1) * std::log(0.5 * gain) - std::lgamma(half);
  return std::sqrt(std::max(0.0, -2 * ln_p));
}

double p_of_chi2(double chi2, Eigen::Index degrees) {
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(static_cast<double>(degrees)), chi2));
}

double NullDistribution::p(double deviate) const {
  const auto reached = static_cast<double>(largest.end() - std::lower_bound(largest.begin(), largest.end(), deviate));
  return (1 + reached) / (1 + static_cast<double>(largest.size()));
}

NullDistribution null_of(const std::vector<Probe>& probes, const Eigen::VectorXd& residual, int replicas, std::uint64_t seed) {
  const Eigen::Index size = residual.size();
  const Eigen::VectorXd values = noise_like(residual);
  Eigen::Index columns = 0;
  for (const Probe& probe : probes) columns += probe.basis.cols();
  Eigen::MatrixXd all(size, columns);
  columns = 0;
  for (const Probe& probe : probes) {
    all.middleCols(columns, probe.basis.cols()) = probe.basis;
    columns += probe.basis.cols();
  }
  NullDistribution null;
  Random random(seed, stream);
  for (Eigen::Index done = 0; done < replicas; done += together) {
    Eigen::MatrixXd noise(size, std::min<Eigen::Index>(together, replicas - done));
    for (double& e : noise.reshaped())
      e = values.size() == 0 ? normal(random)
                             : (random.uniform() < 0.5 ? 1 : -1) * values[static_cast<Eigen::Index>(random.below(static_cast<std::uint64_t>(values.size())))];
    const Eigen::MatrixXd products = all.transpose() * noise;
    for (Eigen::Index b = 0; b < products.cols(); ++b) null.largest.push_back(largest_deviate(probes, products.col(b)));
  }
  std::sort(null.largest.begin(), null.largest.end());
  return null;
}

}  // namespace repose::diagnosis
