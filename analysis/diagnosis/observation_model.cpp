#include "analysis/diagnosis/observation_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace repose::diagnosis {
namespace {

constexpr double kink = 5;         // times the median scatter: larger differences are no noise
constexpr double scatter = 4;      // of the ratio of two strides for white noise, 1.5 standard deviations, times sqrt(differences)
constexpr double strongest = 0.95;

/// Of third differences of AR(1) noise of unit variance.
double variance_of_differences(double phi) { return 20 - 30 * phi + 12 * phi * phi - 2 * phi * phi * phi; }

std::vector<double> third_differences(std::span<const double> x, std::size_t n) {
  std::vector<double> size;
  for (std::size_t i = 0; i + 3 * n < x.size(); ++i) {
    const double d = x[i] - 3 * x[i + n] + 3 * x[i + 2 * n] - x[i + 3 * n];
    if (std::isfinite(d)) size.push_back(std::abs(d));
  }
  return size;
}

struct TwoStrides {
  double one = 0, two = 0;  ///< scatter from differences at strides 1 and 2
  double ratio() const { return two * two / (one * one); }
  bool correlated = false;  ///< more than white noise of as many samples would be
};

TwoStrides two_strides(std::span<const double> x) {
  TwoStrides s{noise_from_differences(x, 1), noise_from_differences(x, 2)};
  s.correlated = s.one > 0 && s.ratio() > 1 + scatter / std::sqrt(static_cast<double>(third_differences(x, 1).size()));
  return s;
}

}  // namespace

double noise_from_differences(std::span<const double> x, std::size_t n) {
  std::vector<double> size = third_differences(x, n);
  if (size.size() < 8) return 0;
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  const double bound = kink * 1.4826 * *middle;
  double squares = 0, count = 0;
  for (const double d : size)
    if (d <= bound) squares += d * d, count += 1;
  return std::sqrt(squares / count / 20);
}

NoiseModel noise_model(std::span<const double> x) {
  const auto variance = variance_of_differences;
  const TwoStrides seen = two_strides(x);
  if (!seen.correlated) return {seen.one, 0};
  double low = 0, high = strongest;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (variance(middle * middle) / variance(middle) < seen.ratio() ? low : high) = middle;
  }
  return {seen.one * std::sqrt(20 / variance(low)), low};
}

double correlation_for(std::span<const double> x, double sd) {
  const TwoStrides strides = two_strides(x);
  if (!strides.correlated || !(sd > 0)) return 0;
  const double seen = 20 * strides.one * strides.one / (sd * sd);
  double low = 0, high = strongest;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (variance_of_differences(middle) > seen ? low : high) = middle;
  }
  return low;
}

double neighbour_correlation(std::span<const double> x) {
  double products = 0, squares = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(x[i + 1])) continue;
    products += x[i] * x[i + 1];
    squares += 0.5 * (x[i] * x[i] + x[i + 1] * x[i + 1]);
    ++n;
  }
  if (n < 10 || squares == 0) return 0;
  return std::clamp(products / squares, 0.0, 0.95);
}

void whiten(Eigen::Ref<Eigen::VectorXd> channel, double phi) {
  const double gain = 1 / std::sqrt(1 - phi * phi);
  for (Eigen::Index i = channel.size() - 1; i > 0; --i) channel[i] = (channel[i] - phi * channel[i - 1]) * gain;
}

double gaussian_log_likelihood(const Eigen::VectorXd& w, double scale) {
  const double n = static_cast<double>(w.size());
  return -0.5 * n * std::log(2 * std::numbers::pi * scale * scale) - 0.5 * w.squaredNorm() / (scale * scale);
}

}  // namespace repose::diagnosis
