#pragma once
/// Writes a bundle: CSV files first, recording.yaml last of all and durably.
#include <filesystem>

#include "analysis/bundle/bundle.hpp"

namespace repose {

/// Each observation with samples is written to its `file` below `folder`, the scene's text as `nominal.yaml`.
/// Numbers are printed so that they read back to the same bits; NaN as an empty field. An earlier recording.yaml is
/// removed first: the folder is a bundle exactly when it is complete. Throws Error if a file cannot be written.
void write_bundle(const std::filesystem::path& folder, const Bundle& bundle);

}  // namespace repose
