#pragma once
/// The only time loop.
#include <functional>
#include <string>
#include <vector>

#include "core/model.hpp"
#include "core/recording.hpp"
#include "core/world.hpp"

namespace repose {

struct Schedule {
  double time_step = 0;          ///< h [s], > 0
  double duration = 0;           ///< [s]; the number of steps is round(duration / h)
  double frame_interval = 0;     ///< [s]; rounded to whole steps, at least one
  double checkpoint_wall_s = 30; ///< wall-clock time between checkpoints [s]
};

struct Progress {
  std::int64_t step = 0, steps = 0;
  double time = 0;          ///< simulated [s]
  double wall_s = 0;        ///< since the start or the resume
  double remaining_s = 0;   ///< estimate
  StepReport report;        ///< of the last step
};

struct RunReport {
  enum class End { done, interrupted, stopped } end = End::done;
  std::int64_t steps = 0;
  double wall_s = 0;             ///< simulation only, over all sessions of a resumed run
  double contacts_mean = 0;
  double iterations_mean = 0;
  double residual_max = 0;
  double converged_fraction = 1;
  double cycling_fraction = 0;
  double max_penetration = 0;    ///< [m], over all steps
  Snapshot final_state;
};

struct RunHooks {
  std::function<void(const Progress&)> progress;          ///< called about five times a second; may be empty
  std::function<bool()> interrupted;                      ///< polled every step; true: checkpoint and stop
  /// Polled at each frame; true ends the run early and well (a heap at rest). May be empty.
  std::function<bool(const Snapshot&, const StepReport&)> finished;
};

/// Steps `world` through the schedule, applying the model's effects, recording frames and checkpoints. `recorder` may be
/// null (nothing is written). With `resume`, continues from the newest checkpoint of the recorder, bit for bit.
RunReport run(World& world, const Model& model, const Schedule& schedule, Recorder* recorder, const RunHooks& hooks,
              bool resume = false);

}  // namespace repose
