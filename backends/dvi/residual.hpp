#pragma once
/// The one residual of all solvers: the natural map of the law, per contact and scaled.
///
///   r_i = g_i - P_K( g_i - (u_i + e_n (bias + correction)) / l_i ),   l_i = W_nn of the contact
///   residual = sqrt( sum l_i |r_i|^2 ) / sqrt( sum l_i |g_i|^2 )
///
/// (l |g|^2 is an energy, so contacts of light and heavy bodies count alike). Zero at a solution, and where the numerator is no more than the rounding of the
/// contacts' own relative velocities: contacts that slide without pressure leave nothing else. The correction is that of the exact law, or nothing for the
/// relaxed one. The denominator is kept above the rounding error of the velocities.
#include "backends/dvi/packed_problem.hpp"
#include "core/world.hpp"

namespace repose::dvi {

template <class Real>
double residual(const PackedProblem<Real>& packed, ContactLaw law, int threads);

}  // namespace repose::dvi
