#include "core/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

#include "core/error.hpp"

namespace repose {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr double progress_interval_s = 0.2;
constexpr double max_steps = 1e12;

struct StepCounts {
  std::int64_t steps = 0;
  std::int64_t per_frame = 1;
};

StepCounts count_steps(const Schedule& schedule) {
  const auto demand_positive = [](double value, const char* key) {
    if (!(value > 0) || !std::isfinite(value))
      throw Error(key, fmt::format("{} s is not a positive time", value), "give a positive number of seconds");
  };
  demand_positive(schedule.time_step, "solver.time_step");
  demand_positive(schedule.duration, "duration");
  demand_positive(schedule.frame_interval, "the interval between frames");
  const double steps = std::round(schedule.duration / schedule.time_step);
  if (steps < 1)
    throw Error("duration", fmt::format("{} s is shorter than half a time step of {} s", schedule.duration, schedule.time_step),
                "make the duration longer or the step smaller");
  if (steps > max_steps)
    throw Error("duration", fmt::format("{} s in steps of {} s are {:.3g} steps", schedule.duration, schedule.time_step, steps),
                "make the duration shorter or the step larger");
  const double per_frame = std::clamp(std::round(schedule.frame_interval / schedule.time_step), 1.0, steps);
  return {static_cast<std::int64_t>(steps), static_cast<std::int64_t>(per_frame)};
}

/// One product per component: zero unless something is infinite or not a number.
void demand_finite(const Model& model, const Snapshot& state) {
  double sum = 0;
  for (std::size_t i = 0; i < state.size(); ++i)
    sum += 0 * (state.position[i].sum() + state.orientation[i].coeffs().sum() + state.velocity[i].sum() +
                state.angular_velocity[i].sum());
  if (sum == 0) return;
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (state.position[i].allFinite() && state.orientation[i].coeffs().allFinite() && state.velocity[i].allFinite() &&
        state.angular_velocity[i].allFinite())
      continue;
    const int name = model.bodies[i].name;
    throw Error("", fmt::format("the state of body {} ({}) is no longer finite", i,
                                name >= 0 ? model.names[static_cast<std::size_t>(name)] : "unnamed"),
                "make the time step smaller, and look for bodies that overlap at the start", Error::Kind::simulation);
  }
}

/// Time left, from the speed over the last ten to twenty seconds: the cost of a step drifts as grains come to rest.
class RemainingTime {
 public:
  double estimate(double wall_s, std::int64_t step, std::int64_t steps) {
    if (!begun_ || wall_s - recent_.wall_s > window_s) {
      older_ = begun_ ? recent_ : Mark{wall_s, step};
      recent_ = {wall_s, step};
      begun_ = true;
    }
    const std::int64_t done = step - older_.step;
    return done > 0 ? (wall_s - older_.wall_s) / static_cast<double>(done) * static_cast<double>(steps - step) : 0;
  }

 private:
  static constexpr double window_s = 10;
  struct Mark {
    double wall_s = 0;
    std::int64_t step = 0;
  };
  bool begun_ = false;
  Mark older_, recent_;
};

/// The sums behind the means of a RunReport.
struct Tally {
  std::int64_t steps = 0, contacts = 0, iterations = 0, converged = 0, converged_contacts = 0, cycling = 0;
  double residual_max = 0, penetration_max = 0;

  void add(const StepReport& r) {
    ++steps;
    contacts += r.contacts;
    iterations += r.iterations;
    converged += r.converged;
    converged_contacts += r.converged ? r.contacts : 0;
    cycling += r.cycling;
    residual_max = std::max(residual_max, r.residual);
    penetration_max = std::max(penetration_max, r.penetration);
  }
  void fill(RunReport& out) const {
    out.steps = steps;
    out.residual_max = residual_max;
    out.max_penetration = penetration_max;
    if (steps == 0) return;
    const double n = static_cast<double>(steps);
    out.contacts_mean = static_cast<double>(contacts) / n;
    out.iterations_mean = static_cast<double>(iterations) / n;
    out.converged_fraction = static_cast<double>(converged) / n;
    if (contacts > 0) out.converged_contacts = static_cast<double>(converged_contacts) / static_cast<double>(contacts);
    out.cycling_fraction = static_cast<double>(cycling) / n;
  }
};

