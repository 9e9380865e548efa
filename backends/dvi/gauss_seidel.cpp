#include "backends/dvi/gauss_seidel.hpp"

#include "backends/dvi/batch_kernels.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

constexpr int max_passes = 4;            // over one block, within one visit
constexpr int hasty_passes = 1;          // where bodies are so many that a sweep waits for memory, while momentum carries it on
constexpr double block_tolerance = 0.3;  // of the first change: the next sweep finds the rest

template <class Real>
using V = Lanes<Real>;

/// u += W e_i d for the block's own rows.
template <class Real, int Rows>
[[gnu::always_inline]] inline void add_column(const Batch<Real>& c, int i, const V<Real>& d, V<Real>* u) {
#pragma GCC unroll 6
  for (int k = 0; k < Rows; ++k) u[k] += c.w[block_index(i, k)] * d;
}

/// Largest eigenvalue of a symmetric 2 x 2 block: the step at which a projected step on a disc cannot overshoot.
template <class Real>
[[gnu::always_inline]] inline V<Real> inverse_top_eigenvalue(const V<Real>& a, const V<Real>& b, const V<Real>& d) {
  const V<Real> mean = Real(0.5) * (a + d), half = Real(0.5) * (a - d);
  V<Real> root = half * half + b * b;
  square_root<Real>(root);
  return Real(1) / (mean + root);
}

/// Projected step of two rows on the disc of radius `limit`. Returns the squared change.
template <class Real, int Rows>
[[gnu::always_inline]] inline V<Real> disc_step(const Batch<Real>& c, int i, const V<Real>& inverse,
                                                const V<Real>& limit, V<Real>* g, V<Real>* u) {
  V<Real> x = g[i] - inverse * u[i], y = g[i + 1] - inverse * u[i + 1];
  V<Real> length = x * x + y * y;
  square_root<Real>(length);
  const V<Real> one = fill<Real>(1);
  const V<Real> shorten = length > limit ? limit / length : one;
  x = x * shorten - g[i];
  y = y * shorten - g[i + 1];
  g[i] += x;
  g[i + 1] += y;
  add_column<Real, Rows>(c, i, x, u);
  add_column<Real, Rows>(c, i + 1, y, u);
  return x * x + y * y;
}

template <class Real>
[[gnu::always_inline]] inline bool any_above(const V<Real>& x, const V<Real>& y) {
  bool above = false;
  for (int l = 0; l < lane_count<Real>; ++l) above |= x[l] > y[l];
  return above;
}

/// Solves the block for g, given u at g. Both are updated.
template <class Real, bool Rotational>
[[gnu::always_inline]] inline void solve_block_exact(const Batch<Real>& c, int passes, V<Real>* g, V<Real>* u) {
  constexpr int rows = Rotational ? 6 : 3;
  const V<Real> zero{};
  const V<Real> inverse_n = Real(1) / c.w[block_index(0, 0)];
  const V<Real> inverse_t =
      inverse_top_eigenvalue<Real>(c.w[block_index(1, 1)], c.w[block_index(1, 2)], c.w[block_index(2, 2)]);
  V<Real> inverse_r{}, inverse_s{};
  if constexpr (Rotational) {
    inverse_r = inverse_top_eigenvalue<Real>(c.w[block_index(3, 3)], c.w[block_index(3, 4)], c.w[block_index(4, 4)]);
    inverse_s = Real(1) / c.w[block_index(5, 5)];
  }
  // Where friction turns into normal velocity (mu or rho near 1, contacts off the centre) the pressure may swing between
  // two values for ever: each swing that does not fade halves its step.
  V<Real> first{}, before{}, share = fill<Real>(1);
  const V<Real> half = fill<Real>(Real(0.5));
  for (int pass = 0; pass < passes; ++pass) {
    const V<Real> p_old = g[0] + c.cohesion;
    V<Real> p = p_old - inverse_n * u[0];
    p = p > zero ? p : zero;
    V<Real> d = p - p_old;
    share = d * before < -half * before * before ? half * share : share;
    d = share * d;
    p = p_old + d;
    before = d;
    g[0] += d;
    add_column<Real, rows>(c, 0, d, u);
    V<Real> change = d * d;
    change += disc_step<Real, rows>(c, 1, inverse_t, c.friction * p, g, u);
    if constexpr (Rotational) {
      change += disc_step<Real, rows>(c, 3, inverse_r, c.rolling * p, g, u);
      const V<Real> limit = c.spinning * p;
      V<Real> s = g[5] - inverse_s * u[5];
      s = s > limit ? limit : s;
      s = s < -limit ? -limit : s;
      s -= g[5];
      g[5] += s;
      add_column<Real, rows>(c, 5, s, u);
      change += s * s;
    }
    if (pass == 0) {
      first = change * Real(block_tolerance * block_tolerance);
    } else if (!any_above<Real>(change, first)) {
      break;
    }
  }
}

