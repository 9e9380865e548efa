#include "backends/dvi/momentum.hpp"

#include <algorithm>

#include "backends/dvi/batch_kernels.hpp"
#include "backends/dvi/resize.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

constexpr std::size_t block_batches = 64;
constexpr double highest_cap = 0.8, lowered = 0.7, raised = 0.02;

std::size_t share(std::size_t n, std::ptrdiff_t block, std::ptrdiff_t blocks) {
  return n * static_cast<std::size_t>(block) / static_cast<std::size_t>(blocks);
}

}  // namespace

template <class Real>
void Momentum<Real>::begin(const PackedProblem<Real>& packed, int threads) {
  resize_sparingly(rows_, packed.batches.size());
  motion_.resize(static_cast<std::size_t>(packed.dynamic_bodies));
  turn_.resize((packed.batches.size() + block_batches - 1) / block_batches);
  cap_ = highest_cap;
  age_ = beta_ = applied_ = 0;
  for_each_index(threads, rows_.size(), [&](std::size_t i) {
    for (int k = 0; k < 6; ++k) rows_[i].last[k] = packed.batches[i].impulse[k];
  });
  for_each_index(threads, motion_.size(), [&](std::size_t i) {
    for (int k = 0; k < 3; ++k) {
      motion_[i].last[k] = packed.velocity[i].linear[k];
      motion_[i].last[k + 3] = packed.velocity[i].angular[k];
      motion_[i].change[k] = motion_[i].change[k + 3] = 0;
    }
  });
}

template <class Real>
void Momentum<Real>::move_bodies_on(PackedProblem<Real>& packed, std::ptrdiff_t block, bool move) {
  const auto beta = static_cast<Real>(move ? beta_ : 0.0);
  Turn turn;
  for (std::size_t i = share(motion_.size(), block, blocks()); i < share(motion_.size(), block + 1, blocks()); ++i) {
    Motion& motion = motion_[i];
    Real with = 0, size = 0;
    const auto move_one = [&](int k, Real& velocity) {
      const Real now = velocity, change = now - motion.last[k];
      with += change * motion.change[k];
      size += change * change;
      velocity += beta * change;
      motion.last[k] = now;
      motion.change[k] = change;
    };
    for (int k = 0; k < 3; ++k) move_one(k, packed.velocity[i].linear[k]);
    // Linear parts alone: with the mass they are an energy.
    const Real inverse = packed.inverse[i].mass + packed.inverse[i].lift;
    turn.with += static_cast<double>(with / inverse);
    turn.size += static_cast<double>(size / inverse);
    for (int k = 0; k < 3; ++k) move_one(k + 3, packed.velocity[i].angular[k]);
  }
  turn_[static_cast<std::size_t>(block)] = turn;
}

template <class Real>
void Momentum<Real>::advance(bool move) {
  Turn total;
  for (const Turn& turn : turn_) {
    total.with += turn.with;
    total.size += turn.size;
  }
  // (y - g_{k+1}) . (g_{k+1} - g_k) > 0, with y - g_{k+1} = beta change_k - change_{k+1}.
  age_ = applied_ * total.with > total.size ? 0 : age_ + 1;
  applied_ = move ? beta_ : 0;
  beta_ = std::min(cap_, age_ / (age_ + 2));
}

template <class Real>
void Momentum<Real>::falter() {
  cap_ *= lowered;
  age_ = 0;
  beta_ = 0;
}

template <class Real>
void Momentum<Real>::recover() {
  cap_ = std::min(highest_cap, cap_ + raised);
}

template class Momentum<double>;
template class Momentum<float>;

}  // namespace repose::dvi
