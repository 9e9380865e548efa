#include "backends/dvi/colouring.hpp"

#include <bit>
#include <utility>

#include "backends/dvi/body_blocks.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

constexpr std::int32_t colours_of_round = 64;

/// Colours every contact for which `own(i)` holds. Returns the number of colours that may be in use.
template <class Own>
std::int32_t colour_greedily(const ConeProblem& problem, Own&& own, std::vector<std::int32_t>& colour) {
  std::vector<std::uint64_t> used(static_cast<std::size_t>(problem.dynamic_bodies));
  // 64 colours a round; bodies with more contacts than that (a large body under many grains) take further rounds.
  std::int32_t base = 0;
  for (bool left = true; left; base += colours_of_round) {
    left = false;
    if (base > 0) used.assign(used.size(), 0);
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      if (colour[i] >= 0 || !own(i)) continue;
      const ConeContact& c = problem.contacts[i];
      std::uint64_t* a = c.a < problem.dynamic_bodies ? &used[static_cast<std::size_t>(c.a)] : nullptr;
      std::uint64_t* b = c.b < problem.dynamic_bodies ? &used[static_cast<std::size_t>(c.b)] : nullptr;
      const int k = std::countr_one((a ? *a : 0) | (b ? *b : 0));
      if (k == colours_of_round) {
        left = true;
        continue;
      }
      if (a) *a |= std::uint64_t{1} << k;
      if (b) *b |= std::uint64_t{1} << k;
      colour[i] = base + k;
    }
  }
  return base;
}

}  // namespace

Colouring colour_contacts(const ConeProblem& problem, int threads) {
  const std::size_t n = problem.contacts.size();
  const BodyBlocks blocks(problem.dynamic_bodies);
  std::vector<std::int32_t> block(n), colour(n, -1);
  for_each_index(threads, n, [&](std::size_t i) { block[i] = blocks.of(problem.contacts[i]); });
  const std::int32_t between = blocks.count();
  const std::int32_t in_block = between == 0 ? 0 : colour_greedily(problem, [&](std::size_t i) { return block[i] < between; }, colour);
  const std::int32_t in_all = colour_greedily(problem, [&](std::size_t i) { return block[i] == between; }, colour);

  const auto group_of = [&](std::size_t i) { return static_cast<std::size_t>(block[i] * in_block + colour[i]); };
  std::vector<std::int32_t> next(static_cast<std::size_t>(between * in_block + in_all), 0);
  for (std::size_t i = 0; i < n; ++i) ++next[group_of(i)];
  Colouring result;
  result.start.push_back(0);
  for (std::int32_t group = 0; group < static_cast<std::int32_t>(next.size()); ++group) {
    const bool of_a_block = group < between * in_block;
    if (of_a_block ? group % in_block == 0 : group == between * in_block) result.block.push_back(result.colours());
    std::int32_t& place = next[static_cast<std::size_t>(group)];
    const std::int32_t size = std::exchange(place, result.start.back());
    if (size > 0) result.start.push_back(place + size);
  }
  result.order.resize(n);
  for (std::size_t i = 0; i < n; ++i) result.order[static_cast<std::size_t>(next[group_of(i)]++)] = static_cast<std::int32_t>(i);
  return result;
}

}  // namespace repose::dvi