template <class Real, bool Rotational>
[[gnu::always_inline]] inline void solve_block_relaxed(const Batch<Real>& c, int passes, V<Real>* g, V<Real>* u) {
  constexpr int rows = Rotational ? 6 : 3;
  // The trace bounds the largest eigenvalue of a positive semidefinite block.
  V<Real> trace{};
#pragma GCC unroll 6
  for (int k = 0; k < rows; ++k) trace += c.w[block_index(k, k)];
  const V<Real> inverse = Real(1) / trace;
  for (int pass = 0; pass < passes; ++pass) {
    V<Real> x[6];
#pragma GCC unroll 6
    for (int k = 0; k < rows; ++k) x[k] = g[k] - inverse * u[k];
    project<Real, Rotational>(c, x);
#pragma GCC unroll 6
    for (int k = 0; k < rows; ++k) {
      const V<Real> d = x[k] - g[k];
      g[k] = x[k];
      add_column<Real, rows>(c, k, d, u);
    }
  }
}

template <class Real, bool Rotational, bool Exact>
void visit(PackedProblem<Real>& packed, std::size_t batch, Real relaxation, int passes) {
  Batch<Real>& c = packed.batches[batch];
  constexpr int rows = Rotational ? 6 : 3;
  V<Real> va[3], wa[3], vb[3], wb[3], t2[3], u[6], g[6], force[3], couple[3], mass, lift, inertia[6];
  gather_velocity<Real>(packed.velocity.data(), c.a, va, wa);
  gather_velocity<Real>(packed.velocity.data(), c.b, vb, wb);
  second_tangent<Real>(c, t2);
  relative_velocity<Real, Rotational>(c, t2, packed.across, va, wa, vb, wb, u);
  u[0] += c.bias;
  add_compliance<Real>(packed, batch, c.impulse[0], u[0]);
#pragma GCC unroll 6
  for (int k = 0; k < rows; ++k) g[k] = c.impulse[k];
  if constexpr (Exact) {
    solve_block_exact<Real, Rotational>(c, passes, g, u);
  } else {
    solve_block_relaxed<Real, Rotational>(c, passes, g, u);
  }
#pragma GCC unroll 6
  for (int k = 0; k < rows; ++k) g[k] = c.impulse[k] + relaxation * (g[k] - c.impulse[k]);
#pragma GCC unroll 6
  for (int k = 0; k < rows; ++k) {
    const V<Real> d = g[k] - c.impulse[k];
    c.impulse[k] = g[k];
    g[k] = d;
  }
  wrench<Real, Rotational>(c, t2, packed.across, g, force, couple);
  gather_inverse<Real>(packed.inverse.data(), c.a, mass, lift, inertia);
  apply_wrench<Real>(Real(-1), c.arm_a, mass, lift, inertia, force, couple, va, wa);
  scatter_velocity<Real>(packed.velocity.data(), packed.dynamic_bodies, c.a, va, wa);
  gather_inverse<Real>(packed.inverse.data(), c.b, mass, lift, inertia);
  apply_wrench<Real>(Real(1), c.arm_b, mass, lift, inertia, force, couple, vb, wb);
  scatter_velocity<Real>(packed.velocity.data(), packed.dynamic_bodies, c.b, vb, wb);
}

template <class Real, bool Rotational, bool Exact>
void sweep(PackedProblem<Real>& packed, int sweeps, Real relaxation, Momentum<Real>* momentum, int threads) {
  const int passes = Exact && momentum != nullptr && packed.blocks() > 0 ? hasty_passes : max_passes;
  on_team(threads, [&] {
    for (int s = 0; s < sweeps; ++s) {
      each_batch(packed, [&](std::size_t i) {
        if (momentum != nullptr) momentum->move_on(packed.batches[i], i, Rotational ? 6 : 3);
        visit<Real, Rotational, Exact>(packed, i, relaxation, passes);
      });
      if (momentum == nullptr) continue;
      const bool move = s + 1 < sweeps;  // what is handed out stays in the cones
#pragma omp for schedule(static)
      for (std::ptrdiff_t block = 0; block < momentum->blocks(); ++block) momentum->move_bodies_on(packed, block, move);
#pragma omp single
      momentum->advance(move);
    }
  });
}

}  // namespace

template <class Real>
void gauss_seidel(PackedProblem<Real>& packed, ContactLaw law, int sweeps, double relaxation, Momentum<Real>* momentum,
                  int threads) {
  with_rows(packed, [&](auto rotational) {
    constexpr bool rows = decltype(rotational)::value;
    if (law == ContactLaw::exact) {
      sweep<Real, rows, true>(packed, sweeps, static_cast<Real>(relaxation), momentum, threads);
    } else {
      sweep<Real, rows, false>(packed, sweeps, static_cast<Real>(relaxation), momentum, threads);
    }
  });
}

template void gauss_seidel(PackedProblem<double>&, ContactLaw, int, double, Momentum<double>*, int);
template void gauss_seidel(PackedProblem<float>&, ContactLaw, int, double, Momentum<float>*, int);

}  // namespace repose::dvi
