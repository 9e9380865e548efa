#include "backends/dvi/colouring.hpp"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "backends/dvi/contacts_by_block.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

constexpr std::int32_t colours_of_round = 64;

/// Colours the contacts listed. `used`: a word of zeros for each dynamic body that they touch. Returns the number of each colour.
std::vector<std::int32_t> colour_greedily(const ConeProblem& problem, std::span<const std::int32_t> contacts, std::vector<std::uint64_t>& used,
                                          std::vector<std::int32_t>& colour) {
  std::vector<std::int32_t> size;
  const auto word = [&](std::int32_t body) { return body < problem.dynamic_bodies ? &used[static_cast<std::size_t>(body)] : nullptr; };
  // 64 colours a round; bodies with more contacts than that (a large body under many grains) take further rounds.
  std::int32_t base = 0;
  for (bool left = true; left; base += colours_of_round) {
    left = false;
    if (base > 0)
      for (const std::int32_t i : contacts)
        for (const std::int32_t body : {problem.contacts[static_cast<std::size_t>(i)].a, problem.contacts[static_cast<std::size_t>(i)].b})
          if (word(body)) *word(body) = 0;
    for (const std::int32_t i : contacts) {
      std::int32_t& own = colour[static_cast<std::size_t>(i)];
      if (own >= 0) continue;
      const ConeContact& c = problem.contacts[static_cast<std::size_t>(i)];
      std::uint64_t *a = word(c.a), *b = word(c.b);
      const int k = std::countr_one((a ? *a : 0) | (b ? *b : 0));
      if (k == colours_of_round) {
        left = true;
        continue;
      }
      if (a) *a |= std::uint64_t{1} << k;
      if (b) *b |= std::uint64_t{1} << k;
      own = base + k;
      size.resize(std::max(size.size(), static_cast<std::size_t>(own) + 1), 0);
      ++size[static_cast<std::size_t>(own)];
    }
  }
  return size;
}

}  // namespace

Colouring colour_contacts(const ConeProblem& problem, int threads) {
  const ContactsByBlock by_block(problem, threads);
  const std::size_t parts = by_block.blocks() + 1;
  Colouring result;
  result.order.resize(problem.contacts.size());
  std::vector<std::int32_t> colour(problem.contacts.size(), -1);
  // Blocks share no body: one array serves them all at once. Contacts between them touch any body and have their own.
  const auto bodies = static_cast<std::size_t>(problem.dynamic_bodies);
  std::vector<std::uint64_t> used_within(by_block.blocks() > 0 ? bodies : 0, 0), used_between(bodies, 0);
  std::vector<std::vector<std::int32_t>> size(parts);
  for_each_index_as_it_comes(threads, parts, [&](std::size_t turn) {
    const std::size_t part = parts - 1 - turn;  // what is between blocks is the longest: first
    const auto first = by_block.start[part], last = by_block.start[part + 1];
    const std::span contacts(by_block.contact.data() + first, last - first);
    size[part] = colour_greedily(problem, contacts, turn == 0 ? used_between : used_within, colour);
    std::vector<std::size_t> next;
    std::size_t end = first;
    for (const std::int32_t n : size[part]) next.push_back(std::exchange(end, end + static_cast<std::size_t>(n)));
    for (const std::int32_t i : contacts) result.order[next[static_cast<std::size_t>(colour[static_cast<std::size_t>(i)])]++] = i;
  });
  result.start.push_back(0);
  for (const std::vector<std::int32_t>& of_part : size) {
    result.block.push_back(result.colours());
    for (const std::int32_t n : of_part) result.start.push_back(result.start.back() + n);
  }
  return result;
}

}  // namespace repose::dvi
