#pragma once
/// How far a body has turned, from sampled orientations.
#include <array>
#include <vector>

#include "core/math.hpp"

namespace repose::diagnosis {

/// Components of the rotation vectors from sample to sample, added up from the first sample on [rad, world frame]; NaN where there
/// is no sample. Their slope is the angular velocity, also of a body that turns many times, as long as it turns by less than
/// half a revolution from one sample to the next.
std::array<std::vector<double>, 3> turns_of(const std::vector<Quat>& orientation);

}  // namespace repose::diagnosis
