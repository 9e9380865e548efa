#pragma once
/// Multiple shooting: a long run in windows, each with start values of its own.
///
/// The path of a tumbling body after an impact depends on its start so strongly that the noise of the start decides it. A
/// window begins anew from the data: what happens in it is compared, not what a small error has grown to since the throw.
#include <vector>

#include "analysis/bundle/bundle.hpp"

namespace repose {

/// The run in windows of about `length` [s] > 0 with the same settings and free start values; id and beginning name each,
/// "toss-003@0.251". A window ends before
/// the sample that begins the next. Beginnings move by up to a third of the length to where the next samples are
/// smoothest, for a start velocity cannot be read off samples on both sides of an impact. Windows in which an observation
/// has fewer than two samples are left out; a run without a trajectory is one window.
std::vector<BundleRun> in_windows(const BundleRun& run, double length);

}  // namespace repose
