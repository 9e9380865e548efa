#pragma once
/// On what the unknown force depends: one variable at a time, judged on segments that were left out.
#include <string>
#include <vector>

#include "analysis/diagnosis/locate.hpp"

namespace repose::diagnosis {

struct Dependence {
  std::string variable;   ///< speed, slip_speed, normal_force, spin, height, time
  double explained = 0;   ///< share of the weighted variance of left-out segments about zero, in [0, 1]
  std::string curve;      ///< "constant", "linear", "quadratic"
};

/// Regresses the force against the motion, -F . v / (|v| m g) (of segments without motion: its size), on a, b x, c x^2 of each
/// variable in turn, weighted by standard errors, leaving each run out in turn (with one run: each segment). Sorted, best first; empty with
/// fewer than four segments. What differs by less than 0.02 is settled for the simpler curve.
std::vector<Dependence> dependence_of(const std::vector<Located>& located);

}  // namespace repose::diagnosis
