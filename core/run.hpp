#pragma once
/// The only time loop.
#include <cstdint>
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
  bool loads_half_way = false;       ///< loads are those half a step ahead: what Integration::second_order needs
  std::string tracked = {};          ///< body or tool whose contact load is logged every step; empty: none
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
  double converged_fraction = 1; ///< of the steps
  double converged_contacts = 1; ///< of the contacts of all steps together, the share that was in converged steps
  double cycling_fraction = 0;
  double max_penetration = 0;    ///< [m], over all steps
  Snapshot final_state;
};

struct RunHooks {
  std::function<void(const Progress&)> progress;          ///< called about five times a second; may be empty
  std::function<bool()> interrupted;                      ///< polled every step; true: checkpoint and stop
  /// Asked after each frame but that of the start; true ends the run early and well (a heap at rest). May be empty. Must
  /// depend on its arguments alone, so that a resumed run ends where an uninterrupted one does.
  std::function<bool(const Snapshot&, const StepReport&)> finished;
  std::function<void(const std::string&)> warning;        ///< told once, when it arises; may be empty
  /// Adds to the loads of each step, after the model's own effects (the unknown force of a diagnosis). Must depend on its
  /// arguments alone. May be empty.
  std::function<void(const Snapshot&, BodyLoads&)> loads;
  /// Shown the log of every step, as a recorder would get it: with the load on Schedule::tracked. May be empty.
  std::function<void(const StepRecord&)> logged;
  /// Shown the state at the start and after every step, or part of one (StepReport::left); World tells the contacts of that step. May be empty.
  std::function<void(const Snapshot&, const World&)> stepped;
};

/// Steps `world` through the schedule, applying the model's effects, recording frames and checkpoints. `recorder` may be
/// null (nothing is written). With `resume`, continues from the newest checkpoint of the recorder, bit for bit; if there
/// is none, starts at the beginning and says so. Frames are recorded at the start, every `frame_interval`, and at the end;
/// checkpoints at the start, by the wall clock, and at the end or an interruption. Throws Error: Kind::input for an
/// impossible schedule, Kind::simulation if a state or residual is not finite; run.h5 then holds what came before.
RunReport run(World& world, const Model& model, const Schedule& schedule, Recorder* recorder, const RunHooks& hooks,
              bool resume = false);

}  // namespace repose
