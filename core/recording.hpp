#pragma once
/// Recordings of runs on disk: run.h5, frames, checkpoints.
///
///   DIR/run.h5                    model, settings, solver statistics, external links to the frames; written last
///   DIR/run.xmf                   XDMF beside it: ParaView opens this
///   DIR/frames/frame-000000.h5    one file per frame: written aside, fsync, renamed; never touched again
///   DIR/checkpoints/step-N.h5     the last two, each with a checksum inside
/// Datasets: gzip 1 + shuffle; frames hold float32 positions and orientations, checkpoints double.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/model.hpp"
#include "core/world.hpp"

namespace repose {

/// One step's line of the solver log, kept for every step.
struct StepRecord {
  double time = 0;
  StepReport report;
};

/// Everything a finished or interrupted run left behind, as the analysis reads it.
struct Recording {
  Model model;                       ///< with the initial state
  std::vector<Snapshot> frames;      ///< ascending in time
  std::vector<StepRecord> steps;
  std::string scene_text;            ///< resolved scene, YAML
  std::string backend;
  std::uint64_t seed = 0;
};

/// Writes a run as it goes. One object per run.
class Recorder {
 public:
  /// Creates DIR (keeping what a previous, resumable run left if `resume`). Throws Error if it cannot be written.
  Recorder(std::filesystem::path folder, const Model& model, std::string scene_text, std::string backend,
           std::uint64_t seed, bool resume);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void frame(const Snapshot& state);                ///< durable when it returns
  void step(const StepRecord& record);              ///< kept in memory, saved with the next checkpoint
  void checkpoint(const Frame& frame, std::int64_t frames_written);   ///< durable when it returns
  void finish();                                    ///< writes run.h5 and run.xmf

  struct Resumed {
    Frame frame;
    std::int64_t frames_written = 0;
    std::vector<StepRecord> steps;
  };
  /// The newest intact checkpoint; nullopt if there is none. Throws Error if it belongs to another scene or seed.
  std::optional<Resumed> latest() const;

 private:
  struct Impl;
  Impl* impl_;
};

/// Reads a run; with `every` > 1 only each n-th frame (and the last). Throws Error naming file and remedy.
Recording read_recording(const std::filesystem::path& run_h5, int every = 1);

/// Writes `text` to `file` atomically: aside, fsync, rename.
void write_atomically(const std::filesystem::path& file, const std::string& text);

}  // namespace repose
