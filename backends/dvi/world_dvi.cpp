#include "backends/dvi/world_dvi.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "backends/dvi/cone_solver.hpp"
#include "backends/dvi/contact_finder.hpp"
#include "backends/dvi/impact.hpp"
#include "backends/dvi/mid_step.hpp"
#include "backends/dvi/resize.hpp"
#include "backends/dvi/separation.hpp"
#include "backends/dvi/team.hpp"
#include "backends/dvi/touch.hpp"
#include "backends/dvi/units.hpp"
#include "backends/dvi/world_dvi_bodies.hpp"
#include "backends/dvi/world_dvi_impulses.hpp"
#include "backends/dvi/world_dvi_laws.hpp"
#include "backends/dvi/world_dvi_yield.hpp"
#include "core/error.hpp"

namespace repose::dvi {

namespace {

constexpr double penetration_slop = 1e-3;  // of R*: deeper overlap is removed, shallower is left alone
constexpr double slop_of_second_order = 1e-5;  // what a landing leaves must not show in precise readings: it would pass for a start value
constexpr int separation_rounds = 4;
constexpr double touching = 1e-6;            // of R*
constexpr std::size_t worth_a_thread = 500;  // bodies: below, waking threads costs more than it saves
constexpr double blow_share = 1e-3;          // of the scene's step: what a blow takes in second order
constexpr int most_cuts = 50;                // steps one after another that end at a touch; a ball that comes to rest has no last one
constexpr double no_blow = 1e-9;             // of R*: an approach by less in a step is rounding
constexpr double smooth_jump = 1e-4;         // of R*: a jump of velocity that moves a contact by less is none

Mat3 rotated(const Mat3& rotation, const Vec3& diagonal) { return rotation * diagonal.asDiagonal() * rotation.transpose(); }

class WorldDvi final : public World {
 public:
  WorldDvi(const Model& model, const SolverOptions& options)
      : model_(model), options_(options), units_(units_of(model)), finder_(model_, units_.length), laws_(model_, units_),
        yielding_(model_, units_), bodies_(model_, units_), last_(bodies_) {
    slot_.assign(bodies_.count(), -1);
    if (bodies_.count() < worth_a_thread) options_.threads = 1;
  }

  StepReport step(double dt, const BodyLoads& loads) override {
    if (!(dt > 0) || !std::isfinite(dt)) throw Error("step", "the time step must be a positive number", "");
    if (loads.force.size() != model_.bodies.size())
      throw Error("step", "the loads are not those of this model", "fill them with evaluate_loads()");
    double h = dt / units_.time;
    place_prescribed(dt);
    free_velocities(h, loads);
    const std::vector<FoundContact>* all =
        &finder_.find(placement(free_velocity_, free_angular_), h, options_.search_margin, options_.threads);
    const double asked = dt;
    if (second_order()) {
      const double end = end_at_touch(*all, h);
      if (end < h) {
        h = end;
        dt = h * units_.time;
        place_prescribed(dt);
        free_velocities(h, loads);
      }
      if (!cuts_used_up_) all = &met_;
    }
    const std::vector<FoundContact>& found = *all;
    StepReport report = report_of(found, solve_contacts(found, h));
    report.left = asked - dt;
    last_.keep(found, problem_, impulse_, h, options_.threads);
    if (second_order()) find_smooth(found, h);
    advance(h);
    bodies_.time += dt;
    moved_.clear();
    for (int round = 0; round < separation_rounds && !laws_.compliant() && push_overlaps_apart();) ++round;
    wrap();
    return report;
  }

  void read(Snapshot& state) const override { bodies_.read(state, options_.threads); }

  void read(std::vector<Contact>& contacts) const override { last_.read(contacts, units_, options_.threads); }

  void read_at(std::span<const int> bodies, std::vector<Contact>& contacts) const override {
    last_.read_at(bodies, contacts, units_, options_.threads);
  }

  void save(Frame& frame) const override {
    read(frame.state);
    last_.save(frame, units_);
  }

  void restore(const Frame& frame) override {
    if (frame.state.size() != model_.bodies.size() || !last_.restore(frame, units_))
      throw Error("checkpoint", "it does not fit this model", "resume with the scene and seed that wrote it, or start afresh");
    bodies_.load(frame.state);
  }

