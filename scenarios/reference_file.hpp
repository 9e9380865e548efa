#pragma once
/// Where the figures from publications lie.
#include <filesystem>
#include <string>

namespace repose {

/// A file of analysis/reference ("pa650/table2.yaml"): from PREFIX/share/repose/reference if the executable is installed, else
/// from the source tree it was built from. Throws Error if it is in neither.
std::filesystem::path reference_file(const std::string& name);

}  // namespace repose
