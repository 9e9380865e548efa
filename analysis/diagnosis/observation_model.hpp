#pragma once
/// How much a difference counts: noise of the sensors from the data themselves, and its correlation in time.
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace repose::diagnosis {

/// What a sensor read, in the order of time.
struct TimedSamples {
  TimedSamples() = default;
  TimedSamples(std::vector<double> times, std::vector<double> values) : time(std::move(times)), value(std::move(values)) {}
  TimedSamples(std::vector<double> values);  ///< at equal intervals
  std::vector<double> time;   ///< [s], ascending; NaN: another record follows, and no difference reaches across
  std::vector<double> value;  ///< as many; NaN: a missing sample, which is left out
};

/// Standard deviation of white noise on a smooth signal, from divided third differences of four samples that follow one another:
///   d = sum c_k x_k,  c_k ~ 1 / prod_{j != k} (t_k - t_j),  sum c_k^2 = 20;   s^2 = mean d^2 / 20 over |d| <= 5 * 1.4826 median|d|.
/// A parabola has none, whatever the times; equal intervals give c = (1, -3, 3, -1).
/// The bound forgets kinks (impacts), and keeps the tails of noise that is not normal: a median of it would be too small by
/// a seventh for Student's t with four degrees of freedom. 0 with fewer than 8 differences, or if the
/// signal is exact. A signal that is not smooth at the sampling interval makes it too large.
/// `stride` n takes x_i, x_{i+n}, ...
double noise_from_differences(const TimedSamples& samples, std::size_t stride = 1);

struct NoiseModel {
  double sd = 0;   ///< of one sample
  double phi = 0;  ///< correlation of neighbours at the usual interval, AR(1)
};

/// Scatter and correlation from third differences at strides n = 1 and 2, whose variances are for AR(1) noise
///   V_n = s^2 (20 - 30 phi^n + 12 phi^2n - 2 phi^3n);
/// phi solves V_2 / V_1, and is 0 while that stays below 1 + 4 / sqrt(differences), one and a half standard deviations of what white noise
/// gives. The signal must be smooth over six samples. At uneven times phi is that over the middle interval of each record, and V_n the mean of
///   s^2 sum_kj c_k c_j phi^(|t_k - t_j| / middle).
NoiseModel noise_model(const TimedSamples& samples);

/// The correlation phi of AR(1) noise whose scatter is known: it solves V_1 = sd^2 (20 - 30 phi + 12 phi^2 - 2 phi^3). V_2 / V_1 alone tells
/// little of a strong one (1.8 at phi = 0.6, never above 2). 0 where that ratio stays below the same bound.
double correlation_for(const TimedSamples& samples, double sd);

/// Correlation of neighbours, r_1 = sum x_i x_{i+1} / sum x_i^2, in [0, 0.95]; 0 with fewer than 10 samples. `samples` have mean
/// zero; NaN breaks the chain.
double neighbour_correlation(std::span<const double> samples);

/// Correlation of each sample with the one before it, if `phi` is that over the middle interval of the times [s, ascending]:
///   phi_0 = 0,  phi_i = phi^((t_i - t_{i-1}) / middle),  at most 0.95 where samples lie closer than usual;
/// phi itself for intervals that differ from the middle one by less than a thousandth.
std::vector<double> correlations(double phi, std::span<const double> time);

/// A channel of residuals turned into independent ones of unit variance, if they are AR(1) with scale 1:
///   w_i = (x_i - phi_i x_{i-1}) / sqrt(1 - phi_i^2),  phi_i of correlations(phi, time).
void whiten(Eigen::Ref<Eigen::VectorXd> channel, double phi, std::span<const double> time);

/// Log density of whitened residuals w of standard deviation `scale` (1: the sensors' own noise):
///   -n/2 ln(2 pi scale^2) - sum w^2 / (2 scale^2).
double gaussian_log_likelihood(const Eigen::VectorXd& whitened, double scale);

}  // namespace repose::diagnosis
