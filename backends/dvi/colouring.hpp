#pragma once
/// Groups contacts so that no two of one group share a dynamic body: they can be solved at the same time.
///
/// Where bodies are many they make up blocks (body_blocks.hpp). A block's own contacts come first, coloured by themselves; what is left
/// are the contacts between blocks, coloured for all.
#include <cstdint>
#include <vector>

#include "backends/dvi/cone_problem.hpp"

namespace repose::dvi {

struct Colouring {
  std::vector<std::int32_t> order;   ///< contact indices, colour after colour, ascending within a colour
  std::vector<std::int32_t> start;   ///< of each colour in `order`; one more entry than colours
  std::vector<std::int32_t> block;   ///< first colour of each block; then that of the contacts between blocks
  int colours() const { return static_cast<int>(start.size()) - 1; }
  int blocks() const { return static_cast<int>(block.size()) - 1; }
};

/// Greedy, in the order of the contacts: each takes the first colour that is free at both of its bodies. In each block, and between
/// blocks, at most one more colour than the sum of two bodies' contacts; linear in the number of contacts while bodies have up to 64.
/// Depends on the problem alone.
Colouring colour_contacts(const ConeProblem& problem, int threads);

}  // namespace repose::dvi
