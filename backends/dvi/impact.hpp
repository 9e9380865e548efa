#pragma once
/// Restitution: which contacts bounce in this step, and the guard that no impact gains energy.
///
/// Rules, for a contact with restitution e > 0, normal velocities u- before the step, u_free after the forces of the step:
///  1. A contact counts as an impact if it approaches faster than the step's forces alone would make it: -u- > 2 |u_free - u-|.
///     What is slower is at rest, and closes its gap without a bounce.
///  2. It closes in this step if gap + h u_free <= 0. Then its bias is e u-  (v+ = -e v- whatever the gap), else gap / h.
///  3. A contact not seen by rule 2 that carries an impulse after the solve was closed by the impulses of others: its bias
///     becomes e u- too (if rule 1 holds for it), and the problem is solved again; at most four times. One that did not
///     approach before the step keeps gap / h: it is met in the next step, with a velocity of its own. So a row of balls
///     with gaps larger than v h hands an impulse on, and balls that touch bounce at the same time.
///  4. Energy: if a bouncing contact does positive work, g . (u_free + u+) / 2 > 0 (Newton's law with friction can:
///     Kane's example), its bias is halved and the problem solved again, up to seven times, then set to zero.
#include <functional>
#include <span>
#include <vector>

#include "backends/dvi/cone_problem.hpp"
#include "backends/dvi/cone_solver.hpp"

namespace repose::dvi {

struct ImpactData {
  double gap = 0;          ///< at the start of the step
  double restitution = 0;  ///< e; a compliant contact that bounces is rigid in this step. One that does not keeps the bias
                           ///< that it came with, others get gap / h
  double before = 0;       ///< u_n at the start of the step
};

/// Rule 1, whatever the restitution. `free`: its u_free.
bool is_impact(const ImpactData& contact, double free);

/// Relative velocity rows of contact `c` for the given velocities.
Impulse relative_velocity(const ConeContact& c, std::span<const Vec3> velocity, std::span<const Vec3> angular_velocity);

/// Solves a problem from the first impulses given: solve() of cone_solver.hpp with its options, or another engine's solver.
using ConeSolver = std::function<SolveReport(const ConeProblem& problem, std::span<Impulse> impulse,
                                             std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity)>;

/// Sets the biases by rules 1 and 2, solves, and applies rules 3 and 4. `data`: one per contact. `step`: h. `tolerance`: of
/// the solver. `threads`: for the first loop over all contacts; the same bits at any number.
SolveReport solve_with_impacts(ConeProblem& problem, std::span<const ImpactData> data, double step, double tolerance,
                               const ConeSolver& solver, std::span<Impulse> impulse, std::vector<Vec3>& velocity,
                               std::vector<Vec3>& angular_velocity, int threads);

}  // namespace repose::dvi
