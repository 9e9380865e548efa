#include "backends/dvi/colouring.hpp"

#include <algorithm>
#include <bit>

namespace repose::dvi {

Colouring colour_contacts(const ConeProblem& problem) {
  const std::size_t n = problem.contacts.size();
  std::vector<std::int32_t> colour(n, -1);
  std::vector<std::int32_t> size;
  std::vector<std::uint64_t> used(static_cast<std::size_t>(problem.dynamic_bodies));
  // 64 colours a round; bodies with more contacts than that (a large body under many grains) take further rounds.
  std::size_t left = n;
  for (int base = 0; left > 0; base += 64) {
    if (base > 0) std::fill(used.begin(), used.end(), 0);
    size.resize(static_cast<std::size_t>(base) + 64, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (colour[i] >= 0) continue;
      const ConeContact& c = problem.contacts[i];
      std::uint64_t* a = c.a < problem.dynamic_bodies ? &used[static_cast<std::size_t>(c.a)] : nullptr;
      std::uint64_t* b = c.b < problem.dynamic_bodies ? &used[static_cast<std::size_t>(c.b)] : nullptr;
      const std::uint64_t taken = (a ? *a : 0) | (b ? *b : 0);
      if (taken == ~std::uint64_t{0}) continue;
      const int k = std::countr_one(taken);
      if (a) *a |= std::uint64_t{1} << k;
      if (b) *b |= std::uint64_t{1} << k;
      colour[i] = base + k;
      ++size[static_cast<std::size_t>(base + k)];
      --left;
    }
  }
  Colouring result;
  result.start.push_back(0);
  std::vector<std::int32_t> next(size.size());
  for (std::size_t k = 0; k < size.size(); ++k) {
    next[k] = result.start.back();
    if (size[k] > 0) result.start.push_back(next[k] + size[k]);
  }
  result.order.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    result.order[static_cast<std::size_t>(next[static_cast<std::size_t>(colour[i])]++)] = static_cast<std::int32_t>(i);
  return result;
}

}  // namespace repose::dvi
