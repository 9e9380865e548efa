#pragma once
/// How much a difference counts: noise of the sensors from the data themselves, and its correlation in time.
#include <span>
#include <vector>

#include <Eigen/Core>

namespace repose::diagnosis {

/// Standard deviation of white noise on a smooth signal, from third differences:
///   d_i = x_i - 3 x_{i+1} + 3 x_{i+2} - x_{i+3},  Var d = 20 s^2;   s^2 = mean d^2 / 20 over |d| <= 5 * 1.4826 median|d|.
/// The bound forgets kinks (impacts), and keeps the tails of noise that is not normal: a median of it would be too small by
/// a seventh for Student's t with four degrees of freedom. NaN samples break the chain. 0 with fewer than 8 differences, or if the
/// signal is exact. A signal that is not smooth at the sampling interval makes it too large.
/// `stride` n takes x_i, x_{i+n}, ...
double noise_from_differences(std::span<const double> samples, std::size_t stride = 1);

struct NoiseModel {
  double sd = 0;   ///< of one sample
  double phi = 0;  ///< correlation of neighbours, AR(1)
};

/// Scatter and correlation from third differences at strides n = 1 and 2, whose variances are for AR(1) noise
///   V_n = s^2 (20 - 30 phi^n + 12 phi^2n - 2 phi^3n);
/// phi solves V_2 / V_1, and is 0 while that stays below 1 + 4 / sqrt(differences), one and a half standard deviations of what white noise
/// gives. The signal must be smooth over six samples.
NoiseModel noise_model(std::span<const double> samples);

/// The correlation phi of AR(1) noise whose scatter is known: it solves V_1 = sd^2 (20 - 30 phi + 12 phi^2 - 2 phi^3). V_2 / V_1 alone tells
/// little of a strong one (1.8 at phi = 0.6, never above 2). 0 where that ratio stays below the same bound.
double correlation_for(std::span<const double> samples, double sd);

/// Correlation of neighbours, r_1 = sum x_i x_{i+1} / sum x_i^2, in [0, 0.95]; 0 with fewer than 10 samples. `samples` have mean
/// zero; NaN breaks the chain.
double neighbour_correlation(std::span<const double> samples);

/// A channel of residuals turned into independent ones of unit variance, if they are AR(1) with scale 1:
///   w_0 = x_0,  w_i = (x_i - phi x_{i-1}) / sqrt(1 - phi^2).
void whiten(Eigen::Ref<Eigen::VectorXd> channel, double phi);

/// Log density of whitened residuals w of standard deviation `scale` (1: the sensors' own noise):
///   -n/2 ln(2 pi scale^2) - sum w^2 / (2 scale^2).
double gaussian_log_likelihood(const Eigen::VectorXd& whitened, double scale);

}  // namespace repose::diagnosis
