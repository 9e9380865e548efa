#pragma once
/// On what the unknown force depends: one variable at a time, judged on segments that were left out.
#include <string>
#include <vector>

#include "analysis/diagnosis/locate.hpp"

namespace repose::diagnosis {

struct Dependence {
  std::string variable;   ///< speed, slip_speed, normal_force, spin, height, time
  double explained = 0;   ///< share of the weighted variance of left-out segments about zero, in [0, 1]
  std::string curve;      ///< "linear": c x, "quadratic": c x^2
  double coefficient = 0; ///< c, of all segments [N over the variable's unit to that power]
};

/// The mean of a variable over a segment, SI.
double variable_of(const Segment& segment, const std::string& variable);

/// The unknown force against the motion, -F . v / |v| (of segments without motion: -F_z), and its standard error [N].
struct ForceAgainstMotion {
  double value = 0, se = 0;
};
ForceAgainstMotion against_motion(const Located& located);

/// Regresses the force against the motion on c x and c x^2 of each variable in turn, weighted by standard errors, leaving each run out
/// in turn (with one run: each segment). Sorted, best first; empty with fewer than four segments. What differs by less than 0.02 is
/// settled for the simpler curve.
std::vector<Dependence> dependence_of(const std::vector<Located>& located);

}  // namespace repose::diagnosis
