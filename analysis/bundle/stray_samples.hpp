#pragma once
/// Samples of a trajectory that no body can have been at.
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"

namespace repose {

/// In words, one for each kind. A single sample that jumps away from its neighbours and back: a body that is hit bends its path, and does not return.
/// Samples of zeros in all axes amid others: gaps that were written as numbers. Only positions: a force may well last one sample.
std::vector<std::string> stray_samples(const Observation& observation);

}  // namespace repose
