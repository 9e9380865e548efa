#pragma once
/// Pairs of balls that may touch, in time linear in their number for any mixture of sizes.
///
/// A hierarchy of uniform grids: a ball goes into the grid whose cells are between one and two of its diameters wide, and
/// looks for partners in its own and in all coarser grids. The balls are sorted by level and along a Morton curve. Along a
/// periodic axis the cells of every grid divide the period, and the distance is that of the nearest images.
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
  void build(std::span<const Vec3> centre, std::span<const double> reach, const PeriodicCell& cell = {});

  /// The balls in spatial order.
  std::span<const std::int32_t> order() const { return order_; }

  /// Calls visit(j) once for every ball j whose ball overlaps that of the one at `rank` of the order, and which comes
  /// later in the order. In a fixed sequence.
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
    const std::int32_t i = order_[rank];
    const Vec3& x = centre_[static_cast<std::size_t>(i)];
    const double reach = reach_[static_cast<std::size_t>(i)];
    for (int level = level_of(reach); level < levels(); ++level) {
      const double inverse = inverse_cell_[static_cast<std::size_t>(level)];
      const double range = reach + largest_[static_cast<std::size_t>(level)];
      if (!(range > reach)) continue;  // no ball at this level
      std::int64_t low[3], high[3];
      for (int k = 0; k < 3; ++k) {
        if (periodic && periodic_.along(k)) {
          const Ring& ring = ring_of(level, k);
          low[k] = ring.step(x[k] - range);
          high[k] = ring.step(x[k] + range);
          if (high[k] - low[k] >= ring.cells) low[k] = 0, high[k] = ring.cells - 1;  // each cell once
        } else {
          low[k] = cell(x[k] - range, inverse);
          high[k] = cell(x[k] + range, inverse);
        }
      }
      for (std::int64_t cz = low[2]; cz <= high[2]; ++cz)
        for (std::int64_t cy = low[1]; cy <= high[1]; ++cy)
          for (std::int64_t cx = low[0]; cx <= high[0]; ++cx) {
            const Slot* slot = find(periodic ? key(level, around(level, 0, cx), around(level, 1, cy), cz)
                                             : key(level, cx, cy, cz));
            if (!slot) continue;
            for (std::int32_t r = slot->begin; r < slot->end; ++r) {
              if (static_cast<std::size_t>(r) <= rank) continue;
              const std::int32_t j = order_[static_cast<std::size_t>(r)];
              const double both = reach + reach_[static_cast<std::size_t>(j)];
              Vec3 apart = centre_[static_cast<std::size_t>(j)] - x;
              if (periodic) apart += periodic_.to_nearest(apart);
              if (apart.squaredNorm() < both * both) visit(j);
            }
          }
    }
  }

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
  std::int64_t around(int level, int axis, std::int64_t step) const {
    return periodic_.along(axis) ? ring_of(level, axis).around(step) : step;
  }
  std::int64_t cell_of(int level, int axis, double x) const;

  struct Slot {
    std::uint64_t key = 0;
    std::int32_t begin = 0, end = 0;  ///< ranks; empty slot: begin == end
  };

  static std::int64_t cell(double x, double inverse);
  static std::uint64_t key(int level, std::int64_t x, std::int64_t y, std::int64_t z);
  int level_of(double reach) const;
  int levels() const { return static_cast<int>(inverse_cell_.size()); }
  const Slot* find(std::uint64_t key) const {
    for (std::size_t h = hash(key);; h = (h + 1) & mask_) {
      const Slot& slot = table_[h];
      if (slot.begin == slot.end) return nullptr;
      if (slot.key == key) return &slot;
    }
  }
  std::size_t hash(std::uint64_t k) const {
    k ^= k >> 31;
    k *= 0x9e3779b97f4a7c15ull;
    return static_cast<std::size_t>(k >> 20) & mask_;
  }

  std::span<const Vec3> centre_;
  std::span<const double> reach_;
  PeriodicCell periodic_;
  std::vector<std::array<Ring, 2>> ring_;  // per level, along x and y; empty if not periodic
  double smallest_ = 1;
  std::vector<double> inverse_cell_, largest_;  // per level
  std::vector<std::int32_t> order_;
  std::vector<Slot> table_;
  std::size_t mask_ = 0;
  std::vector<std::pair<std::uint64_t, std::int32_t>> keyed_;
};

}  // namespace repose::dvi
