#pragma once
/// Pairs of balls that may touch, in time linear in their number for any mixture of sizes.
///
/// A hierarchy of uniform grids: a ball goes into the grid whose cells are between one and four of its diameters wide, so that the
/// grains of one powder share a grid and stay neighbours in the order; it looks for partners in its own and in all coarser grids. A
/// cell holds up to some 64 of the finest, whose distances are cheap beside their contacts. The balls are sorted by level and along a
/// Morton curve. Along a periodic axis the cells of every grid divide the period, and the distance is that of the nearest images.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math.hpp"
#include "core/periodic.hpp"

namespace repose::dvi {

class BroadPhase {
 public:
  /// `reach`: radius of each ball, search margin included, > 0. Finite input only. `cell`: in the unit of the centres.
  void build(std::span<const Vec3> centre, std::span<const double> reach, const PeriodicCell& cell = {}, int threads = 1);

  /// The balls in spatial order.
  std::span<const std::int32_t> order() const { return order_; }

  /// Calls visit(r) once for the rank r of every ball that overlaps the one at `rank` and comes later in the order. In a
  /// fixed sequence.
  template <class Visit>
  void partners(std::size_t rank, Visit&& visit) const {
    if (periodic_.any())
      partners_among<true>(rank, visit);
    else
      partners_among<false>(rank, visit);
  }

 private:
  template <bool periodic, class Visit>
  void partners_among(std::size_t rank, Visit& visit) const {
    const Ball& ball = ball_[rank];
    for (int level = level_of(ball.reach); level < levels(); ++level) {
      const double inverse = inverse_cell_[static_cast<std::size_t>(level)];
      const double range = ball.reach + largest_[static_cast<std::size_t>(level)];
      if (!(range > ball.reach)) continue;  // no ball at this level
      std::int64_t low[3], high[3];
      bool whole_ring = false;
      for (int k = 0; k < 3; ++k) {
        if (periodic && periodic_.along(k)) {
          const Ring& ring = ring_of(level, k);
          low[k] = ring.step(ball.centre[k] - range);
          high[k] = ring.step(ball.centre[k] + range);
          if (high[k] - low[k] < ring.cells) continue;
          low[k] = 0, high[k] = ring.cells - 1;  // each cell once
          whole_ring = true;
        } else {
          low[k] = cell(ball.centre[k] - range, inverse);
          high[k] = cell(ball.centre[k] + range, inverse);
        }
      }
      Vec3 from = ball.centre;
      const Grid& grid = grid_[static_cast<std::size_t>(level)];
      for (int k = 0; k < 3; ++k) {
        if (grid.sparse || (periodic && periodic_.along(k))) continue;
        low[k] = std::max(low[k], grid.low[k]);
        high[k] = std::min(high[k], grid.low[k] + grid.size[k] - 1);
      }
      for (std::int64_t cz = low[2]; cz <= high[2]; ++cz)
        for (std::int64_t cy = low[1]; cy <= high[1]; ++cy) {
          const std::int64_t y = periodic ? around(level, 1, cy, ball, from) : cy;
          for (std::int64_t cx = low[0]; cx <= high[0]; ++cx) {
            const std::int64_t x = periodic ? around(level, 0, cx, ball, from) : cx;
            const Ranks cell = grid.sparse ? find(key(level, x, y, cz)) : dense_[grid.place(x, y, cz)];
            for (auto r = std::max(static_cast<std::size_t>(cell.begin), rank + 1); r < static_cast<std::size_t>(cell.end); ++r) {
              const Ball& other = ball_[r];
              const double both = ball.reach + other.reach;
              Vec3 apart = other.centre - from;
              if (periodic && whole_ring) apart += periodic_.to_nearest(apart);
              if (apart.squaredNorm() < both * both) visit(r);
            }
          }
        }
    }
  }

  struct Ball {
    Vec3 centre;  ///< its image in the cell
    double reach;
  };

  /// The cells of one grid along a periodic axis.
  struct Ring {
    double origin = 0, inverse = 1;
    std::int64_t cells = 1;
    std::int64_t step(double x) const { return cell(x - origin, inverse); }
    std::int64_t around(std::int64_t step) const {
      const std::int64_t left = step % cells;
      return left < 0 ? left + cells : left;
    }
  };
  const Ring& ring_of(int level, int axis) const {
    return ring_[static_cast<std::size_t>(level)][static_cast<std::size_t>(axis)];
  }
  /// The cell in the ring that stands for the step-th one, and in `from` the image of the ball that sees it there.
  std::int64_t around(int level, int axis, std::int64_t step, const Ball& ball, Vec3& from) const {
    if (!periodic_.along(axis)) return step;
    const std::int64_t inside = ring_of(level, axis).around(step);
    from[axis] = ball.centre[axis];
    if (inside != step) from[axis] += inside < step ? -periodic_.length(axis) : periodic_.length(axis);
    return inside;
  }
  struct Ranks {
    std::int32_t begin = 0, end = 0;  ///< none: begin == end
  };
  /// The cells of a level from the lowest to the highest that holds a ball, in `dense_`; where that would be many more cells than
  /// balls, the few that hold one are in `table_`.
  struct Grid {
    std::int64_t low[3], size[3];
    std::size_t first = 0;  ///< of its cells in `dense_`
    bool sparse = false;
    std::size_t place(std::int64_t x, std::int64_t y, std::int64_t z) const {
      return first + static_cast<std::size_t>((x - low[0]) + size[0] * ((y - low[1]) + size[1] * (z - low[2])));
    }
  };
  struct Slot {
    std::uint64_t key = 0;
    Ranks ranks;  ///< none: an empty slot
  };
  using Cell = std::array<std::int64_t, 3>;

  static std::int64_t cell(double x, double inverse);
  static std::uint64_t key(int level, std::int64_t x, std::int64_t y, std::int64_t z);
  int level_of(double reach) const;
  int levels() const { return static_cast<int>(inverse_cell_.size()); }
  Cell cell_of(int level, const Vec3& centre) const;
  void lay_out_grids(const std::vector<Cell>& lowest, const std::vector<Cell>& highest);
  void enter(std::uint64_t key, const Ranks& ranks);
  Ranks find(std::uint64_t key) const {
    for (std::size_t h = hash(key);; h = (h + 1) & mask_) {
      const Slot& slot = table_[h];
      if (slot.key == key || slot.ranks.begin == slot.ranks.end) return slot.ranks;
    }
  }
  std::size_t hash(std::uint64_t k) const {
    k ^= k >> 31;
    k *= 0x9e3779b97f4a7c15ull;
    return static_cast<std::size_t>(k >> 20) & mask_;
  }

  std::vector<Ball> ball_;  // by rank
  PeriodicCell periodic_;
  std::vector<std::array<Ring, 2>> ring_;  // per level, along x and y; empty if not periodic
  double smallest_ = 1;
  std::vector<double> inverse_cell_, largest_;  // per level
  std::vector<Cell> cell_;     // by ball
  std::vector<std::int32_t> order_;
  std::vector<Grid> grid_;     // per level
  std::vector<Ranks> dense_;
  std::vector<Slot> table_;
  std::size_t mask_ = 0;
  std::vector<std::pair<std::uint64_t, std::int32_t>> keyed_;
};

}  // namespace repose::dvi