 private:
  /// Prescribed bodies stand where they were prescribed to be, and move with the twist that takes them to the step's end.
  void place_prescribed(double dt) {
    yielding_.begin_step();
    for (const std::int32_t index : bodies_.prescribed) {
      const auto i = static_cast<std::size_t>(index);
      const Body& body = model_.bodies[i];
      const Pose initial{model_.initial.position[i], model_.initial.orientation[i]};
      const Pose pose = pose_at(body.motion, initial, bodies_.time);
      const Twist twist = mean_twist(body.motion, initial, bodies_.time, dt);
      const double height = bodies_.position[i].z(), rise = bodies_.velocity[i].z();
      bodies_.position[i] = pose.position / units_.length;
      bodies_.orientation[i] = pose.orientation;
      bodies_.velocity[i] = twist.linear / units_.velocity();
      bodies_.angular[i] = twist.angular * units_.time;
      if (body.yield) yielding_.place(i, height, rise, bodies_.position[i], bodies_.velocity[i]);
    }
  }

  /// v_free = (m v + h f) / (m + h damping); in second order (m v + h (f - damping v / 2)) / (m + h damping / 2), but where that would
  /// swing. Likewise for the rotation in the principal axes.
  void free_velocities(double h, const BodyLoads& loads) {
    const std::size_t n = bodies_.count();
    rotation_.resize(n);
    inverse_.resize(n);
    free_velocity_.resize(n);
    free_angular_.resize(n);
    const double torque_unit = units_.force() * units_.length;
    for_each_index(options_.threads, n, [&](std::size_t i) {
      rotation_[i] = bodies_.orientation[i].toRotationMatrix();
      inverse_[i] = {};
      free_velocity_[i] = bodies_.velocity[i];
      free_angular_[i] = bodies_.angular[i];
      if (!bodies_.dynamic[i]) return;
      const double damping = h * loads.linear_damping[i] / (units_.mass / units_.time);
      const double ahead = second_order() && damping < bodies_.mass[i] ? 0.5 * damping : damping;  // the rest acts on the velocity before
      const double damped = bodies_.mass[i] + ahead;
      free_velocity_[i] = ((bodies_.mass[i] - (damping - ahead)) * bodies_.velocity[i] + h * (loads.force[i] / units_.force())) / damped;
      const Vec3& inertia = bodies_.inertia[i];
      const double braking = h * (loads.angular_damping[i] / (units_.mass * units_.length * units_.length / units_.time));
      const double braking_ahead = second_order() && braking < inertia.minCoeff() ? 0.5 * braking : braking;
      const Vec3 inverse = (inertia.array() + braking_ahead).inverse();
      const Vec3 kept = inertia.array() - (braking - braking_ahead);
      const Vec3 body_momentum =
          kept.cwiseProduct(rotation_[i].transpose() * bodies_.angular[i]) + rotation_[i].transpose() * Vec3(h * (loads.torque[i] / torque_unit));
      free_angular_[i] = rotation_[i] * inverse.cwiseProduct(body_momentum);
      inverse_[i].mass = 1 / damped;
      const Mat3 world = bodies_.isotropic[i] ? Mat3(inverse.x() * Mat3::Identity()) : rotated(rotation_[i], inverse);
      inverse_[i].inertia = {world(0, 0), world(0, 1), world(0, 2), world(1, 1), world(1, 2), world(2, 2)};
    });
    for (const std::int32_t i : yielding_.released())
      free_velocity_[static_cast<std::size_t>(i)].z() = yielding_.free_rise(static_cast<std::size_t>(i), h);
  }

  /// The bodies where they are, with these velocities.
  BodyPlacement placement(const std::vector<Vec3>& velocity, const std::vector<Vec3>& angular_velocity) {
    const std::size_t n = bodies_.count();
    turning_speed_.resize(n);
    present_.resize(n);
    all_or_fail(n, [&](std::size_t i) {
      // Unbounded bodies that turn (a half-space) have no largest speed; near the others they move like their origin.
      const double turning = angular_velocity[i].norm();
      turning_speed_[i] = turning > 0 && std::isfinite(bodies_.bound[i]) ? turning * bodies_.bound[i] : 0.0;
      present_[i] = 1;
      return !bodies_.dynamic[i] || (velocity[i].allFinite() && angular_velocity[i].allFinite());
    }, [](std::size_t i) { return i; });
    for (const std::int32_t i : bodies_.gated)
      present_[static_cast<std::size_t>(i)] = model_.bodies[static_cast<std::size_t>(i)].exists_at(bodies_.time) ? 1 : 0;
    return {bodies_.position, rotation_, velocity, angular_velocity, turning_speed_, present_};
  }

