#include "tests/bench/concealment/measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>

#include "core/random.hpp"

namespace repose::concealment {
namespace {

constexpr double tail = 0.025;
constexpr int resamples = 2000;

}  // namespace

Estimate share(std::size_t hits, std::size_t n) {
  if (n == 0) return {};
  using Binomial = boost::math::binomial_distribution<double>;
  const auto trials = static_cast<double>(n), successes = static_cast<double>(hits);
  return {n, successes / trials, Binomial::find_lower_bound_on_p(trials, successes, tail), Binomial::find_upper_bound_on_p(trials, successes, tail)};
}

Estimate bootstrapped(const std::vector<double>& sample, const std::function<double(std::vector<double>)>& statistic) {
  if (sample.empty()) return {};
  Random random(1, 0);
  std::vector<double> found;
  for (int i = 0; i < resamples; ++i) {
    std::vector<double> again;
    for (std::size_t k = 0; k < sample.size(); ++k) again.push_back(sample[random.below(sample.size())]);
    found.push_back(statistic(std::move(again)));
  }
  return {sample.size(), statistic(sample), quantile(found, tail), quantile(found, 1 - tail)};
}

double quantile(std::vector<double> sample, double p) {
  std::sort(sample.begin(), sample.end());
  const double at = p * static_cast<double>(sample.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sample.size() - 1);
  return sample[below] + (at - static_cast<double>(below)) * (sample[above] - sample[below]);
}

std::string text_of(const Estimate& e, int decimals) {
  if (e.n == 0) return "no case";
  return fmt::format("{1:.{0}f} ({2:.{0}f} to {3:.{0}f})", decimals, e.value, e.lower, e.upper);
}

}  // namespace repose::concealment
