#pragma once
/// When two bodies that approach will touch: a step of second order (Integration::second_order) ends there, and the blow has a short
/// step of its own, so that neither its time nor the velocities on either side of it depend on the step.
#include <limits>

namespace repose::dvi {

/// Of one contact at the start of a step, along its normal; positive apart.
struct Approach {
  double gap = 0;
  double speed = 0;         ///< du/dt of the gap before the step
  double acceleration = 0;  ///< by the forces of the step, contacts left out
};

struct Touch {
  double time = std::numeric_limits<double>::infinity();  ///< from the start of the step; 0 if they touch already
  double speed = 0;                                       ///< of approach then, > 0
};

/// The first t >= 0 with gap + speed t + acceleration t^2 / 2 <= 0 at which they approach; infinite if there is none.
Touch touch_of(const Approach& approach);

/// Is the touch a blow? It is one if it is faster than twice what the forces make in `step` (rule 1 of impact.hpp); what is slower
/// lies or rolls.
bool is_blow(const Approach& approach, const Touch& touch, double step);

}  // namespace repose::dvi
