#pragma once
/// Coloured block Gauss-Seidel: contact after contact, the 6 x 6 block solved to tolerance with the others held.
///
/// Exact law: normal, sliding, rolling and spinning parts are solved in turn, each exactly for given others, until the block
/// stands (normal: p >= 0; the friction parts: the disc of radius mu p, rho p, sigma p). The normal row sees u_n alone, which
/// *is* the exact law; no correction term is needed. Relaxed law: projected steps on the whole cone.
#include "backends/dvi/packed_problem.hpp"
#include "core/world.hpp"

namespace repose::dvi {

/// `sweeps` times through all contacts. `relaxation` in (0, 2): the share of each block's change that is applied. Above 1 it
/// speeds up large problems (the impulse is then returned to the cone), below 1 it breaks cycles. Same result at any thread
/// count.
template <class Real>
void gauss_seidel(PackedProblem<Real>& packed, ContactLaw law, int sweeps, double relaxation, int threads);

}  // namespace repose::dvi
