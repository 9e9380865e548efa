#pragma once
/// Blocks of bodies that are neighbours in the list (the finder lists them in spatial order). Contacts within one block share no body
/// with those within another: blocks are worked on side by side, each while its bodies are in the cache.
#include <algorithm>
#include <cstdint>

#include "backends/dvi/cone_problem.hpp"

namespace repose::dvi {

class BodyBlocks {
 public:
  /// Depends on the number of bodies alone. Few bodies make no blocks.
  explicit BodyBlocks(std::int32_t dynamic_bodies) : dynamic_bodies_(dynamic_bodies), size_(std::min(most, dynamic_bodies / fewest_blocks)) {
    if (size_ >= least) count_ = (dynamic_bodies + size_ - 1) / size_;
  }

  std::int32_t count() const { return count_; }

  /// The block that a contact is within; count(): none.
  std::int32_t of(const ConeContact& contact) const {
    if (count_ == 0) return count_;
    const std::int32_t a = contact.a < dynamic_bodies_ ? contact.a : contact.b, b = contact.b < dynamic_bodies_ ? contact.b : contact.a;
    if (a >= dynamic_bodies_) return count_;
    return a / size_ == b / size_ ? a / size_ : count_;
  }

 private:
  static constexpr std::int32_t most = 4096;         // bodies: what a sweep reads of them fits the second cache several times
  static constexpr std::int32_t least = 2048;        // fewer have too many contacts with others
  static constexpr std::int32_t fewest_blocks = 16;  // so that a team has something to share out

  std::int32_t dynamic_bodies_, size_, count_ = 0;
};

}  // namespace repose::dvi