class Runner {
 public:
  Runner(World& world, const Model& model, const Schedule& schedule, Recorder* recorder, const RunHooks& hooks)
      : world_(world), model_(model), schedule_(schedule), counts_(count_steps(schedule)), recorder_(recorder), hooks_(hooks) {
    if (schedule.tracked.empty()) return;
    for (std::size_t i = 0; i < model.bodies.size(); ++i)
      if (const int name = model.bodies[i].name; name >= 0 && model.names[static_cast<std::size_t>(name)] == schedule.tracked)
        tracked_.push_back(static_cast<int>(i));
    if (tracked_.empty()) throw Error("tools", "there is no tool " + schedule.tracked + " to track", "name one of the scene");
  }

  RunReport run(bool resume) {
    if (!(resume && restore())) begin();
    while (step_ < counts_.steps && !stopped_) {
      if (hooks_.interrupted && hooks_.interrupted()) {
        report_.end = RunReport::End::interrupted;
        break;
      }
      advance();
      if (step_ % counts_.per_frame == 0 || step_ == counts_.steps) record_frame();
      tell_progress(false);
      if (seconds_since(last_checkpoint_) >= schedule_.checkpoint_wall_s) save_checkpoint();
    }
    if (stopped_) report_.end = RunReport::End::stopped;
    tell_progress(true);
    report_.wall_s = save_checkpoint();
    return finish();
  }

 private:
  void begin() {
    world_.read(state_);
    demand_finite(model_, state_);
    if (recorder_) recorder_->frame(state_);
    if (hooks_.stepped) hooks_.stepped(state_, world_);
    save_checkpoint();
  }

  bool restore() {
    std::optional<Recorder::Resumed> saved = recorder_->resume();
    if (!saved) {
      warn("there is no checkpoint to resume from; the run starts at the beginning");
      return false;
    }
    if (!saved->warning.empty()) warn(saved->warning);
    world_.restore(saved->frame);
    world_.read(state_);
    step_ = saved->frame.step;
    stopped_ = saved->ended;
    earlier_wall_s_ = saved->wall_s;
    for (const StepRecord& record : saved->steps) tally_.add(record.report);
    if (!saved->steps.empty()) last_ = saved->steps.back().report;
    return true;
  }

  void advance() {
    const double from = state_.time;
    try {
      last_ = {};
      last_.left = schedule_.time_step;
      while (last_.left > 0) advance_by(last_.left);
    } catch (const Error& problem) {
      if (!problem.place().empty()) throw;
      throw Error(fmt::format("step {} from t = {:.6g} s", step_ + 1, from), problem.problem(), problem.remedy(),
                  problem.kind());
    }
    ++step_;
    tally_.add(last_);
    if (recorder_ || hooks_.logged) {
      const StepRecord line = log_line();
      if (recorder_) recorder_->step(line);
      if (hooks_.logged) hooks_.logged(line);
    }
  }

  /// One step of the world, and what it adds to the report of the whole step.
  void advance_by(double time) {
    evaluate_loads(model_, state_, loads_);
    if (schedule_.loads_half_way) look_ahead(0.5 * time);
    if (hooks_.loads) hooks_.loads(schedule_.loads_half_way ? ahead_ : state_, loads_);
    const StepReport part = world_.step(time, loads_);
    if (!(part.left < time)) throw Error("", "the backend did not advance", "this is a defect of the backend", Error::Kind::simulation);
    world_.read(state_);
    demand_finite(model_, state_);
    if (!std::isfinite(part.residual) || !std::isfinite(part.penetration))
      throw Error("", "the residual of the solver is no longer finite", "make the time step smaller", Error::Kind::simulation);
    last_.contacts = std::max(last_.contacts, part.contacts);
    last_.iterations += part.iterations;
    last_.residual = std::max(last_.residual, part.residual);
    last_.converged = last_.converged && part.converged;
    last_.cycling = last_.cycling || part.cycling;
    last_.penetration = std::max(last_.penetration, part.penetration);
    last_.contact_work += part.contact_work;
    last_.left = part.left;
    if (hooks_.stepped) hooks_.stepped(state_, world_);
  }

