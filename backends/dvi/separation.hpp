#pragma once
/// Removes penetration at position level: shifts and turns that no velocity ever sees, so no kinetic energy is added.
#include <span>
#include <vector>

#include "backends/dvi/cone_problem.hpp"

namespace repose::dvi {

struct Displacement {
  Vec3 shift = Vec3::Zero();
  Vec3 turn = Vec3::Zero();  ///< rotation vector, world frame
};

/// Finds the least displacements (in the metric of the masses) of the dynamic bodies after which every contact has
///   gap + n . (displacement of b - displacement of a)  >=  -slop * arm of the contact / 2,
/// frictionless (a contact that stands shallower than that may be brought to it, never beyond), by projected Gauss-Seidel from
/// zero, over-relaxed where bodies are many (Cryer 1971: any factor below 2 converges). Contacts shallower than slop * arm are left
/// alone unless a body of theirs moves by more than a tenth of that, and are visited again only when it does: the cost is that of the
/// deep ones and of what is around them, and what is left is true to a fifth of slop * arm. `gap`: the gap of each contact after the
/// step, to first order. Returns the sweeps used. The same bits at any thread count.
int push_apart(const ConeProblem& problem, std::span<const double> gap, double slop, int threads, std::vector<Displacement>& out);

}  // namespace repose::dvi