  /// Calls finite(i) for every i < n; fails by the body of the first that is not.
  template <class Finite, class BodyOf>
  void all_or_fail(std::size_t n, Finite&& finite, BodyOf&& body_of) const {
    std::atomic<bool> all = true;
    for_each_index(options_.threads, n, [&](std::size_t i) {
      if (!finite(i)) all.store(false, std::memory_order_relaxed);
    });
    for (std::size_t i = 0; !all && i < n; ++i)
      if (!finite(i)) fail(body_of(i));
  }

  [[noreturn]] void fail(std::size_t body) const {
    throw Error("body " + std::to_string(body),
                "its velocity is not a finite number at t = " + std::to_string(bodies_.time) + " s",
                "this is a failure of the simulation: try a smaller time_step, and look for bodies pressed together by tools",
                Error::Kind::simulation);
  }

  double slop() const { return second_order() ? slop_of_second_order : penetration_slop; }
  bool second_order() const { return options_.integration == Integration::second_order; }

  /// Where a step of `h` has to end. Blows that fall within a short step of their own are all met in it; otherwise the first one ends the step, and none is
  /// met in it: not one that comes just after the end and that rule 2 of impact.hpp would take at the beginning. `met_` are the contacts of this part.
  double end_at_touch(const std::vector<FoundContact>& found, double h) {
    const double scene_step = options_.time_step / units_.time, blow_step = blow_share * scene_step;
    touch_.clear();
    double end = h;
    bool now = false;
    for (const FoundContact& contact : found) {
      const Approach approach = approach_of(contact, h);
      Touch touch = touch_of(approach);
      if (!is_blow(approach, touch, scene_step) || touch.speed * scene_step <= no_blow * arm_of(contact)) touch = {};
      touch_.push_back(touch.time);
      if (touch.time <= blow_step)
        now = now || !laws_.compliant();  // a spring takes the time it takes
      else
        end = std::min(end, touch.time);
    }
    if (now) end = blow_step;
    const bool cut = end < h * (1 - 1e-9);
    cuts_used_up_ = cut && ++cuts_ > most_cuts;
    if (!cut || cuts_used_up_) {
      cuts_ = 0;
      end = h;
    }
    met_.clear();
    for (std::size_t i = 0; i < found.size(); ++i) {
      const bool at_once = touch_[i] <= blow_step;
      if (!at_once && !now && std::isfinite(touch_[i])) {
        const Approach approach = approach_of(found[i], h);
        if (approach.gap + end * (approach.speed + end * approach.acceleration) <= 0) continue;
      }
      met_.push_back(found[i]);
      // What is left of the gap would be closed by a part of the speed, and the rest of it be a second blow, at another slip.
      if (now && at_once) met_.back().point.gap = std::min(met_.back().point.gap, 0.0);
    }
    return end;
  }

  Approach approach_of(const FoundContact& contact, double h) const {
    const auto a = static_cast<std::size_t>(contact.id.a()), b = static_cast<std::size_t>(contact.id.b());
    const Vec3 arm_a = contact.point.point - bodies_.position[a], arm_b = contact.point.point - place_beside(contact.id);
    const auto along_normal = [&](const std::vector<Vec3>& velocity, const std::vector<Vec3>& angular) {
      return contact.point.normal.dot(velocity[b] + angular[b].cross(arm_b) - velocity[a] - angular[a].cross(arm_a));
    };
    const double before = along_normal(bodies_.velocity, bodies_.angular);
    return {contact.point.gap, before, (along_normal(free_velocity_, free_angular_) - before) / h};
  }

  /// Bodies that no contact stops or throws within this step move by their mean velocity.
  void find_smooth(const std::vector<FoundContact>& found, double h) {
    smooth_.assign(bodies_.count(), 1);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (impulse_[i] == Impulse{}) continue;
      const ConeContact& c = problem_.contacts[i];
      const double jump = std::abs(relative_velocity(c, velocity_after_, angular_after_)[0] - impact_[i].before);
      if (!laws_.compliant() && 0.5 * h * jump <= smooth_jump * c.arm) continue;
      smooth_[static_cast<std::size_t>(found[i].id.a())] = 0;
      smooth_[static_cast<std::size_t>(found[i].id.b())] = 0;
    }
  }

