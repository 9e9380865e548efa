#pragma once
/// A simulation seen as the recording saw the world: at its times and places, so that the same summary of both means the same.
#include <vector>

#include "analysis/bundle/bundle.hpp"

namespace repose::diagnosis {

/// Series are read at the recorded times (those with a value), by straight lines; before the first step and after the last they keep the value
/// there. Profiles and scalars stay: their rings come from the measurement, not from a sensor. What was not recorded stays as it is.
std::vector<Observation> sampled_like(std::vector<Observation> simulated, const std::vector<Observation>& recorded);

}  // namespace repose::diagnosis
