#pragma once
/// Recordings of runs on disk: run.h5, frames, checkpoints.
///
///   DIR/run.h5                      model, scene, step log, external links to the frames; written last
///   DIR/run.xmf                     XDMF beside it: ParaView opens this
///   DIR/frames/frame-000000.h5      one file per frame: written aside, fsync, renamed
///   DIR/checkpoints/step-N.h5       the last two, each with a checksum inside
///
/// Datasets of run.h5 and of frames: gzip 1 + shuffle + a checksum per chunk. Frames hold float32 (6e-8 of the largest
/// coordinate: nothing that a picture or an analysis sees); checkpoints hold the whole state in double, not compressed.
/// run.h5 and the frames hold no times of the clock: the same run gives the same bytes, resumed or not.
#include <cstdint>
#include <filesystem>
#include <memory>
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
  Vec3 tool_force = Vec3::Zero();   ///< total of the contact forces on the tool that Schedule::tracked names [N]
  Vec3 tool_torque = Vec3::Zero();  ///< about the first of its bodies' centres, which turn with it [N m]
  double tool_rise = 0;             ///< how far a tool that yields stands above its stops [m], >= 0
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

/// Writes a run as it goes. One object per run, and one run per folder at a time. Everything is durable when the call
/// that wrote it returns. Failures to write are an Error (Kind::simulation); what was written before stays good.
class Recorder {
 public:
  /// Creates DIR; what an earlier run left there is removed, or kept if `resume`. Throws Error (Kind::input) if it cannot
  /// be written. `model` must outlive the recorder.
  Recorder(std::filesystem::path folder, const Model& model, std::string scene_text, std::string backend,
           std::uint64_t seed, bool resume);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void frame(const Snapshot& state);
  void step(const StepRecord& record);  ///< kept in memory, saved with the next checkpoint
  /// `wall_s`: spent so far, over all sessions [s]. `ended`: the run is over, a resumed one must not step on.
  void checkpoint(const Frame& frame, double wall_s, bool ended);
  void finish();                        ///< writes run.h5 and run.xmf with what there is so far

  struct Resumed {
    Frame frame;
    double wall_s = 0;
    bool ended = false;
    std::vector<StepRecord> steps;  ///< all steps up to the checkpoint
    std::string warning;            ///< not empty if the newest checkpoint was damaged and an older one is used
  };
  /// Goes back to the newest intact checkpoint: frames and steps that are recorded from now on follow it. nullopt if there
  /// is no checkpoint at all. Throws Error if all are damaged, or if they belong to another scene, seed or backend.
  std::optional<Resumed> resume();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads a run; with `every` > 1 only each n-th frame (and the last). Throws Error naming file and remedy.
Recording read_recording(const std::filesystem::path& run_h5, int every = 1);

/// Writes `text` to `file` atomically: aside, fsync, rename.
void write_atomically(const std::filesystem::path& file, const std::string& text);

}  // namespace repose
