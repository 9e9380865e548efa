#include "core/size_sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr int cells = 16384;
constexpr double tail = 9;  // standard deviations; beyond lie 1e-19 of a normal law

double require_positive(const char* what, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw Error("size", fmt::format("the {} is {}", what, value), "give a positive, finite value");
  return value;
}

// Probability that a standard normal number lies in [a, b], without cancellation in the tails.
double normal_probability(double a, double b) {
  const double s = std::sqrt(0.5);
  return a > 0 ? 0.5 * (std::erfc(s * a) - std::erfc(s * b)) : 0.5 * (std::erfc(-s * b) - std::erfc(-s * a));
}

void require_inside(double probability, const SizeDistribution& d) {
  if (!(probability >= 1e-3))
    throw Error(
        "size",
        fmt::format("the range [{:g}, {:g}] m holds only {:.2g} % of the law", d.lower, d.upper, 100 * probability),
        "move the range to where the law has its sizes, or correct the law");
}

}  // namespace

SizeSampler::SizeSampler(const SizeDistribution& d) {
  if (!(d.lower >= 0) || !(d.upper > 0) || !(d.lower <= d.upper))
    throw Error("size", fmt::format("the range is [{:g}, {:g}] m", d.lower, d.upper),
                "give a lower end of zero or more and an upper end above it");

  std::vector<double> sizes;
  if (const auto* fixed = std::get_if<FixedSize>(&d.law)) {
    sizes = {require_positive("size", fixed->value)};
  } else if (const auto* table = std::get_if<TableSize>(&d.law)) {
    for (double v : table->values) sizes.push_back(require_positive("measured size", v));
    if (sizes.empty()) throw Error("size", "the table of measured sizes is empty", "give at least one size");
  } else if (const auto* normal = std::get_if<NormalSize>(&d.law); normal && normal->sd == 0) {
    sizes = {require_positive("mean size", normal->mean)};
  } else if (const auto* lognormal = std::get_if<LogNormalSize>(&d.law); lognormal && lognormal->log_sd == 0) {
    sizes = {require_positive("median size", lognormal->median)};
  } else {
    tabulate(d);
    return;
  }

  discrete_ = true;
  std::erase_if(sizes, [&](double v) { return v < d.lower || v > d.upper; });
  if (sizes.empty())
    throw Error("size", fmt::format("no size lies in the range [{:g}, {:g}] m", d.lower, d.upper), "widen the range");
  unit_ = *std::max_element(sizes.begin(), sizes.end());
  double sum = 0;
  for (double v : sizes) {
    const double relative = v / unit_;
    sum += d.by_volume ? 1 / (relative * relative * relative) : 1;
    nodes_.push_back(relative);
    cumulative_.push_back(sum);
  }
  for (double& c : cumulative_) c /= sum;
}

// The number density in the variable x (d or ln d), as a logarithm; by volume it carries a factor d^-3.
void SizeSampler::tabulate(const SizeDistribution& d) {
  lower_ = d.lower, upper_ = d.upper;
  const double cubes = d.by_volume ? 3 : 0;
  const auto* normal = std::get_if<NormalSize>(&d.law);
  double from = 0, to = 0, sd = 0;
  if (normal) {
    unit_ = require_positive("mean size", normal->mean);
    sd = require_positive("standard deviation of the size", normal->sd) / unit_;
    const double lower = d.lower / unit_, upper = d.upper / unit_;
    require_inside(normal_probability((lower - 1) / sd, (upper - 1) / sd), d);
    from = std::max(lower, 1 - tail * sd);
    to = std::min(upper, 1 + tail * sd);
    if (d.by_volume) {
      if (!(lower > 0))
        throw Error("size", "a normal law by volume with no lower end consists of infinitely many grains of no size",
                    "give a range with a lower end above zero");
      logarithmic_ = true;
      // Small grains are many: the lower tail is left out only where even their number is negligible.
      if (0.5 * (1 - lower) * (1 - lower) / (sd * sd) + 4 * std::log(lower) < 60) from = lower;
      from = std::log(from), to = std::log(to);
    }
  } else {
    const auto& lognormal = std::get<LogNormalSize>(d.law);
    unit_ = require_positive("median size", lognormal.median);
    sd = require_positive("log_sd of the size", lognormal.log_sd);
    logarithmic_ = true;
    const double lower = std::log(d.lower / unit_), upper = std::log(d.upper / unit_);
    require_inside(normal_probability(lower / sd, upper / sd), d);
    // A factor d^-3 shifts the mean of ln d by -3 sd^2 and keeps the law lognormal.
    const double centre = -cubes * sd * sd;
    from = std::max(lower, centre - tail * sd);
    to = std::min(upper, std::max(centre, lower) + tail * sd);
  }

  double highest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i <= cells; ++i) {
    const double x = from + (to - from) * i / cells;
    const double z = (!normal ? x : logarithmic_ ? std::expm1(x) : x - 1) / sd;
    nodes_.push_back(x);
    density_.push_back(-0.5 * z * z - cubes * x + (normal && logarithmic_ ? x : 0));
    highest = std::max(highest, density_.back());
  }
  for (double& value : density_) value = std::exp(value - highest);
  cumulative_.assign(1, 0.0);
  for (std::size_t i = 1; i < nodes_.size(); ++i)
    cumulative_.push_back(cumulative_.back() + 0.5 * (density_[i] + density_[i - 1]));
  const double sum = cumulative_.back();
  for (double& c : cumulative_) c /= sum;
  for (double& value : density_) value /= sum;  // per cell
}

double SizeSampler::draw(Random& random) const {
  if (discrete_ && nodes_.size() == 1) return unit_ * nodes_[0];
  const double u = random.uniform();
  const auto above =
      static_cast<std::size_t>(std::upper_bound(cumulative_.begin(), cumulative_.end(), u) - cumulative_.begin());
  const std::size_t i = std::min(above, cumulative_.size() - 1);
  if (discrete_) return unit_ * nodes_[i];
  // Solves a t + (b - a) t^2 / 2 = part, in the form that is safe for a = b.
  const double a = density_[i - 1], b = density_[i], part = std::max(0.0, u - cumulative_[i - 1]);
  const double root = a + std::sqrt(std::max(0.0, a * a + 2 * (b - a) * part));
  const double t = root > 0 ? std::min(1.0, 2 * part / root) : 0.5;
  const double x = nodes_[i - 1] + t * (nodes_[i] - nodes_[i - 1]);
  // Rounding alone could put it out of the range.
  return std::clamp(unit_ * (logarithmic_ ? std::exp(x) : x), lower_, upper_);
}

double SizeSampler::mean_cube() const {
  double sum = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const double x = logarithmic_ ? std::exp(nodes_[i]) : nodes_[i];
    double weight;
    if (discrete_)
      weight = cumulative_[i] - (i > 0 ? cumulative_[i - 1] : 0);
    else
      weight = density_[i] * (i == 0 || i + 1 == nodes_.size() ? 0.5 : 1);
    sum += weight * x * x * x;
  }
  return sum * unit_ * unit_ * unit_;
}

}  // namespace repose
