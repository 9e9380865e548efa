#include "backends/dvi/broad_phase.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace repose::dvi {

namespace {

constexpr int coordinate_bits = 19;
constexpr int max_level = 63;  // sizes beyond 2^63 : 1 share the last grid

/// Spreads the low 19 bits so that two zero bits follow each.
std::uint64_t spread(std::uint64_t x) {
  x &= (1ull << coordinate_bits) - 1;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  x = (x | x << 2) & 0x1249249249249249ull;
  return x;
}

}  // namespace

std::int64_t BroadPhase::cell(double x, double inverse) {
  // Clamped: a body that left for infinity must not overflow the conversion. Cells far apart may share a key (the key
  // holds 19 bits of each coordinate), which only costs a distance test.
  return static_cast<std::int64_t>(std::floor(std::clamp(x * inverse, -1e15, 1e15)));
}

std::uint64_t BroadPhase::key(int level, std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<std::uint64_t>(level) << 57 ^ spread(static_cast<std::uint64_t>(x)) ^
         spread(static_cast<std::uint64_t>(y)) << 1 ^ spread(static_cast<std::uint64_t>(z)) << 2;
}

int BroadPhase::level_of(double reach) const {
  return std::clamp(std::ilogb(reach / smallest_), 0, max_level);
}

std::int64_t BroadPhase::cell_of(int level, int axis, double x) const {
  if (!periodic_.along(axis)) return cell(x, inverse_cell_[static_cast<std::size_t>(level)]);
  const Ring& ring = ring_of(level, axis);
  return ring.around(ring.step(x));
}

void BroadPhase::build(std::span<const Vec3> centre, std::span<const double> reach, const PeriodicCell& cell) {
  periodic_ = cell;
  ring_.clear();
  centre_ = centre;
  reach_ = reach;
  const std::size_t n = centre.size();
  inverse_cell_.clear();
  largest_.clear();
  order_.resize(n);
  keyed_.resize(n);
  if (n == 0) return;

  smallest_ = *std::min_element(reach.begin(), reach.end());
  const double largest = *std::max_element(reach.begin(), reach.end());
  largest_.assign(static_cast<std::size_t>(level_of(largest)) + 1, 0.0);
  for (double r : reach) {
    double& most = largest_[static_cast<std::size_t>(level_of(r))];
    most = std::max(most, r);
  }
  for (double most : largest_) inverse_cell_.push_back(most > 0 ? 1 / (2 * most) : 1);
  if (periodic_.any())
    for (double inverse : inverse_cell_) {
      std::array<Ring, 2> rings;
      for (int k = 0; k < 2; ++k) {
        if (!periodic_.along(k)) continue;
        Ring& ring = rings[static_cast<std::size_t>(k)];
        ring.origin = periodic_.lower[k];
        ring.cells = std::max<std::int64_t>(1, BroadPhase::cell(periodic_.length(k), inverse));
        ring.inverse = static_cast<double>(ring.cells) / periodic_.length(k);
      }
      ring_.push_back(rings);
    }

  for (std::size_t i = 0; i < n; ++i) {
    const int level = level_of(reach[i]);
    keyed_[i] = {key(level, cell_of(level, 0, centre[i].x()), cell_of(level, 1, centre[i].y()),
                     cell_of(level, 2, centre[i].z())),
                 static_cast<std::int32_t>(i)};
  }
  std::sort(keyed_.begin(), keyed_.end());

  mask_ = std::bit_ceil(2 * n) - 1;
  table_.assign(mask_ + 1, Slot{});
  for (std::size_t first = 0; first < n;) {
    std::size_t last = first;
    while (last < n && keyed_[last].first == keyed_[first].first) {
      order_[last] = keyed_[last].second;
      ++last;
    }
    std::size_t h = hash(keyed_[first].first);
    while (table_[h].begin != table_[h].end) h = (h + 1) & mask_;
    table_[h] = {keyed_[first].first, static_cast<std::int32_t>(first), static_cast<std::int32_t>(last)};
    first = last;
  }
}

}  // namespace repose::dvi
