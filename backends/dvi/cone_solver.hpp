#pragma once
/// Solves a cone problem with the chosen method, and says how far it got.
#include <memory>
#include <span>
#include <vector>

#include "backends/dvi/cone_problem.hpp"
#include "core/world.hpp"

namespace repose::dvi {

struct SolveReport {
  int iterations = 0;       ///< Gauss-Seidel sweeps, or products with N
  double residual = 0;      ///< of the exact (or the chosen) law: residual.hpp
  bool converged = true;
  bool cycling = false;     ///< the fixed point did not settle and the fallback rule was used
  std::size_t bytes = 0;    ///< memory of the packed problem
};

/// Room for packed problems that serves from one step to the next.
class SolverRoom {
 public:
  SolverRoom();
  ~SolverRoom();
  struct Space;
  Space& space() { return *space_; }

 private:
  std::unique_ptr<Space> space_;
};

/// In: `impulse`, the first guess (one per contact; zeros for a cold start). Out: impulses, and the velocities of all bodies
/// that they give.
///
/// Precision: problems of more than 2,000 contacts are solved in single precision where the tolerance is 1e-5 or more, all
/// others in double. Velocities are dimensionless and of the order of one here, and the residual is that of the single
/// precision velocities, so convergence is never claimed beyond what rounding allows.
///
/// Cycling: the exact law is not a minimisation, and its fixed point may cycle. If the best residual has not fallen by 2 %
/// in 300 iterations, `cycling` is set and momentum ends; then the changes are damped, by 0.7 and 0.5 (the projected
/// gradients fall back to Gauss-Seidel). If even that stands still until max_iterations, the best iterate is kept; if its
/// residual is above 0.5, the relaxed law is solved for this step instead. `converged` always speaks of the exact law's
/// residual unless the relaxed law was asked for.
SolveReport solve(const ConeProblem& problem, const SolverOptions& options, std::span<Impulse> impulse,
                  std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity, SolverRoom& room);

}  // namespace repose::dvi
