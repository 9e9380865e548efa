#pragma once
/// What one batch of contacts does with the bodies: relative velocities, and impulses applied. Included by the solvers only.
#include <algorithm>

#include "backends/dvi/cone.hpp"
#include "backends/dvi/packed_problem.hpp"

namespace repose::dvi {

#define REPOSE_INLINE [[gnu::always_inline]] inline

template <class Real>
struct Frames {
  Lanes<Real> n[3], t1[3], t2[3];
};

template <class Real>
REPOSE_INLINE void cross(const Lanes<Real>* a, const Lanes<Real>* b, Lanes<Real>* c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

template <class Real>
REPOSE_INLINE Lanes<Real> dot(const Lanes<Real>* a, const Lanes<Real>* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Velocities of one side's bodies, one body per lane.
template <class Real>
REPOSE_INLINE void gather_velocity(const BodyVelocity<Real>* bodies, const std::int32_t* index, Lanes<Real>* v,
                                   Lanes<Real>* w) {
  Lanes<Real> x[8];
  load_records<Real>(reinterpret_cast<const Real*>(bodies), index, x);
#pragma GCC unroll 6
  for (int k = 0; k < 3; ++k) {
    v[k] = x[k];
    w[k] = x[k + 4];
  }
}

template <class Real>
REPOSE_INLINE void gather_inverse(const BodyInverse<Real>* bodies, const std::int32_t* index, Lanes<Real>& mass,
                                  Lanes<Real>& lift, Lanes<Real>* inertia) {
  Lanes<Real> x[8];
  load_records<Real>(reinterpret_cast<const Real*>(bodies), index, x);
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) inertia[k] = x[k];
  mass = x[6];
  lift = x[7];
}

/// Stores the lanes whose body can move; the others (prescribed, idle) are shared by many contacts and never change.
template <class Real>
REPOSE_INLINE void scatter_velocity(BodyVelocity<Real>* bodies, std::int32_t dynamic_bodies, const std::int32_t* index,
                                    const Lanes<Real>* v, const Lanes<Real>* w) {
  Lanes<Real> x[8] = {v[0], v[1], v[2], Lanes<Real>{}, w[0], w[1], w[2], Lanes<Real>{}};
  store_records<Real>(reinterpret_cast<Real*>(bodies), dynamic_bodies, index, x);
}

/// y = I x with I = (xx, xy, xz, yy, yz, zz).
template <class Real>
REPOSE_INLINE void multiply_symmetric(const Lanes<Real>* inertia, const Lanes<Real>* x, Lanes<Real>* y) {
  y[0] = inertia[0] * x[0] + inertia[1] * x[1] + inertia[2] * x[2];
  y[1] = inertia[1] * x[0] + inertia[3] * x[1] + inertia[4] * x[2];
  y[2] = inertia[2] * x[0] + inertia[4] * x[1] + inertia[5] * x[2];
}

template <class Real>
REPOSE_INLINE void second_tangent(const Batch<Real>& c, Lanes<Real>* t2) {
  cross<Real>(c.normal, c.tangent, t2);
}

/// u = J v. Rows 3 to 5 only with Rotational. `across`: PackedProblem::across.
template <class Real, bool Rotational>
REPOSE_INLINE void relative_velocity(const Batch<Real>& c, const Lanes<Real>* t2, Real across, const Lanes<Real>* va,
                                     const Lanes<Real>* wa, const Lanes<Real>* vb, const Lanes<Real>* wb, Lanes<Real>* u) {
  Lanes<Real> ca[3], cb[3], d[3];
  cross<Real>(wa, c.arm_a, ca);
  cross<Real>(wb, c.arm_b, cb);
#pragma GCC unroll 6
  for (int k = 0; k < 3; ++k) d[k] = (vb[k] - va[k]) + (cb[k] - ca[k]);
  u[0] = dot<Real>(c.normal, d);
  u[1] = dot<Real>(c.tangent, d);
  u[2] = across * dot<Real>(t2, d);
  if constexpr (Rotational) {
#pragma GCC unroll 6
    for (int k = 0; k < 3; ++k) d[k] = c.arm * (wb[k] - wa[k]);
    u[3] = dot<Real>(c.tangent, d);
    u[4] = dot<Real>(t2, d);
    u[5] = dot<Real>(c.normal, d);
  }
}

/// Force impulse and couple that the rows g amount to, acting on b.
template <class Real, bool Rotational>
REPOSE_INLINE void wrench(const Batch<Real>& c, const Lanes<Real>* t2, Real across, const Lanes<Real>* g,
                          Lanes<Real>* force, Lanes<Real>* couple) {
  const Lanes<Real> g2 = across * g[2];
#pragma GCC unroll 6
  for (int k = 0; k < 3; ++k) {
    force[k] = g[0] * c.normal[k] + g[1] * c.tangent[k] + g2 * t2[k];
    if constexpr (Rotational) {
      couple[k] = c.arm * (g[3] * c.tangent[k] + g[4] * t2[k] + g[5] * c.normal[k]);
    } else {
      couple[k] = Lanes<Real>{};
    }
  }
}

/// v += sign M^-1 J' g for one side. The couple and the force keep their sum over both sides zero by construction.
template <class Real>
REPOSE_INLINE void apply_wrench(Real sign, const Lanes<Real>* arm, const Lanes<Real>& inverse_mass,
                                const Lanes<Real>& lift, const Lanes<Real>* inverse_inertia, const Lanes<Real>* force, const Lanes<Real>* couple,
                                Lanes<Real>* v, Lanes<Real>* w) {
  Lanes<Real> torque[3], dw[3];
  cross<Real>(arm, force, torque);
#pragma GCC unroll 6
  for (int k = 0; k < 3; ++k) torque[k] += couple[k];
  multiply_symmetric<Real>(inverse_inertia, torque, dw);
  const Lanes<Real> s = sign * inverse_mass;
#pragma GCC unroll 6
  for (int k = 0; k < 3; ++k) {
    v[k] += s * force[k];
    w[k] += sign * dw[k];
  }
  v[2] += sign * lift * force[2];
}

/// The normal-row correction of the exact law: mu |u_t| + rho |u_r| + sigma |u_s|.
template <class Real, bool Rotational>
REPOSE_INLINE Lanes<Real> de_saxce(const Batch<Real>& c, const Lanes<Real>* u) {
  Lanes<Real> t = u[1] * u[1] + u[2] * u[2];
  square_root<Real>(t);
  Lanes<Real> s = c.friction * t;
  if constexpr (Rotational) {
    Lanes<Real> r = u[3] * u[3] + u[4] * u[4];
    square_root<Real>(r);
    const Lanes<Real> spin = u[5] < 0 ? -u[5] : u[5];
    s += c.rolling * r + c.spinning * spin;
  }
  return s;
}

/// g <- P_K(g) for the batch's cones, apex shift included.
template <class Real, bool Rotational>
REPOSE_INLINE void project(const Batch<Real>& c, Lanes<Real>* g) {
  Lanes<Real> p = g[0] + c.cohesion;
  if constexpr (Rotational) {
    project_on_cone(p, g[1], g[2], g[3], g[4], g[5], c.friction, c.rolling, c.spinning);
  } else {
    const Lanes<Real> zero{};
    Lanes<Real> r1{}, r2{}, s{};
    project_on_cone(p, g[1], g[2], r1, r2, s, c.friction, zero, zero);
  }
  g[0] = p - c.cohesion;
}

template <class Real>
REPOSE_INLINE double lane_sum(const Lanes<Real>& x) {
  double sum = 0;
  for (int l = 0; l < lane_count<Real>; ++l) sum += static_cast<double>(x[l]);
  return sum;
}

/// u_n += eps g_n where the contacts of batch i give way.
template <class Real>
REPOSE_INLINE void add_compliance(const PackedProblem<Real>& packed, std::size_t i, const Lanes<Real>& normal_impulse,
                                  Lanes<Real>& u) {
  if (!packed.compliance.empty()) u += packed.compliance[i].x * normal_impulse;
}

/// Calls f(std::bool_constant<Rotational>) for the problem's kind.
template <class Real, class F>
auto with_rows(const PackedProblem<Real>& packed, F&& f) {
  return packed.rotational ? f(std::true_type{}) : f(std::false_type{});
}

/// Calls visit(batch) once for every batch, to be called by all of a team: batches that share a body come one after another, in the same
/// order at any thread count.
template <class Real, class Visit>
void each_batch(const PackedProblem<Real>& packed, Visit&& visit) {
  if (packed.blocks() > 0) {  // a shared loop allocates what its threads share, even for nothing
#pragma omp for schedule(dynamic)
    for (int block = 0; block < packed.blocks(); ++block)
      for (std::int32_t i = packed.block_start[static_cast<std::size_t>(block)]; i < packed.block_start[static_cast<std::size_t>(block) + 1]; ++i)
        visit(static_cast<std::size_t>(i));
  }
  for (int colour = packed.first_between; colour < packed.colours(); ++colour) {
    const std::int32_t first = packed.colour_start[static_cast<std::size_t>(colour)];
    const std::int32_t last = packed.colour_start[static_cast<std::size_t>(colour) + 1];
#pragma omp for schedule(static)
    for (std::int32_t i = first; i < last; ++i) visit(static_cast<std::size_t>(i));
  }
}

#undef REPOSE_INLINE

}  // namespace repose::dvi
