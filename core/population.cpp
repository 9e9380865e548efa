#include "core/population.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.hpp"
#include "core/random.hpp"
#include "core/size_sampler.hpp"

namespace repose {
namespace {

constexpr std::size_t most_grains = 100'000'000;

// The grains of each shape: the shares of `count`, rounded so that none is off by a whole grain (largest remainder).
std::vector<std::size_t> apportioned(const std::vector<double>& shares, double total, std::size_t count) {
  std::vector<std::size_t> numbers(shares.size()), order(shares.size());
  std::vector<double> remainder(shares.size());
  std::size_t given = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double exact = shares[i] / total * static_cast<double>(count);
    numbers[i] = static_cast<std::size_t>(exact);
    remainder[i] = exact - std::floor(exact);
    given += numbers[i];
  }
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return remainder[a] > remainder[b]; });
  for (std::size_t k = 0; given < count; ++k, ++given) ++numbers[order[k % order.size()]];
  return numbers;
}

// Each grain goes to the shape that lacks most of its share of the total volume: all end within one grain of it. The
// choice looks only at the grains before, so that every shape keeps the same law of sizes.
void share_by_mass(const std::vector<double>& shares, double total, std::vector<GrainKind>& grains) {
  double volume = 0;
  for (const GrainKind& g : grains) volume += g.size * g.size * g.size;
  std::vector<double> lacking;
  for (double share : shares) lacking.push_back(share / total * volume);
  for (GrainKind& g : grains) {
    const auto most = std::max_element(lacking.begin(), lacking.end());
    g.shape = static_cast<int>(most - lacking.begin());
    *most -= g.size * g.size * g.size;
  }
}

double checked_total(const std::vector<double>& shares) {
  double total = 0;
  for (double share : shares) {
    if (!(share >= 0) || !std::isfinite(share))
      throw Error("mix", fmt::format("a share is {}", share), "give shares of zero or more; they need not add up to 1");
    total += share;
  }
  if (!(total > 0) || !std::isfinite(total))
    throw Error("mix", fmt::format("the shares add up to {}", total), "give at least one shape a positive share");
  return total;
}

}  // namespace

double mean_volume(const SizeDistribution& size) { return std::numbers::pi / 6 * SizeSampler(size).mean_cube(); }

std::vector<GrainKind> draw_grains(const SizeDistribution& size, const std::vector<double>& shares, bool by_mass,
                                   std::size_t count, std::uint64_t seed) {
  const double total = checked_total(shares);
  if (count > most_grains)
    throw Error("count", fmt::format("{} grains are asked for, but {} are the most", count, most_grains),
                "simulate a smaller sample");
  const SizeSampler sampler(size);
  Random sizes(seed, 1), order(seed, 2);
  std::vector<GrainKind> grains(count);
  for (GrainKind& g : grains) g.size = sampler.draw(sizes);

  if (by_mass) {
    share_by_mass(shares, total, grains);
    for (std::size_t i = count; i > 1; --i) std::swap(grains[i - 1], grains[order.below(i)]);
  } else {
    const std::vector<std::size_t> numbers = apportioned(shares, total, count);
    std::size_t next = 0;
    for (std::size_t shape = 0; shape < numbers.size(); ++shape)
      for (std::size_t k = 0; k < numbers[shape]; ++k) grains[next++].shape = static_cast<int>(shape);
    for (std::size_t i = count; i > 1; --i) std::swap(grains[i - 1].shape, grains[order.below(i)].shape);
  }
  return grains;
}

}  // namespace repose
