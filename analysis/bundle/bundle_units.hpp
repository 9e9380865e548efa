#pragma once
/// Numbers in the wrong unit: what says so, and what shows it.
#include "analysis/bundle/bundle.hpp"
#include "core/yaml_reader.hpp"

namespace repose {

/// Of an observable's noise: "position", "orientation", or a series that a simulation tells; none of others.
Dimension dimension_of(const std::string& observable);

/// Turns the values of a series with a reserved name into SI ("mm/s^2" into m/s^2), those of profiles and surfaces into metres, and angles
/// into degrees; without a unit they are in SI, angles in radians. `entry` is that of the observable. Throws Error for a unit of another
/// dimension, and for angles beyond 90 degrees. Series of other names keep the unit that they say.
void turn_into_si(const YamlReader& entry, Observation& observation);

/// Throws Error if the lengths or times of a run are so far from what its scene (its own settings included) can do that only
/// another unit explains it (a start that is free must be so far off in height, too): paths fifty times longer than the start speed and gravity allow, a first position a thousand times nearer or
/// farther than the start, times a hundred times longer than the scene lasts.
void check_scales(const BundleRun& run, const Scene& scene);

/// Paths a thousand times longer or shorter than the start velocity of their body in `scene` (the run's own) suggests, in words.
std::vector<std::string> doubtful_scales(const BundleRun& run, const Scene& scene);

}  // namespace repose
