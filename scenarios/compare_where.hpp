#pragma once
/// When and where the runs of two backends part.
#include <nlohmann/json.hpp>

#include "scenarios/compare_results.hpp"

namespace repose {

/// One entry per pair of backends: {a, b, parted (null: cannot be told), text, method, ...}.
///   With grains: first_parting() on the films of occupancy and kinetic energy, alpha = 0.05 over the number of pairs. Also p, ways, time,
///     time_before (the frame before), quantity ("mass share" or "kinetic energy"), region {inner, outer, lower, upper} [m, about the
///     base's axis and above it], mean_a, mean_b, se; `half_step`: the same with both refined.
///   Without: the first time at which a body's places differ by more than the tolerance times its way, and more than halving the step
///     moves it on either backend. Also body, time, distance.
nlohmann::json compare_partings(const Comparison& comparison, const CompareResults& results);

}  // namespace repose
