#include "backends/dvi/broad_phase.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

constexpr int coordinate_bits = 19;
constexpr std::size_t cells_per_ball = 8;
constexpr int octaves = 2;     // of size that share a grid
constexpr int max_level = 31;  // sizes beyond 2^62 : 1 share the last grid

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

/// For one element or more, no two of them equal: the order is the same at any thread count.
template <class T>
void sort_side_by_side(int threads, std::vector<T>& all) {
  const std::size_t n = all.size(), part = threads > 1 ? n / static_cast<std::size_t>(threads) + 1 : n;
  const auto at = [&](std::size_t i) { return all.begin() + static_cast<std::ptrdiff_t>(std::min(i, n)); };
  const std::size_t parts = (n + part - 1) / part;
  for_each_index(threads, parts, [&](std::size_t k) { std::sort(at(k * part), at((k + 1) * part)); });
  for (std::size_t width = part; width < n; width *= 2)
    for_each_index(threads, (n + 2 * width - 1) / (2 * width),
                   [&](std::size_t k) { std::inplace_merge(at(2 * k * width), at((2 * k + 1) * width), at((2 * k + 2) * width)); });
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
  return std::clamp(std::ilogb(reach / smallest_) / octaves, 0, max_level);
}

BroadPhase::Cell BroadPhase::cell_of(int level, const Vec3& centre) const {
  Cell at;
  for (int k = 0; k < 3; ++k) {
    std::int64_t& step = at[static_cast<std::size_t>(k)];
    if (periodic_.along(k)) {
      const Ring& ring = ring_of(level, k);
      step = std::clamp<std::int64_t>(ring.step(centre[k]), 0, ring.cells - 1);  // may be rounded out of the cell that it lies in
    } else {
      step = cell(centre[k], inverse_cell_[static_cast<std::size_t>(level)]);
    }
  }
  return at;
}

void BroadPhase::lay_out_grids(const std::vector<Cell>& lowest, const std::vector<Cell>& highest) {
  const std::size_t most = cells_per_ball * ball_.size() + 64;
  grid_.assign(static_cast<std::size_t>(levels()), {});
  std::size_t all = 0;
  for (std::size_t level = 0; level < grid_.size(); ++level) {
    Grid& grid = grid_[level];
    grid.first = all;
    double cells = 1;
    bool unambiguous = true;  // cells as far apart as a key can hold share one
    for (std::size_t k = 0; k < 3; ++k) {
      const bool ring = periodic_.along(static_cast<int>(k));
      grid.low[k] = ring ? 0 : lowest[level][k];
      grid.size[k] = (ring ? ring_of(static_cast<int>(level), static_cast<int>(k)).cells : highest[level][k] + 1) - grid.low[k];
      cells *= std::max<double>(0, static_cast<double>(grid.size[k]));
      unambiguous = unambiguous && grid.size[k] <= (std::int64_t{1} << coordinate_bits);
    }
    grid.sparse = cells > static_cast<double>(most) || !unambiguous;
    if (!grid.sparse) all += static_cast<std::size_t>(cells);
  }
  dense_.assign(all, {});
}

void BroadPhase::enter(std::uint64_t key, const Ranks& ranks) {
  if (table_.empty()) {
    mask_ = std::bit_ceil(2 * ball_.size()) - 1;
    table_.assign(mask_ + 1, Slot{});
  }
  std::size_t h = hash(key);
  while (table_[h].ranks.begin != table_[h].ranks.end) h = (h + 1) & mask_;
  table_[h] = {key, ranks};
}

void BroadPhase::build(std::span<const Vec3> centre, std::span<const double> reach, const PeriodicCell& cell, int threads) {
  periodic_ = cell;
  ring_.clear();
  const std::size_t n = centre.size();
  inverse_cell_.clear();
  largest_.clear();
  order_.resize(n);
  keyed_.resize(n);
  ball_.resize(n);
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

  constexpr std::int64_t far = std::numeric_limits<std::int64_t>::max() / 4;
  std::vector<Cell> lowest(largest_.size(), Cell{far, far, far}), highest(largest_.size(), Cell{-far, -far, -far});
  cell_.resize(n);
  for_each_index(threads, n, [&](std::size_t i) {
    const int level = level_of(reach[i]);
    cell_[i] = cell_of(level, periodic_.wrapped(centre[i]));
    keyed_[i] = {key(level, cell_[i][0], cell_[i][1], cell_[i][2]), static_cast<std::int32_t>(i)};
  });
  for (std::size_t i = 0; i < n; ++i) {
    const auto level = static_cast<std::size_t>(level_of(reach[i]));
    for (std::size_t k = 0; k < 3; ++k) {
      lowest[level][k] = std::min(lowest[level][k], cell_[i][k]);
      highest[level][k] = std::max(highest[level][k], cell_[i][k]);
    }
  }
  sort_side_by_side(threads, keyed_);
  lay_out_grids(lowest, highest);
  table_.clear();

  for (std::size_t first = 0; first < n;) {
    std::size_t last = first;
    while (last < n && keyed_[last].first == keyed_[first].first) {
      const auto i = static_cast<std::size_t>(keyed_[last].second);
      order_[last] = keyed_[last].second;
      ball_[last] = {periodic_.wrapped(centre[i]), reach[i]};
      ++last;
    }
    const int level = level_of(ball_[first].reach);
    const Ranks ranks{static_cast<std::int32_t>(first), static_cast<std::int32_t>(last)};
    const Grid& grid = grid_[static_cast<std::size_t>(level)];
    if (grid.sparse) {
      enter(keyed_[first].first, ranks);
    } else {
      const Cell& at = cell_[static_cast<std::size_t>(keyed_[first].second)];
      dense_[grid.place(at[0], at[1], at[2])] = ranks;
    }
    first = last;
  }
}

}  // namespace repose::dvi