  /// Once more for each body found to give way.
  SolveReport solve_contacts(const std::vector<FoundContact>& found, double h) {
    const ConeSolver solver = [this](const auto& p, auto g, auto& v, auto& w) { return solve(p, options_, g, v, w, room_); };
    SolveReport solved;
    int iterations = 0;
    do {
      build_problem(found, h);
      if (options_.warm_start)
        last_.start(found, problem_, h, options_.threads, impulse_);
      else
        impulse_.assign(found.size(), Impulse{});
      yielding_.add_stops(slot_, h, problem_, impact_, impulse_);
      const auto plainly = [&] {
        return solve_with_impacts(problem_, impact_, h, options_.tolerance, solver, impulse_, velocity_after_, angular_after_, options_.threads);
      };
      solved = second_order() ? solve_at_mid_step(problem_, impact_, velocities_before(), h, plainly, impulse_, velocity_after_, angular_after_) : plainly();
      solved.iterations = iterations += solved.iterations;
    } while (yielding_.any() && yielding_.release_overloaded(found, problem_, impulse_, h));
    return solved;
  }

  const VelocitiesBefore& velocities_before() {
    before_.linear.resize(bodies_.count());
    before_.angular.resize(bodies_.count());
    for (std::size_t s = 0; s < body_of_slot_.size(); ++s) {
      before_.linear[s] = bodies_.velocity[static_cast<std::size_t>(body_of_slot_[s])];
      before_.angular[s] = bodies_.angular[static_cast<std::size_t>(body_of_slot_[s])];
    }
    return before_;
  }

  void build_problem(const std::vector<FoundContact>& found, double h) {
    const std::size_t n = bodies_.count();
    body_of_slot_.assign(finder_.order().begin(), finder_.order().end());
    body_of_slot_.insert(body_of_slot_.end(), yielding_.released().begin(), yielding_.released().end());
    problem_.dynamic_bodies = static_cast<std::int32_t>(body_of_slot_.size());
    problem_.inverse_mass.resize(n);
    problem_.velocity.resize(n);
    problem_.angular_velocity.resize(n);
    for (const std::int32_t i : bodies_.prescribed)
      if (!yielding_.is_released(static_cast<std::size_t>(i))) body_of_slot_.push_back(i);
    for_each_index(options_.threads, n, [&](std::size_t s) {
      const auto body = static_cast<std::size_t>(body_of_slot_[s]);
      slot_[body] = static_cast<std::int32_t>(s);
      problem_.inverse_mass[s] = inverse_[body];
      problem_.velocity[s] = free_velocity_[body];
      problem_.angular_velocity[s] = free_angular_[body];
    });
    resize_sparingly(problem_.contacts, found.size());
    resize_sparingly(impact_, found.size());
    laws_.begin(problem_);
    for_each_index(laws_.any() ? 1 : options_.threads, found.size(), [&](std::size_t i) {
      const auto a = static_cast<std::size_t>(found[i].id.a()), b = static_cast<std::size_t>(found[i].id.b());
      const PairLaw& law = model_.law(bodies_.material[a], bodies_.material[b]);
      const FrictionArms arms = friction_arms(law, bodies_.radius[a], bodies_.radius[b]);
      const ContactPoint& point = found[i].point;
      ConeContact& c = problem_.contacts[i];
      c.a = slot_[a];
      c.b = slot_[b];
      c.normal = point.normal;
      c.arm_a = point.point - bodies_.position[a];
      c.arm_b = point.point - place_beside(found[i].id);
      c.friction = law.friction;
      c.arm = arm_of(found[i]);
      c.rolling = arms.rolling / units_.length / c.arm;
      c.spinning = arms.spinning / units_.length / c.arm;
      // Bodies that touch stand apart by rounding: a range of zero still holds them.
      const bool holds = law.cohesion > 0 && point.gap <= std::max(law.cohesion_range / units_.length, touching * c.arm);
      c.cohesion = holds ? h * (law.cohesion / units_.force()) : 0.0;
      impact_[i].gap = point.gap;
      impact_[i].restitution = law.restitution;
      const Vec3 before = bodies_.velocity[b] + bodies_.angular[b].cross(c.arm_b) - bodies_.velocity[a] - bodies_.angular[a].cross(c.arm_a);
      impact_[i].before = c.normal.dot(before);
      if (laws_.any()) laws_.apply(problem_, c, impact_[i], before, h);
    });
  }

