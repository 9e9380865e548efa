#pragma once
/// Coloured block Gauss-Seidel: contact after contact, the 6 x 6 block solved with the others held.
///
/// Exact law: normal, sliding, rolling and spinning parts are solved in turn, each exactly for given others, until the
/// block stands, or once where a sweep waits for memory anyway (normal: p >= 0; the friction parts: the disc of radius mu p, rho p, sigma p). The normal row sees u_n
/// alone, which *is* the exact law; no correction term is needed. Relaxed law: projected steps on the whole cone.
#include "backends/dvi/momentum.hpp"
#include "core/world.hpp"

namespace repose::dvi {

/// `sweeps` times through all contacts. `relaxation` in (0, 1]: the share of each block's change that is applied; below
/// 1 it breaks cycles. `momentum` may be null. Same result at any thread count.
template <class Real>
void gauss_seidel(PackedProblem<Real>& packed, ContactLaw law, int sweeps, double relaxation, Momentum<Real>* momentum,
                  int threads);

}  // namespace repose::dvi