  /// The loads on bodies that go on for `time` under the present ones; contacts are left out.
  void look_ahead(double time) {
    ahead_ = state_;
    ahead_.time += time;
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      const Body& body = model_.bodies[i];
      if (!body.dynamic) continue;
      ahead_.position[i] += time * state_.velocity[i];
      ahead_.orientation[i] = (rotation_of(time * state_.angular_velocity[i]) * state_.orientation[i]).normalized();
      // Principal axes of the orientation before.
      const Mat3 axes = state_.orientation[i].toRotationMatrix();
      const Vec3 momentum = body.inertia.cwiseProduct(axes.transpose() * state_.angular_velocity[i]) + time * (axes.transpose() * loads_.torque[i]);
      ahead_.angular_velocity[i] = axes * Vec3(momentum.array() / (body.inertia.array() + time * loads_.angular_damping[i]));
      ahead_.velocity[i] = (body.mass * state_.velocity[i] + time * loads_.force[i]) / (body.mass + time * loads_.linear_damping[i]);
    }
    evaluate_loads(model_, ahead_, loads_);
  }

  StepRecord log_line() {
    StepRecord line{state_.time, last_};
    if (tracked_.empty()) return line;
    world_.read_at(tracked_, contacts_);
    const auto first = static_cast<std::size_t>(tracked_.front());
    const Vec3 centre = state_.position[first];
    if (const Body& body = model_.bodies[first]; body.yield) {
      const Pose initial{model_.initial.position[first], model_.initial.orientation[first]};
      line.tool_rise = std::max(0.0, centre.z() - pose_at(body.motion, initial, state_.time).position.z());
    }
    for (const Contact& contact : contacts_) {
      const bool is_a = std::binary_search(tracked_.begin(), tracked_.end(), contact.a);
      const bool is_b = std::binary_search(tracked_.begin(), tracked_.end(), contact.b);
      if (is_a == is_b) continue;
      const double sign = is_b ? 1 : -1;
      line.tool_force += sign * contact.force;
      line.tool_torque += sign * ((contact.point - centre).cross(contact.force) + contact.torque);
    }
    return line;
  }

  void record_frame() {
    if (recorder_) recorder_->frame(state_);
    stopped_ = step_ < counts_.steps && hooks_.finished && hooks_.finished(state_, last_);
  }

  /// The wall time that a resumed run will count on from.
  double save_checkpoint() {
    last_checkpoint_ = Clock::now();
    const double wall_s = earlier_wall_s_ + seconds_since(start_);
    if (!recorder_) return wall_s;
    Frame frame;
    world_.save(frame);
    frame.step = step_;
    recorder_->checkpoint(frame, wall_s, stopped_);
    return wall_s;
  }

  RunReport finish() {
    tally_.fill(report_);
    report_.final_state = state_;
    if (recorder_) recorder_->finish();
    return std::move(report_);
  }

  void tell_progress(bool last) {
    if (!hooks_.progress || (last ? told_step_ == step_ : seconds_since(last_progress_) < progress_interval_s)) return;
    last_progress_ = Clock::now();
    told_step_ = step_;
    const double wall = seconds_since(start_);
    hooks_.progress({step_, counts_.steps, state_.time, wall, remaining_.estimate(wall, step_, counts_.steps), last_});
  }

  void warn(const std::string& text) const {
    if (hooks_.warning) hooks_.warning(text);
  }

  World& world_;
  const Model& model_;
  const Schedule& schedule_;
  const StepCounts counts_;
  Recorder* recorder_;
  const RunHooks& hooks_;

  std::int64_t step_ = 0, told_step_ = -1;
  bool stopped_ = false;  ///< by the `finished` hook
  std::vector<int> tracked_;  ///< bodies of Schedule::tracked, ascending
  std::vector<Contact> contacts_;
  Snapshot state_, ahead_;
  BodyLoads loads_;
  StepReport last_;
  Tally tally_;
  RunReport report_;
  RemainingTime remaining_;
  double earlier_wall_s_ = 0;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point last_checkpoint_ = start_, last_progress_ = start_;
};

}  // namespace

RunReport run(World& world, const Model& model, const Schedule& schedule, Recorder* recorder, const RunHooks& hooks,
              bool resume) {
  assert(recorder || !resume);
  Runner runner(world, model, schedule, recorder, hooks);
  try {
    return runner.run(resume);
  } catch (const Error& problem) {
    if (recorder && problem.kind() == Error::Kind::simulation) {
      try {
        recorder->finish();
      } catch (const Error&) {
        // The first failure is the one to tell about; a full disk would only hide it behind a second.
      }
    }
    throw;
  }
}

}  // namespace repose