  StepReport report_of(const std::vector<FoundContact>& found, const SolveReport& solved) const {
    StepReport report;
    report.contacts = static_cast<int>(found.size());
    report.iterations = solved.iterations;
    report.residual = solved.residual;
    report.converged = solved.converged;
    report.cycling = solved.cycling;
    report.penetration = units_.length * most_of(options_.threads, found.size(), [&](std::size_t i) { return -found[i].point.gap; });
    const double work = sum_over(options_.threads, found.size(), [&](std::size_t i) {
      const ConeContact& c = problem_.contacts[i];
      const Impulse free = relative_velocity(c, problem_.velocity, problem_.angular_velocity);
      const Impulse after = relative_velocity(c, velocity_after_, angular_after_);
      double sum = 0;
      for (std::size_t k = 0; k < 6; ++k) sum += 0.5 * impulse_[i][k] * (free[k] + after[k]);
      return sum;
    });
    report.contact_work = work * units_.energy();
    return report;
  }

  /// What the linear step left of overlap (turning bodies, curved tools, the solver's tolerance) is measured by geometry at
  /// the new positions and taken away there. Returns whether it was deep enough to look again, because the correction is
  /// linear too. At every contact each time, for a push may reach far; contacts of bodies that stand are as they were found.
  bool push_overlaps_apart() {
    const std::size_t n = bodies_.count();
    resting_.resize(n, Vec3::Zero());
    const bool first = moved_.empty();
    for_each_index(options_.threads, n, [&](std::size_t i) {
      if (first || moved_[i] != 0) rotation_[i] = bodies_.orientation[i].toRotationMatrix();
    });
    const std::vector<FoundContact>& found = finder_.find_again(placement(resting_, resting_), moved_, options_.threads);
    const double deepest =  // over R*
        most_of(options_.threads, found.size(), [&](std::size_t i) { return -found[i].point.gap / arm_of(found[i]); });
    if (deepest <= slop()) return false;
    // The contact problem of this step has been solved and told: its room serves again.
    for_each_index(options_.threads, n, [&](std::size_t i) {
      if (!first && moved_[i] == 0) return;
      InverseMass& inverse_mass = problem_.inverse_mass[static_cast<std::size_t>(slot_[i])];
      inverse_mass = {};
      if (!bodies_.dynamic[i]) return;
      inverse_mass.mass = 1 / bodies_.mass[i];
      const Vec3 inverse = bodies_.inertia[i].cwiseInverse();
      const Mat3 world = bodies_.isotropic[i] ? Mat3(inverse.x() * Mat3::Identity()) : rotated(rotation_[i], inverse);
      inverse_mass.inertia = {world(0, 0), world(0, 1), world(0, 2), world(1, 1), world(1, 2), world(2, 2)};
    });
    resize_sparingly(problem_.contacts, found.size());
    resize_sparingly(gap_, found.size());
    for_each_index(options_.threads, found.size(), [&](std::size_t i) {
      ConeContact& c = problem_.contacts[i];
      c.a = slot_[static_cast<std::size_t>(found[i].id.a())];
      c.b = slot_[static_cast<std::size_t>(found[i].id.b())];
      c.normal = found[i].point.normal;
      c.arm_a = found[i].point.point - bodies_.position[static_cast<std::size_t>(found[i].id.a())];
      c.arm_b = found[i].point.point - place_beside(found[i].id);
      c.arm = arm_of(found[i]);
      gap_[i] = found[i].point.gap;
    });
    push_apart(problem_, gap_, slop(), options_.threads, displacement_);
    moved_.resize(n);
    for_each_index(options_.threads, n, [&](std::size_t i) {
      const Displacement& pushed = displacement_[static_cast<std::size_t>(slot_[i])];
      moved_[i] = bodies_.dynamic[i] && !(pushed.shift.isZero(0) && pushed.turn.isZero(0));
      if (moved_[i] == 0) return;
      bodies_.position[i] += pushed.shift;
      bodies_.turn(i, pushed.turn);
    });
    return deepest > 10 * slop();
  }

  /// Where the image of body b stands that body a meets.
  Vec3 place_beside(const ContactId& id) const {
    const Vec3& place = bodies_.position[static_cast<std::size_t>(id.b())];
    return finder_.periodic() ? Vec3(place + finder_.image_shift(bodies_.position, id.a(), id.b())) : place;
  }

  /// Bodies that left the periodic cell come back on the other side. Contacts are named by bodies and kept in world axes, so
  /// nothing else changes.
  void wrap() {
    if (!finder_.periodic()) return;
    const PeriodicCell cell = model_.periodic.in_unit(units_.length);
    for_each_index(options_.threads, bodies_.count(), [&](std::size_t i) {
      if (bodies_.dynamic[i]) bodies_.position[i] = cell.wrapped(bodies_.position[i]);
    });
  }

