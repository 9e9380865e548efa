#include "scenarios/reference_file.hpp"

#include "core/error.hpp"
#include "scenarios/installation.hpp"

namespace repose {

namespace fs = std::filesystem;

fs::path reference_file(const std::string& name) {
  for (const fs::path& folder : {executable_folder().parent_path() / REPOSE_REFERENCE_SUBFOLDER, fs::path(REPOSE_SOURCE_REFERENCE)})
    if (std::error_code ignored; fs::is_regular_file(folder / name, ignored)) return folder / name;
  throw Error(name, "this file of the project is not found beside the executable " + executable_folder().string(),
              "install the project anew, or name a reference that exists");
}

}  // namespace repose
