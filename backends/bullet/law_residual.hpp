#pragma once
/// The residual of the exact law for given impulses and velocities: the measure of backends/dvi/residual.hpp, contact by
/// contact, for solvers that keep their own layout.
#include <span>

#include "backends/dvi/cone_problem.hpp"

namespace repose::bullet {

/// sqrt(sum l |g - P_K(g - (u + e_n (bias + correction)) / l)|^2) / sqrt(sum l |g|^2), l = W_nn of the contact; the
/// denominator is kept above the rounding error of the velocities.
double law_residual(const dvi::ConeProblem& problem, std::span<const dvi::Impulse> impulse,
                    std::span<const Vec3> velocity, std::span<const Vec3> angular_velocity);

}  // namespace repose::bullet
