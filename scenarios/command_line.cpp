#include "scenarios/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <new>
#include <thread>

#include "core/error.hpp"
#include "core/nearest.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/version.hpp"

namespace repose {
namespace {

int tell(const CommandInfo& info, const std::string& message, int status) {
  std::fflush(stdout);
  fmt::print(stderr, "repose {}: {}\n", info.name, message);
  return status;
}

/// Options as they are written, before they are checked against each other.
struct Raw {
  std::string file, out;
  std::vector<std::string> sets;
};

void add_common_options(CLI::App& app, const CommandInfo& info, Options& options, Raw& raw) {
  app.set_version_flag("--version", fmt::format("repose-{} {} ({})", info.name, version(), commit()));
  if (!info.file.empty()) {
    CLI::Option* file = app.add_option(info.file, raw.file, info.file_required ? "what to work on" : "instead of the preset");
    if (info.file_required) file->required();
  }
  app.add_option("--out", raw.out, fmt::format("folder for the results (default out/{})", info.name))->type_name("DIR");
  app.add_option("--backend", options.backend, "engine (default dvi)")->type_name("NAME");
  // CLI11 takes -1 for the largest unsigned number.
  app.add_option("--seed", options.seed, "of everything random (default 1)")
      ->type_name("N")
      ->check([](const std::string& text) {
        return std::string(text.starts_with('-') ? text + " is negative; a seed is a whole number from 0 up" : "");
      });
  app.add_option("--threads", options.threads, "the result does not depend on it (default: all processors)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  app.add_option("--set", raw.sets, "replaces one key of the scene; may be given again")
      ->type_name("KEY.PATH=VALUE")
      ->allow_extra_args(false);
  app.add_option("--preset", options.preset,
                 info.presets.empty() ? "this command has none" : fmt::format("one of: {}", fmt::join(info.presets, ", ")))
      ->type_name("NAME");
  app.add_flag("--resume", options.resume, "continue the run in the folder from its newest checkpoint");
  app.add_option("--checkpoint-interval", options.checkpoint_wall_s, "wall-clock seconds between checkpoints (default 30)")
      ->type_name("S")
      ->check(CLI::Range(0.0, 1e9));
  app.add_flag("--allow-unsupported", options.allow_unsupported, "leave out the physics that the backend lacks");
  app.add_flag("--force", options.force, "run even what the plausibility check refuses");
  app.add_flag("--quiet", options.quiet, "no progress, only warnings and results");
}

void take(const CommandInfo& info, const Raw& raw, Options& options) {
  options.file = raw.file;
  options.out = raw.out.empty() ? std::filesystem::path("out") / info.name : std::filesystem::path(raw.out);
  for (const std::string& set : raw.sets) {
    const std::size_t equals = set.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw Error("--set", "\"" + set + "\" is not of the form key.path=value", "for example --set solver.tolerance=1e-4");
    options.overrides.push_back({set.substr(0, equals), set.substr(equals + 1)});
  }
  if (options.preset.empty()) {
    if (!info.presets.empty()) options.preset = info.presets.front();
  } else if (info.presets.empty()) {
    throw Error("--preset", "this command has no presets", "leave it out");
  } else if (std::find(info.presets.begin(), info.presets.end(), options.preset) == info.presets.end()) {
    throw Error("--preset", "there is no preset \"" + options.preset + "\"",
                fmt::format("presets: {}", fmt::join(info.presets, ", ")));
  }
}

/// What CLI11 says, with the nearest option for an unknown one.
std::string parse_message(const CLI::App& app, const CommandInfo& info, const CLI::ParseError& problem) {
  std::string message = problem.what();
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const std::string& extra : app.remaining())
    if (const std::string near = nearest(extra.substr(0, extra.find('=')), names); extra.starts_with("-") && !near.empty())
      message += fmt::format("\n  did you mean {}?", near);
  return message + fmt::format("\n  repose {} --help shows what it takes", info.name);
}

}  // namespace

int run_command(int argc, char** argv, const CommandInfo& info, const std::function<int(const Options&)>& body,
                const std::function<void(CLI::App&)>& add_options) {
  Options options;
  options.threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 1024u));
  Raw raw;
  CLI::App app(info.summary, "repose " + info.name);
  app.footer("Example:\n  " + info.example);
  add_common_options(app, info, options, raw);
  if (add_options) add_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& answered) {
    return app.exit(answered);
  } catch (const CLI::ParseError& problem) {
    return tell(info, parse_message(app, info, problem), exit_status::input);
  }
  try {
    take(info, raw, options);
    catch_interrupts();
    return body(options);
  } catch (const Error& problem) {
    return tell(info, problem.what(),
                problem.kind() == Error::Kind::input ? exit_status::input : exit_status::simulation);
  } catch (const std::bad_alloc&) {
    return tell(info, "there is not enough memory\n  use fewer grains, or a machine with more", exit_status::simulation);
  } catch (const std::exception& problem) {
    return tell(info, fmt::format("internal error: {}\n  this is a defect of repose {} ({}); please report it", problem.what(),
                                  version(), commit()),
                exit_status::internal);
  }
}

}  // namespace repose