  /// R* of the pair.
  double arm_of(const FoundContact& contact) const {
    return bodies_.arm_of(static_cast<std::size_t>(contact.id.a()), static_cast<std::size_t>(contact.id.b()));
  }

  /// Symplectic Euler; in second order the mean of the velocities at both ends, and the spin half way.
  void advance(double h) {
    const auto dynamic = static_cast<std::size_t>(problem_.dynamic_bodies);
    all_or_fail(dynamic, [&](std::size_t slot) { return velocity_after_[slot].allFinite() && angular_after_[slot].allFinite(); },
                [&](std::size_t slot) { return static_cast<std::size_t>(body_of_slot_[slot]); });
    for_each_index(options_.threads, dynamic, [&](std::size_t slot) {
      const auto body = static_cast<std::size_t>(body_of_slot_[slot]);
      const Vec3 before = bodies_.velocity[body], spin_before = bodies_.angular[body];
      bodies_.velocity[body] = velocity_after_[slot];
      bodies_.angular[body] = angular_after_[slot];
      if (second_order() && smooth_[body] != 0) {
        bodies_.position[body] += 0.5 * h * (before + bodies_.velocity[body]);
        const Vec3 gained = bodies_.angular[body] - spin_before;  // by torques: half of it acts on average
        bodies_.turn(body, h * (bodies_.spin_after(body, 0.5 * h * bodies_.angular[body]) - 0.5 * gained));
      } else {
        bodies_.position[body] += h * bodies_.velocity[body];
        bodies_.turn(body, h * bodies_.angular[body]);
      }
    });
    // Prescribed bodies are shown where they will be at the end of the step.
    for (const std::int32_t index : bodies_.prescribed) {
      const auto i = static_cast<std::size_t>(index);
      const Pose initial{model_.initial.position[i], model_.initial.orientation[i]};
      const Pose pose = pose_at(model_.bodies[i].motion, initial, bodies_.time + h * units_.time);
      const double height = bodies_.position[i].z(), stop = pose.position.z() / units_.length;
      bodies_.position[i] = pose.position / units_.length;
      bodies_.orientation[i] = pose.orientation;
      if (!yielding_.is_released(i)) continue;
      bodies_.position[i].z() = height;
      yielding_.stand_on_stops(i, stop, bodies_.position[i], bodies_.velocity[i]);
    }
  }

  Model model_;
  SolverOptions options_;
  Units units_;
  ContactFinder finder_;
  ContactLaws laws_;
  YieldingBodies yielding_;
  WorldBodies bodies_;
  LastImpulses last_;

  // Work space of one step.
  std::vector<Mat3> rotation_;
  std::vector<InverseMass> inverse_;
  std::vector<Vec3> free_velocity_, free_angular_;
  std::vector<double> turning_speed_;
  std::vector<char> present_;
  std::vector<std::int32_t> slot_, body_of_slot_;
  ConeProblem problem_;
  SolverRoom room_;
  std::vector<ImpactData> impact_;
  std::vector<Impulse> impulse_;
  std::vector<Vec3> velocity_after_, angular_after_;
  VelocitiesBefore before_;           // by slot, in second order
  std::vector<double> touch_;         // by found contact: time of a blow, in second order
  std::vector<FoundContact> met_;     // those of a step or part of one, in second order
  std::vector<char> smooth_;          // by body
  int cuts_ = 0;                      // one after another; 0 again wherever a state can be saved
  bool cuts_used_up_ = false;         // in this step: all contacts are met in what is left of it
  std::vector<Vec3> resting_;         // zeros
  std::vector<char> moved_;           // by body, by the last correction of this step; empty: there was none
  std::vector<double> gap_;
  std::vector<Displacement> displacement_;
};

}  // namespace

std::vector<std::string> unsupported(const Model&) { return {}; }

std::unique_ptr<World> make_world(const Model& model, const SolverOptions& options) {
  validate(model);
  if (!(options.tolerance > 0) || !(options.max_iterations > 0) || options.threads < 1 || !(options.search_margin >= 1))
    throw Error("solver", "tolerance and max_iterations must be positive, threads and search_margin at least 1", "");
  if (options.integration == Integration::second_order && YieldingBodies(model, units_of(model)).any())
    throw Error("solver.integration", "a tool that yields is stepped by symplectic Euler alone", "leave the integration at its default");
  return std::make_unique<WorldDvi>(model, options);
}

}  // namespace repose::dvi
