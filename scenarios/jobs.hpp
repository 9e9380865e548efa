#pragma once
/// Runs independent jobs side by side and keeps each result in a file of its own, so that a study or a comparison can be
/// taken up again.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace repose {

/// One run of one scene.
struct Job {
  std::size_t scene = 0;   ///< index into the caller's list of what is run: a point of a study, a variant of a comparison
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

/// Simulates one job; nullopt if it was interrupted. Throws Error (Kind::simulation) if the run fails. Called from several
/// threads at once.
using SimulateJob = std::function<std::optional<nlohmann::json>(const Job&)>;

struct JobsProgress {
  std::size_t done = 0, reused = 0, failed = 0, total = 0;  ///< `done` counts reused ones too
  double wall_s = 0;       ///< since the start [s]
  double remaining_s = 0;  ///< estimate [s]; 0 while unknown
};

struct JobsHooks {
  std::function<void(const JobsProgress&)> progress;  ///< a few times a second, from one thread; may be empty
  std::function<bool()> interrupted;                   ///< may be empty
};

struct JobsReport {
  bool interrupted = false;
  JobsProgress progress;
  std::vector<std::optional<JobResult>> results;  ///< one per job; nullopt if not run
};

/// Runs what FOLDER/jobs does not hold yet, `workers` >= 1 jobs at a time, each result written durably as FOLDER/jobs/<key>.json
/// as soon as it is there. A failed job is kept in the report but not on disk: it is tried again next time. Damaged
/// files are run again. Errors of input (Kind::input) end it all and are thrown on.
JobsReport run_jobs(const std::vector<Job>& jobs, const std::filesystem::path& folder, int workers, const SimulateJob& simulate,
                    const JobsHooks& hooks);

}  // namespace repose
