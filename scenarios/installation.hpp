#pragma once
/// Where the parts of an installed or built Repose lie.
#include <filesystem>
#include <string>

namespace repose {

/// The folder of the running executable; the other executables lie beside it.
std::filesystem::path executable_folder();

/// A file that is delivered with the project ("aor.yaml", "grain_shapes.yaml"): from PREFIX/share/repose/configs if the
/// executable is installed, else from the source tree it was built from. Throws Error if it is in neither.
std::filesystem::path config_file(const std::string& name);

}  // namespace repose
