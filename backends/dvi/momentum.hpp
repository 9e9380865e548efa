#pragma once
/// Momentum for Gauss-Seidel sweeps: each sweep starts from an extrapolation of the last two results (Nesterov 1983),
///   y = g_k + beta (g_k - g_{k-1}),   beta = min(cap, age / (age + 2)),
/// for impulses and velocities alike, which keeps v = v_free + M^-1 J'g. Errors that stretch over many grains, which
/// sweeps hand on from neighbour to neighbour, die out in a third to a half of the sweeps.
///
/// The age falls to zero when the sweeps no longer go where the momentum points (O'Donoghue & Candes 2015). The exact
/// law is no minimisation, so momentum may also feed a cycle: `falter` lowers the cap when the residual has risen.
#include <vector>

#include "backends/dvi/packed_problem.hpp"

namespace repose::dvi {

template <class Real>
class Momentum {
 public:
  /// Starts at rest from what the problem holds. To be called before all else; the room of an earlier problem serves again.
  void begin(const PackedProblem<Real>& packed, int threads);

  std::size_t bytes() const { return rows_.size() * sizeof(Rows) + motion_.size() * sizeof(Motion); }
  /// Takes note of the impulses of a batch, which the last sweep has left, and moves them on to where this sweep starts. To be
  /// called as the sweep comes to the batch, which is then in the cache anyway.
  [[gnu::always_inline]] void move_on(Batch<Real>& c, std::size_t batch, int rows) {
    const auto beta = static_cast<Real>(applied_);
    Rows& of_batch = rows_[batch];
#pragma GCC unroll 6
    for (int k = 0; k < rows; ++k) {
      const Lanes<Real> now = c.impulse[k];
      c.impulse[k] += beta * (now - of_batch.last[k]);
      of_batch.last[k] = now;
    }
  }
  /// Blocks of bodies that `move_bodies_on` may share among threads.
  std::ptrdiff_t blocks() const { return static_cast<std::ptrdiff_t>(turn_.size()); }
  /// Likewise the velocities of one block of bodies, right after a sweep; unless `move`, which says that another sweep
  /// follows: a result that is handed out stays in the cones.
  void move_bodies_on(PackedProblem<Real>& packed, std::ptrdiff_t block, bool move);
  /// To be called once after all blocks, with the same `move`: chooses the next beta.
  void advance(bool move);
  /// The residual has risen since the last look.
  void falter();
  /// The residual has fallen since the last look.
  void recover();

 private:
  struct alignas(lane_bytes) Rows {
    Lanes<Real> last[6];
  };
  struct Motion {
    Real last[6], change[6];
  };
  struct Turn {
    double with = 0;  ///< change_k . change_{k-1} of the velocities, weighted with the masses: an energy
    double size = 0;  ///< |change_k|^2
  };
  std::vector<Rows> rows_;      ///< per batch
  std::vector<Motion> motion_;  ///< per dynamic body
  std::vector<Turn> turn_;      ///< per block, added in order: the same bits at any thread count
  double cap_ = 0, age_ = 0;
  double beta_ = 0;     ///< of the next extrapolation
  double applied_ = 0;  ///< of the one before, which the impulses have still to follow
};

}  // namespace repose::dvi
