#pragma once
/// What all commands share: options, messages, exit status.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/scene_yaml.hpp"

namespace CLI {
class App;
}

namespace repose {

/// Exit status of every command.
namespace exit_status {
inline constexpr int done = 0;
inline constexpr int internal = 1;     ///< a defect of this program
inline constexpr int input = 2;        ///< Error::Kind::input, arguments included
inline constexpr int simulation = 3;   ///< Error::Kind::simulation, or fewer than 95 % of the steps converged
inline constexpr int interrupted = 130;
}  // namespace exit_status

/// What a command is; shown by --help.
struct CommandInfo {
  std::string name;     ///< "run": the executable is repose-run, the default folder out/run
  std::string summary;  ///< one sentence
  std::string example;  ///< commands that can be typed as they stand, one per line
  std::string file;     ///< the positional argument: "SCENE.yaml"; empty if there is none
  bool file_required = false;
  std::vector<std::string> presets;  ///< the first is the default; empty if the command has none
};

/// What the user asked for. Values here are the defaults.
struct Options {
  std::filesystem::path file;    ///< empty if not given
  std::filesystem::path out;     ///< out/<command>
  std::string backend = "dvi";
  std::string preset;            ///< the first of CommandInfo::presets
  std::uint64_t seed = 1;
  int threads = 1;               ///< all of the machine
  std::vector<Override> overrides;
  double checkpoint_wall_s = 30; ///< [s]
  bool resume = false;
  bool allow_unsupported = false;
  bool force = false;            ///< run what the plausibility check refuses
  bool quiet = false;
};

/// The main function of a command: reads the arguments, catches Ctrl-C (interrupt.hpp), calls `body`, and turns what it
/// throws into a message on stderr and an exit status. `add_options` may add options of the command's own; what they
/// write to must outlive the call.
int run_command(int argc, char** argv, const CommandInfo& info, const std::function<int(const Options&)>& body,
                const std::function<void(CLI::App&)>& add_options = {});

}  // namespace repose
