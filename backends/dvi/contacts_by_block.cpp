#include "backends/dvi/contacts_by_block.hpp"

#include <numeric>
#include <utility>

#include "backends/dvi/body_blocks.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

ContactsByBlock::ContactsByBlock(const ConeProblem& problem, int threads, std::size_t alignment) {
  const std::size_t n = problem.contacts.size();
  const BodyBlocks blocks(problem.dynamic_bodies);
  if (blocks.count() == 0) {
    start = {0, n};
    contact.resize(n);
    std::iota(contact.begin(), contact.end(), 0);
    return;
  }
  std::vector<std::int32_t> block(n);
  for_each_index(threads, n, [&](std::size_t i) { block[i] = blocks.of(problem.contacts[i]); });
  std::vector<std::size_t> next(static_cast<std::size_t>(blocks.count()) + 1, 0);
  for (const std::int32_t of : block) ++next[static_cast<std::size_t>(of)];
  std::size_t end = 0;
  for (std::size_t& place : next) {
    start.push_back((end + alignment - 1) / alignment * alignment);
    end = start.back() + std::exchange(place, start.back());
  }
  start.push_back(end);
  contact.assign(end, none);
  for (std::size_t i = 0; i < n; ++i) contact[next[static_cast<std::size_t>(block[i])]++] = static_cast<std::int32_t>(i);
}

}  // namespace repose::dvi
