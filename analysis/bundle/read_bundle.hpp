#pragma once
/// Reads and checks a recording bundle: recording.yaml, the nominal scene, and every table of data.
#include <filesystem>
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"
#include "analysis/bundle/bundle_files.hpp"
#include "core/scene_yaml.hpp"
#include "core/yaml_reader.hpp"

namespace repose {

/// `path`: the folder, its recording.yaml, or an HDF5 file. `root`: where the CSV files lie if not there (bundle_files.hpp).
/// `overrides` change the nominal scene. Throws Error naming file, line and key or column for: missing files, unknown
/// keys (with the nearest), runs of the same id, bodies that the scene does not have, scene keys that it refuses, times
/// that do not ascend, lengths and times in another unit (bundle_units.hpp), numbers that are not finite, quaternions off unit length by more than 1 %, an observation
/// without two samples (in all, or in the window `from` <= time <= `until` of its run, both optional and on the
/// recording's clock), doubtful observable names. What is doubtful but possible is a warning of the bundle.
Bundle read_bundle(const std::filesystem::path& path, const std::filesystem::path& root = {},
                   const std::vector<Override>& overrides = {});

/// One entry of `observables`, with its data out of `files`. `scene`: names the bodies. A wholly empty column is an
/// axis that was not observed.
Observation read_observation(const YamlReader& entry, const BundleFiles& files, const Scene& scene);

/// Drops the samples of a trajectory or a series outside from <= time <= until [s]; times then count from `from`.
void cut(Observation& observation, double from, double until);

/// Names with a meaning; other series are kept, but nothing simulated can be compared with them.
const std::vector<std::string>& reserved_series();

/// What is doubtful in the data of a bundle: the same data twice, long gaps, clocks that do not meet, a record of one place, start values
/// that nothing shows.
std::vector<std::string> doubts_of(const Bundle& bundle);

}  // namespace repose
