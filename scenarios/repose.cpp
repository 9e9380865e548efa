/// repose COMMAND ...: hands over to the executable repose-COMMAND that lies beside this one.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "core/nearest.hpp"
#include "scenarios/command_line.hpp"
#include "scenarios/installation.hpp"
#include "scenarios/version.hpp"

namespace {

struct Command {
  const char* name;
  const char* summary;
};

constexpr Command commands[] = {
    {"run", "simulates any scene"},
    {"aor", "pours a heap through a funnel and measures its angle of repose"},
    {"layer", "spreads a layer of powder with a roller"},
    {"compare", "runs one scene on several backends and compares them"},
    {"study", "sweeps parameters, with replicates"},
    {"record", "makes a recording bundle from a simulated run"},
    {"diagnose", "finds the physics that a simulation lacks against recordings"},
    {"view", "renders pictures and films of a run"},
    {"check", "validates a scene and judges its plausibility, without running it"},
};

std::filesystem::path executable_of(const std::string& command) {
  return repose::executable_folder() / ("repose-" + command);
}

std::vector<std::string> available() {
  std::vector<std::string> names;
  for (const Command& command : commands)
    if (access(executable_of(command.name).c_str(), X_OK) == 0) names.emplace_back(command.name);
  return names;
}

void print_usage(std::FILE* out) {
  fmt::print(out, "repose {}: granular matter from scene to measurement\n\nusage: repose COMMAND [ARGUMENTS]\n\n",
             repose::version());
  for (const std::string& name : available())
    for (const Command& command : commands)
      if (name == command.name) fmt::print(out, "  {:<10}{}\n", command.name, command.summary);
  fmt::print(out, "\nrepose COMMAND --help shows what a command takes, with an example\n");
}

}  // namespace

int main(int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : "";
  if (command.empty()) {
    print_usage(stderr);
    return repose::exit_status::input;
  }
  if (command == "--help" || command == "-h" || command == "help") {
    print_usage(stdout);
    return repose::exit_status::done;
  }
  if (command == "--version") {
    fmt::print("repose {} ({})\n", repose::version(), repose::commit());
    return repose::exit_status::done;
  }
  // A name with a slash could lead to another folder.
  if (command.find('/') == std::string::npos) {
    const std::string path = executable_of(command).string();
    argv[1] = const_cast<char*>(path.c_str());
    // Threads that wait for each other spin a moment, then sleep: for ever spinning ones hold up all others where a core is
    // shared (108 s against 0.6 s in one of the tests). Read by the OpenMP runtime when the command starts.
    setenv("GOMP_SPINCOUNT", "20000", 0);
    // Large arrays on large pages: sweeps over many contacts wait for addresses otherwise. Read by the allocator.
    setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 0);
    execv(path.c_str(), argv + 1);
    if (errno != ENOENT) {
      fmt::print(stderr, "repose: {} cannot be started: {}\n  build or install the project anew\n", path, std::strerror(errno));
      return repose::exit_status::internal;
    }
  }
  const std::vector<std::string> names = available();
  const std::string near = repose::nearest(command, names);
  fmt::print(stderr, "repose: there is no command \"{}\"\n  {}commands: {}\n", command,
             near.empty() ? "" : fmt::format("did you mean {}? ", near), repose::listing(names));
  return repose::exit_status::input;
}
