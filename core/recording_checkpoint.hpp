#pragma once
/// Checkpoint files: the complete state of a run, so that it can go on as if it had never stopped.
///
/// A file is an HDF5 file behind 512 bytes (which HDF5 skips, as a user block) with a line of text: the length and the
/// checksum of all that follows. Nothing else is looked at before they agree. It holds the state in double, the backend's own arrays
/// (numbers/, integers/), the times of the frames so far, the step log so far, and whose run it is.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/recording.hpp"
#include "core/world.hpp"

namespace repose {

/// Whose run it is; two runs with equal identities are the same run.
struct RunIdentity {
  std::uint64_t model = 0;  ///< fingerprint(Model)
  std::uint64_t scene = 0;  ///< checksum of the scene text
  std::uint64_t seed = 0;
  std::string backend;
};

struct Checkpoint {
  RunIdentity run;
  Frame frame;
  double wall_s = 0;  ///< [s]
  bool ended = false;
  std::vector<double> frame_times;  ///< [s]; as many as frames written
  std::vector<StepRecord> steps;
};

/// Writes `folder`/step-N.h5 durably, then removes all but the two with the highest N.
void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint);

/// Checkpoint files in `folder`, the newest first.
std::vector<std::filesystem::path> find_checkpoints(const std::filesystem::path& folder);

/// Throws Error if the file is damaged in any way.
Checkpoint read_checkpoint(const std::filesystem::path& file);

}  // namespace repose
