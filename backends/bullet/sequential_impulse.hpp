#pragma once
/// Bullet's constraint solver (btSequentialImpulseConstraintSolver) on the contact problem of one step.
///
/// Bullet builds the rows of every contact (effective masses, levers, free velocities), sweeps over them and removes
/// penetration by its split impulses. Three things are not left to it, because its own rules are unsound or not the law:
///  - The bounds of friction. Bullet bounds two rows by mu g_n each: a square, which holds up to sqrt(2) mu along its
///    diagonal. Here the two rows of sliding, and the two of rolling, are bounded together by a disc. Bullet also bounds a
///    rolling moment by arm x 1 N s whatever the load; here by arm x g_n.
///  - The bias of the normal row: Bullet would add the bounce and the gap of an impact; the problem says which it is.
///  - Warm start: Bullet keeps normal impulses only; here all rows start from those of the step before.
///
/// So it solves the exact law of backends/dvi/cone_problem.hpp, row by row (projected Gauss-Seidel): the fixed point of its
/// sweeps is  g_n + c >= 0  with u_n + bias >= 0 complementary, and the friction that dissipates most within mu (g_n + c).
#include <memory>
#include <span>
#include <vector>

#include "backends/dvi/cone_problem.hpp"
#include "backends/dvi/cone_solver.hpp"
#include "backends/dvi/separation.hpp"

namespace repose::bullet {

/// Mass and principal inertia of a body, as Bullet wants them; zero for prescribed bodies.
struct MassAndAxes {
  double mass = 0;
  Vec3 inertia = Vec3::Zero();
  Mat3 rotation = Mat3::Identity();
};

class SequentialImpulse {
 public:
  SequentialImpulse();
  ~SequentialImpulse();

  /// In: the first impulses. Out: impulses, and the velocities of all bodies. `mass`: of the problem's bodies, in its order
  /// (problem.inverse_mass must be the same). `gap`: of each contact, negative where penetration is to be removed. `step`: h.
  ///
  /// Sweeps end when one changes the impulses by less than half of options.tolerance, in the norm of the residual (law_residual.hpp),
  /// or after options.max_iterations.
  /// `residual` of the report: of the law at the end (law_residual.hpp), the same measure as DVI's.
  dvi::SolveReport solve(const dvi::ConeProblem& problem, std::span<const MassAndAxes> mass, std::span<const double> gap,
                         double step, const SolverOptions& options, std::span<dvi::Impulse> impulse,
                         std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity);

  /// What the split impulses of the last solve() move each body by, so that overlap shrinks; no velocity sees it.
  const std::vector<dvi::Displacement>& displacement() const;

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace repose::bullet
