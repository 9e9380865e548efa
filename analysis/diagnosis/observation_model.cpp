#include "analysis/diagnosis/observation_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace repose::diagnosis {
namespace {

constexpr double kink = 5;         // times the median scatter: larger differences are no noise
constexpr double scatter = 4;      // of the ratio of two strides for white noise, 1.5 standard deviations, times sqrt(differences)
constexpr double strongest = 0.95;
constexpr double rounding = 1e-6;  // of an interval: times that were computed, or written and read again, are equal
constexpr double usual = 1e-3;     // of the middle interval
constexpr std::size_t enough_windows = 500;  // for a mean variance

using Four = std::array<double, 4>;

bool are_even(const Four& t) {
  const double mean = (t[3] - t[0]) / 3;
  const auto even = [&](std::size_t k) { return std::abs(t[k + 1] - t[k] - mean) <= rounding * mean; };
  return even(0) && even(1) && even(2);
}

/// What a divided third difference of samples at these times multiplies them by.
Four weights(const Four& t) {
  if (are_even(t)) return {1, -3, 3, -1};
  const double mean = (t[3] - t[0]) / 3;
  Four c{1, 1, 1, 1};
  double squares = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j)
      if (j != k) c[k] *= mean / (t[k] - t[j]);
    squares += c[k] * c[k];
  }
  for (double& weight : c) weight *= std::sqrt(20 / squares);
  return c;
}

double middle_interval(std::span<const double> time) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time.size(); ++i) intervals.push_back(time[i] - time[i - 1]);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// Of all records at one stride.
struct ThirdDifferences {
  std::size_t stride = 1;
  std::vector<double> size;
  std::vector<Four> uneven;  ///< times of those whose samples do not lie as usual, in middle intervals of their record

  /// Mean variance for AR(1) noise of unit variance.
  double variance(double phi) const {
    double f = 1;
    for (std::size_t i = 0; i < stride; ++i) f *= phi;
    const double even = 20 - 30 * f + 12 * f * f - 2 * f * f * f;
    if (uneven.empty()) return even;
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < uneven.size(); i += 1 + uneven.size() / enough_windows, ++count) {
      const Four c = weights(uneven[i]);
      for (std::size_t k = 0; k < 4; ++k) {
        sum += c[k] * c[k];
        for (std::size_t j = 0; j < k; ++j) sum += 2 * c[k] * c[j] * std::pow(phi, uneven[i][k] - uneven[i][j]);
      }
    }
    const double share = static_cast<double>(uneven.size()) / static_cast<double>(size.size());
    return share * sum / count + (1 - share) * even;
  }
};

ThirdDifferences third_differences(const TimedSamples& x, std::size_t n) {
  ThirdDifferences found{n, {}, {}};
  std::vector<double> time, value;
  const auto take = [&] {
    const double middle = value.size() > 3 * n ? middle_interval(time) : 1;
    for (std::size_t i = 0; i + 3 * n < value.size(); ++i) {
      const Four t{time[i], time[i + n], time[i + 2 * n], time[i + 3 * n]}, c = weights(t);
      found.size.push_back(std::abs(c[0] * value[i] + c[1] * value[i + n] + c[2] * value[i + 2 * n] + c[3] * value[i + 3 * n]));
      if (!are_even(t) || std::abs((t[3] - t[0]) / (3 * static_cast<double>(n) * middle) - 1) > usual)
        found.uneven.push_back({0, (t[1] - t[0]) / middle, (t[2] - t[0]) / middle, (t[3] - t[0]) / middle});
    }
    time.clear();
    value.clear();
  };
  for (std::size_t i = 0; i < x.time.size(); ++i) {
    if (std::isnan(x.time[i])) take();
    if (std::isnan(x.time[i]) || !std::isfinite(x.value[i])) continue;
    time.push_back(x.time[i]);
    value.push_back(x.value[i]);
  }
  take();
  return found;
}

/// Root mean square of those that no kink made, of white noise.
double scatter_of(std::vector<double> size) {
  if (size.size() < 8) return 0;
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  const double bound = kink * 1.4826 * *middle;
  double squares = 0, count = 0;
  for (const double d : size)
    if (d <= bound) squares += d * d, count += 1;
  return std::sqrt(squares / count / 20);
}

struct TwoStrides {
  explicit TwoStrides(const TimedSamples& x) : at_one(third_differences(x, 1)), at_two(third_differences(x, 2)), one(scatter_of(at_one.size)), two(scatter_of(at_two.size)) {}
  ThirdDifferences at_one, at_two;
  double one = 0, two = 0;  ///< scatter from differences at strides 1 and 2
  double ratio() const { return two * two / (one * one); }
  /// More than white noise of as many samples would be.
  bool correlated() const { return one > 0 && ratio() > 1 + scatter / std::sqrt(static_cast<double>(at_one.size.size())); }
};

}  // namespace

TimedSamples::TimedSamples(std::vector<double> values) : time(values.size()), value(std::move(values)) { std::iota(time.begin(), time.end(), 0.0); }

double noise_from_differences(const TimedSamples& x, std::size_t n) { return scatter_of(third_differences(x, n).size); }

NoiseModel noise_model(const TimedSamples& x) {
  const TwoStrides seen(x);
  if (!seen.correlated()) return {seen.one, 0};
  double low = 0, high = strongest;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (seen.at_two.variance(middle) / seen.at_one.variance(middle) < seen.ratio() ? low : high) = middle;
  }
  return {seen.one * std::sqrt(20 / seen.at_one.variance(low)), low};
}

double correlation_for(const TimedSamples& x, double sd) {
  const TwoStrides strides(x);
  if (!strides.correlated() || !(sd > 0)) return 0;
  const double seen = 20 * strides.one * strides.one / (sd * sd);
  double low = 0, high = strongest;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (strides.at_one.variance(middle) > seen ? low : high) = middle;
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

std::vector<double> correlations(double phi, std::span<const double> time) {
  std::vector<double> each(time.size(), 0);
  if (time.size() < 2) return each;
  const double middle = middle_interval(time);
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double share = (time[i] - time[i - 1]) / middle;
    each[i] = std::abs(share - 1) < usual ? phi : std::min(std::max(phi, strongest), std::pow(phi, share));
  }
  return each;
}

void whiten(Eigen::Ref<Eigen::VectorXd> channel, double phi, std::span<const double> time) {
  const std::vector<double> each = correlations(phi, time);
  for (Eigen::Index i = channel.size() - 1; i > 0; --i) {
    const double own = each[static_cast<std::size_t>(i)];
    channel[i] = (channel[i] - own * channel[i - 1]) * (1 / std::sqrt(1 - own * own));
  }
}

double gaussian_log_likelihood(const Eigen::VectorXd& w, double scale) {
  const double n = static_cast<double>(w.size());
  return -0.5 * n * std::log(2 * std::numbers::pi * scale * scale) - 0.5 * w.squaredNorm() / (scale * scale);
}

}  // namespace repose::diagnosis
