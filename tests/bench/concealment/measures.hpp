#pragma once
/// Shares and quantiles with 95 % intervals.
#include <functional>
#include <string>
#include <vector>

namespace repose::concealment {

struct Estimate {
  std::size_t n = 0;
  double value = 0, lower = 0, upper = 1;
};

/// hits / n with the interval of Clopper & Pearson; n = 0: from 0 to 1.
Estimate share(std::size_t hits, std::size_t n);

/// A statistic of a sample with a percentile bootstrap of 2,000 resamples (fixed seed). `sample` may be empty: n = 0.
Estimate bootstrapped(const std::vector<double>& sample, const std::function<double(std::vector<double>)>& statistic);

/// By straight lines between ordered values, p in [0, 1].
double quantile(std::vector<double> sample, double p);

/// "0.93 (0.81 to 0.98)", with `decimals`; "no case" if n = 0.
std::string text_of(const Estimate& estimate, int decimals = 2);

}  // namespace repose::concealment
