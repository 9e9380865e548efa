#pragma once
/// The contacts of a problem in the order in which blocks of bodies (body_blocks.hpp) are worked on.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "backends/dvi/cone_problem.hpp"

namespace repose::dvi {

/// Those within each block side by side and then those between blocks, each in the order of the problem.
struct ContactsByBlock {
  static constexpr std::int32_t none = -1;
  std::vector<std::int32_t> contact;  ///< by place: index in the problem; none: left free before the next start
  std::vector<std::size_t> start;     ///< place of the first of each block; of those between blocks; and the end

  /// Starts are multiples of `alignment`.
  ContactsByBlock(const ConeProblem& problem, int threads, std::size_t alignment = 1);

  std::size_t size() const { return contact.size(); }  ///< places, free ones included
  std::size_t blocks() const { return start.size() - 2; }
  std::size_t first_between() const { return start[blocks()]; }
};

}  // namespace repose::dvi
