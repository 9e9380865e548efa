#pragma once
/// A simulation seen as the recording saw the world: at its times and places, so that the same summary of both means the same.
#include <vector>

#include "analysis/bundle/bundle.hpp"

namespace repose::diagnosis {

/// Series are read at the recorded times (those with a value), by straight lines; before the first step and after the last they keep the value
/// there. Profiles are read at the places of the last recorded one (bulk_profile.hpp). Surfaces and scalars stay, and what was not recorded stays as it is.
std::vector<Observation> sampled_like(std::vector<Observation> simulated, const std::vector<Observation>& recorded);

/// What must be kept of a simulation so that it can be seen by any clock: series at the recorded times and, before and after these, no more densely.
/// Undisturbed, sampled_like() gives of it what it gives of the whole.
std::vector<Observation> thinned_like(std::vector<Observation> simulated, const std::vector<Observation>& recorded);

}  // namespace repose::diagnosis
