#pragma once
/// Second order where a slip turns: friction along the mean of the slips before and after a step.
///
/// The contact problem takes friction along the slip u+ after the step, which is of first order where the slip turns, as that of a block that
/// crosses an incline. Bodies whose contacts all slide (or roll) on through the step are therefore solved as if the velocities before the step, v-, were
/// added to the free ones: the rows of a contact are then u- + u+, twice the mean slip, and v+ is what comes out less v-. Normal rows keep
/// their condition: the gap, 0 where they overlap, is made smaller by h u_n-.
///
/// Left as they are: bodies that a contact stops, throws or begins to move in this step (the mean slip would send them back), those of an
/// impact (rule 1 of impact.hpp), and those that touch one.
/// Nothing changes in a step in which nothing slides or rolls against friction.
#include <functional>
#include <span>
#include <vector>

#include "backends/dvi/cone_problem.hpp"
#include "backends/dvi/impact.hpp"

namespace repose::dvi {

/// By body of the problem: velocities before the step.
struct VelocitiesBefore {
  std::vector<Vec3> linear, angular;
};

/// Calls `solve` once, with the problem and the impacts changed as above; twice where bodies did not slide on after all. Problem and impacts are handed
/// back as they came, with the velocities after the step. `solve` fills `velocity` and `angular_velocity` of all bodies.
SolveReport solve_at_mid_step(ConeProblem& problem, std::span<ImpactData> impact, const VelocitiesBefore& before, double step,
                              const std::function<SolveReport()>& solve, std::span<const Impulse> impulse, std::vector<Vec3>& velocity,
                              std::vector<Vec3>& angular_velocity);

}  // namespace repose::dvi
