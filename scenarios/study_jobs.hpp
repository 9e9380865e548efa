#pragma once
/// Runs independent jobs side by side and keeps each result in a file of its own, so that a study can be taken up again.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/scene.hpp"

namespace repose {

/// One run of one scene.
struct StudyJob {
  std::size_t scene = 0;   ///< index into the list of scenes
  std::uint64_t seed = 0;
  std::string key;         ///< of its result file; equal keys are the same run
};

/// Key of a run: a checksum of everything that determines its result: the resolved scene, the seed, the backend, the
/// version and commit of the program.
std::string job_key(const std::string& scene_text, std::uint64_t seed, const std::string& backend, const std::string& version);

/// What a job gave: observables by name (a missing one is null), or why it failed.
struct JobResult {
  nlohmann::json observables;
  std::string failure;  ///< not empty if the simulation failed
};

/// Simulates one scene; nullopt if it was interrupted. Throws Error (Kind::simulation) if the run fails. Called from
/// several threads at once.
using SimulateJob = std::function<std::optional<nlohmann::json>(const Scene&, std::uint64_t seed)>;

struct StudyProgress {
  std::size_t done = 0, reused = 0, failed = 0, total = 0;  ///< `done` counts reused ones too
  double wall_s = 0;       ///< since the start [s]
  double remaining_s = 0;  ///< estimate [s]; 0 while unknown
};

struct StudyHooks {
  std::function<void(const StudyProgress&)> progress;  ///< a few times a second, from one thread; may be empty
  std::function<bool()> interrupted;                   ///< may be empty
};

struct JobsReport {
  bool interrupted = false;
  StudyProgress progress;
  std::vector<std::optional<JobResult>> results;  ///< one per job; nullopt if not run
};

/// Runs what FOLDER/jobs does not hold yet, `workers` >= 1 jobs at a time, each result written durably as FOLDER/jobs/<key>.json
/// as soon as it is there. A failed job is kept in the report but not on disk: it is tried again next time. Damaged
/// files are run again. Errors of input (Kind::input) end the study and are thrown on.
JobsReport run_jobs(const std::vector<StudyJob>& jobs, const std::vector<Scene>& scenes, const std::filesystem::path& folder,
                    int workers, const SimulateJob& simulate, const StudyHooks& hooks);

}  // namespace repose
