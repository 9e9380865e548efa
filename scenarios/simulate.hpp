#pragma once
/// The core that the commands share: scene -> plausibility -> model -> backend -> recorded run -> result.json.
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/plausibility.hpp"
#include "core/run.hpp"
#include "core/scene.hpp"
#include "scenarios/command_line.hpp"

namespace repose {

/// Share of the steps that must converge for a run to count.
inline constexpr double least_converged = 0.95;

/// A scene that is ready to run.
struct Prepared {
  Scene scene;                           ///< with the threads that were asked for
  Model model;
  const Backend* backend = nullptr;
  std::vector<std::string> unsupported;  ///< what the backend leaves out; not empty only with --allow-unsupported
  std::vector<Finding> findings;         ///< warnings and, with --force, refusals
};

/// Loads the scene with the overrides of `options`, checks its plausibility (warnings go to stderr), makes the grains, and
/// asks the backend what it cannot do. Throws Error for what is refused.
Prepared prepare(const std::filesystem::path& scene_file, const Options& options);

/// As above for a scene that is already loaded or edited. `adjust` may move the grains before they are checked (a settled bed).
Prepared prepare(Scene scene, const Options& options, const std::function<void(Model&)>& adjust = {});

/// Findings on keys that a command fills in by itself, told by the keys that the user wrote: {"duration", "layer.settle"}.
using KeyNames = std::map<std::string, std::string>;
void rename(const KeyNames& names, std::vector<Finding>& findings);

/// As above, and tells nothing: for runs that are one of many, or told later.
Prepared prepare_quietly(Scene scene, const Options& options, const std::function<void(Model&)>& adjust = {}, const KeyNames& names = {});

/// Those of `from` that `to` does not have yet.
void add_missing(const std::vector<Finding>& from, std::vector<Finding>& to);

/// Findings on stderr.
void tell(const std::vector<Finding>& findings);

/// True for --resume where an earlier call left a checkpoint; else a run begins anew.
bool goes_on(const Options& options);

/// Runs it with frames, checkpoints and progress into options.out. A run that begins anew first removes `main_file` there (the
/// folder is complete exactly when it is present). `finished`: see RunHooks; `tracked`: see Schedule; both may be empty.
RunReport simulate(const Prepared& prepared, const Options& options, const std::string& main_file = "result.json",
                   std::function<bool(const Snapshot&, const StepReport&)> finished = {}, const std::string& tracked = {});

/// The JSON text of an object with the keys that every result.json has; a command adds its own.
std::string common_result(const std::string& scenario, const Prepared& prepared, const Options& options,
                          const RunReport& report);

/// Writes the main file, last of all, durably. `json`: the text of an object.
void write_result(const std::filesystem::path& file, const std::string& json);

/// Throws Error (Kind::simulation) if less than `least_converged` of the steps converged. `steps`: which ones ("the steps of the bed"); `remedy`: the
/// keys that mend it. For runs that are one of many, and measured rather than kept.
void demand_converged(double converged_fraction, double residual_max, const std::string& steps, const std::string& remedy);

/// The exit status that the report asks for; tells on stderr what is wrong and how to go on. 130 if interrupted (no result
/// should be written then), 3 if fewer than 95 % of the steps converged (the result is written all the same), else 0.
int report_status(const RunReport& report, const Options& options);

}  // namespace repose
