#pragma once
/// Friction that follows the slip which the impulses leave: the coefficients of a packed problem, renewed between
/// sweeps.
///
/// For each contact with slip s, friction impulse |g_t| and pressure p at present, W_tt its inverse mass along the
/// tangent,
///   mu = mu(max(0, s + W_tt (|g_t| - mu p)))
/// is solved for mu: what the contact would do alone if its limit changed to mu p. Both sides are monotone (slope > 0),
/// so there is one root; at the solution of the whole problem |g_t| = mu p or s = 0, and the equation is the law
/// itself.
#include "backends/dvi/packed_problem.hpp"

namespace repose::dvi {

/// Does nothing if the problem has no slip law. The residual of the result counts what has changed.
template <class Real>
void renew_friction(PackedProblem<Real>& packed, const ConeProblem& problem, int threads);

}  // namespace repose::dvi
