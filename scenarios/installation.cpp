#include "scenarios/installation.hpp"

#include "core/error.hpp"

namespace repose {

namespace fs = std::filesystem;

fs::path executable_folder() {
  std::error_code problem;
  const fs::path self = fs::read_symlink("/proc/self/exe", problem);
  return problem ? fs::current_path() : self.parent_path();
}

fs::path config_file(const std::string& name) {
  for (const fs::path& folder : {executable_folder().parent_path() / REPOSE_CONFIG_SUBFOLDER, fs::path(REPOSE_SOURCE_CONFIGS)})
    if (std::error_code ignored; fs::is_regular_file(folder / name, ignored)) return folder / name;
  throw Error(name, "this file of the project is not found beside the executable " + executable_folder().string(),
              "install the project anew, or give a file of your own");
}

}  // namespace repose
