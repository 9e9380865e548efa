#pragma once
/// The baseline that needs no simulator in the loop: what is left of the measured acceleration after the nominal one, regressed on a
/// few functions of the measured state, sequentially thresholded (Brunton, Proctor & Kutz 2016).
#include <string>

#include "analysis/bundle/bundle.hpp"

namespace repose::concealment {

/// The effect whose function explains most: "uniform_force", "linear_drag", "quadratic_drag", "magnus", "rolling_friction" (against the
/// motion whatever the speed, on the floor); "" if no coefficient is beyond five standard errors. Accelerations are second derivatives of cubics through nine
/// samples, of the record and of a simulation of the nominal scene at the planned starts, subtracted. Paths only: no orientation but for the spin.
std::string sparse_regression(const Bundle& bundle);

}  // namespace repose::concealment
