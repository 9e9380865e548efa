#pragma once
/// The profile of a heap as every number and every part of it is read.
#include <vector>

#include "analysis/bundle/bundle.hpp"

namespace repose::diagnosis {

/// Distances from the axis, ascending, and heights there [m].
struct BulkProfile {
  std::vector<double> at, height;
};

/// The last profile of a record (all of it if it has no times), both flanks about the axis, without gaps.
BulkProfile last_profile(const Observation& o);

/// By straight lines between its places, the mean of both flanks at one; nearer to the axis as high as at the first one. Beyond the last one the line goes on for half a spacing, to the end of the
/// ring that the place is the middle of; further out nothing stands. `p` not empty.
double height_at(const BulkProfile& p, double radius);

}  // namespace repose::diagnosis
