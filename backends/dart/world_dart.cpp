#include "backends/dart/world_dart.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "backends/dart/fcl_contacts.hpp"
#include "backends/dart/lcp_solver.hpp"
#include "backends/dvi/contact_finder.hpp"
#include "backends/dvi/impact.hpp"
#include "backends/dvi/separation.hpp"
#include "backends/dvi/units.hpp"
#include "core/contact_effects.hpp"
#include "core/error.hpp"

namespace repose::dart {

namespace {

using dvi::ConeContact;
using dvi::FoundContact;

constexpr double penetration_slop = 1e-3;  // of R*: deeper overlap is removed, shallower is left alone
constexpr double touching = 1e-6;          // of R*: cohesion of range zero holds that far
constexpr int most_passes = 60;

/// A contact of this step, whoever found it.
struct Touch {
  int a = -1, b = -1;
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitZ();
  double gap = 0;
};

class WorldDart final : public World {
 public:
  WorldDart(const Model& model, const SolverOptions& options)
      : model_(model), options_(options), units_(dvi::units_of(model)), finder_(model_, units_.length) {
    const std::size_t n = model_.bodies.size();
    slot_.assign(n, -1);
    for (const bool dynamic : {true, false})
      for (std::size_t i = 0; i < n; ++i)
        if (model_.bodies[i].dynamic == dynamic) {
          slot_[i] = static_cast<std::int32_t>(body_of_slot_.size());
          body_of_slot_.push_back(i);
        }
    problem_.dynamic_bodies = static_cast<std::int32_t>(
        std::count_if(model_.bodies.begin(), model_.bodies.end(), [](const Body& b) { return b.dynamic; }));
    solver_ = std::make_unique<LcpSolver>(static_cast<std::size_t>(problem_.dynamic_bodies));
    for (std::size_t i = 0; i < n; ++i) {
      const Body& body = model_.bodies[i];
      first_part_.push_back(static_cast<int>(body_of_part_.size()));
      for (const Part& part : shape_of(i).parts) {
        fcl_.add(part.primitive, body.scale / units_.length, static_cast<int>(i), body.dynamic);
        body_of_part_.push_back(static_cast<int>(i));
      }
    }
    load_state(model_.initial);
  }

  StepReport step(double dt, const BodyLoads& loads) override {
    if (!(dt > 0) || !std::isfinite(dt)) throw Error("step", "the time step must be a positive number", "");
    if (loads.force.size() != model_.bodies.size())
      throw Error("step", "the loads are not those of this model", "fill them with evaluate_loads()");
    const double h = dt / units_.time;
    place_prescribed(dt);
    free_velocities(h, loads);
    StepReport report;
    find_contacts(h, report);
    build_problem(h);
    const LcpSolverReport solved =
        solver_->solve(problem_, options_.tolerance, std::min(options_.max_iterations, most_passes), impulse_,
                       velocity_after_, angular_after_);
    report.contacts = static_cast<int>(touches_.size());
    report.iterations = solved.iterations;
    report.residual = solved.residual;
    report.converged = solved.converged;
    report.cycling = solved.swept;
    report.contact_work = work_of_contacts();
    advance(h);
    time_ += dt;
    last_step_ = h;
    return report;
  }

  void read(Snapshot& state) const override {
    state.resize(model_.bodies.size());
    state.time = time_;
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      state.position[i] = position_[i] * units_.length;
      state.orientation[i] = orientation_[i];
      state.velocity[i] = velocity_[i] * units_.velocity();
      state.angular_velocity[i] = angular_[i] / units_.time;
    }
  }

  void read(std::vector<Contact>& contacts) const override {
    contacts.clear();
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      const Touch& touch = touches_[i];
      Contact contact;
      contact.a = touch.a;
      contact.b = touch.b;
      contact.point = touch.point * units_.length;
      contact.normal = touch.normal;
      contact.gap = touch.gap * units_.length;
      contact.force = impulse_[i].force * (units_.force() / last_step_);
      contact.torque = impulse_[i].couple * (units_.force() * units_.length / last_step_);
      contacts.push_back(contact);
    }
  }

  /// The positions and velocities are all there is: every step starts cold.
  void save(Frame& frame) const override { read(frame.state); }

  void restore(const Frame& frame) override {
    if (frame.state.size() != model_.bodies.size())
      throw Error("checkpoint", "it does not fit this model",
                  "resume with the scene and seed that wrote it, or start afresh");
    load_state(frame.state);
    touches_.clear();
    impulse_.clear();
  }

 private:
  const Shape& shape_of(std::size_t body) const {
    return model_.shapes[static_cast<std::size_t>(model_.bodies[body].shape)];
  }

  void load_state(const Snapshot& state) {
    const std::size_t n = model_.bodies.size();
    time_ = state.time;
    position_.resize(n);
    velocity_.resize(n);
    angular_.resize(n);
    rotation_.resize(n);
    orientation_ = state.orientation;
    for (std::size_t i = 0; i < n; ++i) {
      position_[i] = state.position[i] / units_.length;
      velocity_[i] = state.velocity[i] / units_.velocity();
      angular_[i] = state.angular_velocity[i] * units_.time;
    }
  }

  /// Prescribed bodies move with the twist that takes them to where they must be at the end of the step.
  void place_prescribed(double dt) {
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      const Body& body = model_.bodies[i];
      if (body.dynamic) continue;
      const Pose initial{model_.initial.position[i], model_.initial.orientation[i]};
      show(i, pose_at(body.motion, initial, time_));
      const Twist twist = mean_twist(body.motion, initial, time_, dt);
      velocity_[i] = twist.linear / units_.velocity();
      angular_[i] = twist.angular * units_.time;
    }
  }

  void show(std::size_t body, const Pose& pose) {
    position_[body] = pose.position / units_.length;
    orientation_[body] = pose.orientation;
  }

  /// v_free = (m v + h f) / (m + h damping), and likewise about each principal axis. DART is given m + h damping as the
  /// inertia, so that contacts meet the damped body.
  void free_velocities(double h, const BodyLoads& loads) {
    const double inertia_unit = units_.mass * units_.length * units_.length;
    problem_.inverse_mass.assign(model_.bodies.size(), {});
    problem_.velocity.resize(model_.bodies.size());
    problem_.angular_velocity.resize(model_.bodies.size());
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      rotation_[i] = orientation_[i].toRotationMatrix();
      const auto s = static_cast<std::size_t>(slot_[i]);
      problem_.velocity[s] = velocity_[i];
      problem_.angular_velocity[s] = angular_[i];
      const Body& body = model_.bodies[i];
      if (!body.dynamic) continue;
      const double mass = body.mass / units_.mass;
      const Vec3 inertia = body.inertia / inertia_unit;
      const double damped = mass + h * loads.linear_damping[i] / (units_.mass / units_.time);
      const Vec3 damped_inertia = inertia.array() + h * loads.angular_damping[i] / (inertia_unit / units_.time);
      const Vec3 turning = inertia.cwiseProduct(rotation_[i].transpose() * angular_[i]) +
                           rotation_[i].transpose() * Vec3(h * loads.torque[i] / (units_.force() * units_.length));
      problem_.velocity[s] = (mass * velocity_[i] + h * loads.force[i] / units_.force()) / damped;
      problem_.angular_velocity[s] = rotation_[i] * turning.cwiseQuotient(damped_inertia);
      if (!problem_.velocity[s].allFinite() || !problem_.angular_velocity[s].allFinite()) fail(i);
      problem_.inverse_mass[s].mass = 1 / damped;
      const Mat3 world = rotation_[i] * damped_inertia.cwiseInverse().asDiagonal() * rotation_[i].transpose();
      problem_.inverse_mass[s].inertia = {world(0, 0), world(0, 1), world(0, 2), world(1, 1), world(1, 2), world(2, 2)};
    }
  }

  [[noreturn]] void fail(std::size_t body) const {
    throw Error(
        "body " + std::to_string(body), "its velocity is not a finite number at t = " + std::to_string(time_) + " s",
        "this is a failure of the simulation: try a smaller time_step, and look for bodies pressed together by tools",
        Error::Kind::simulation);
  }

  dvi::BodyPlacement placement() {
    const std::size_t n = model_.bodies.size();
    placed_velocity_.resize(n);
    placed_angular_.resize(n);
    turning_speed_.resize(n);
    present_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto s = static_cast<std::size_t>(slot_[i]);
      placed_velocity_[i] = problem_.velocity[s];
      placed_angular_[i] = problem_.angular_velocity[s];
      const double reach = shape_of(i).bounding_radius * model_.bodies[i].scale / units_.length;
      const double turning = placed_angular_[i].norm();
      turning_speed_[i] = turning > 0 && std::isfinite(reach) ? turning * reach : 0.0;
      present_[i] = model_.bodies[i].exists_at(time_) ? 1 : 0;
    }
    return {position_, rotation_, placed_velocity_, placed_angular_, turning_speed_, present_};
  }

  /// FCL's contacts where FCL knows the pair; elsewhere, and for cohesion across a gap, those of Repose's own narrow
  /// phase.
  void find_contacts(double h, StepReport& report) {
    touches_.clear();
    const dvi::BodyPlacement placed = placement();
    for (std::size_t part = 0; part < body_of_part_.size(); ++part) {
      const auto body = static_cast<std::size_t>(body_of_part_[part]);
      const Pose& pose = shape_of(body).parts[part - static_cast<std::size_t>(first_part_[body])].pose;
      fcl_.place(static_cast<int>(part),
                 position_[body] + rotation_[body] * (model_.bodies[body].scale / units_.length * pose.position),
                 rotation_[body] * pose.orientation.toRotationMatrix(), placed.present[body] != 0);
    }
    std::set<std::pair<int, int>> seen;
    for (const FclContact& contact : fcl_.find()) {
      const int a = body_of_part_[static_cast<std::size_t>(contact.a)],
                b = body_of_part_[static_cast<std::size_t>(contact.b)];
      if (gate_open(a, contact.gap) || gate_open(b, contact.gap)) continue;
      seen.insert({contact.a, contact.b});
      touches_.push_back({a, b, contact.point, contact.normal, contact.gap});
    }
    for (const FoundContact& contact : finder_.find(placed, h, options_.search_margin, 1)) {
      report.penetration = std::max(report.penetration, -contact.point.gap * units_.length);
      const int a = contact.id.a(), b = contact.id.b();
      const int part_a = first_part_[static_cast<std::size_t>(a)] + static_cast<int>(contact.id.features >> 48);
      const int part_b =
          first_part_[static_cast<std::size_t>(b)] + static_cast<int>(contact.id.features >> 32 & 0xffff);
      if (fcl_finds(primitive_of(part_a), primitive_of(part_b)) &&
          (!holds(a, b, contact.point.gap) || seen.count({part_a, part_b})))
        continue;
      touches_.push_back({a, b, contact.point.point, contact.point.normal, contact.point.gap});
    }
  }

  const Primitive& primitive_of(int part) const {
    const auto body = static_cast<std::size_t>(body_of_part_[static_cast<std::size_t>(part)]);
    return shape_of(body).parts[static_cast<std::size_t>(part - first_part_[body])].primitive;
  }

  /// A gate does not touch what stood in its way when it appeared.
  bool gate_open(int body, double gap) const {
    const Body& b = model_.bodies[static_cast<std::size_t>(body)];
    return !b.active.empty() && gap < -b.gate_tolerance / units_.length;
  }

  const PairLaw& law_of(int a, int b) const {
    return model_.law(model_.bodies[static_cast<std::size_t>(a)].material,
                      model_.bodies[static_cast<std::size_t>(b)].material);
  }

  double reduced_radius_of(int a, int b) const {
    return reduced_radius(model_.bodies[static_cast<std::size_t>(a)].radius,
                          model_.bodies[static_cast<std::size_t>(b)].radius) /
           units_.length;
  }

  /// Whether cohesion acts across this gap.
  bool holds(int a, int b, double gap) const {
    const PairLaw& law = law_of(a, b);
    return law.cohesion > 0 && gap <= std::max(law.cohesion_range / units_.length, touching * reduced_radius_of(a, b));
  }

  void build_problem(double h) {
    problem_.contacts.resize(touches_.size());
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      const Touch& touch = touches_[i];
      const auto a = static_cast<std::size_t>(touch.a), b = static_cast<std::size_t>(touch.b);
      const PairLaw& law = law_of(touch.a, touch.b);
      const FrictionArms arms = friction_arms(law, model_.bodies[a].radius, model_.bodies[b].radius);
      ConeContact& c = problem_.contacts[i];
      c.a = slot_[a];
      c.b = slot_[b];
      c.normal = touch.normal;
      c.arm_a = touch.point - position_[a];
      c.arm_b = touch.point - position_[b];
      c.arm = reduced_radius_of(touch.a, touch.b);
      c.friction = law.friction;
      c.rolling = arms.rolling / units_.length / c.arm;
      c.spinning = arms.spinning / units_.length / c.arm;
      c.cohesion = holds(touch.a, touch.b, touch.gap) ? h * (law.cohesion / units_.force()) : 0.0;
      // Newton's law: what closes in this step leaves with -e times the speed that it had before the step.
      const double before =
          touch.normal.dot(velocity_[b] + angular_[b].cross(c.arm_b) - velocity_[a] - angular_[a].cross(c.arm_a));
      const double free = dvi::relative_velocity(c, problem_.velocity, problem_.angular_velocity)[0];
      const bool closes = touch.gap + h * free <= 0;
      c.bias = closes && before < 0 ? law.restitution * before : 0.0;
      if (c.bias == 0) c.bias = std::max(touch.gap, 0.0) / h;
    }
  }

  double work_of_contacts() const {
    double work = 0;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      const ConeContact& c = problem_.contacts[i];
      const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
      const auto add = [&](const std::vector<Vec3>& v, const std::vector<Vec3>& w) {
        work += 0.5 * (impulse_[i].force.dot(v[b] + w[b].cross(c.arm_b) - v[a] - w[a].cross(c.arm_a)) +
                       impulse_[i].couple.dot(w[b] - w[a]));
      };
      add(problem_.velocity, problem_.angular_velocity);
      add(velocity_after_, angular_after_);
    }
    return work * units_.energy();
  }

  /// Symplectic Euler; then overlap is taken away at the positions. DART's own way to do either would change the
  /// energy.
  void advance(double h) {
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      if (!model_.bodies[i].dynamic) {
        const Pose initial{model_.initial.position[i], model_.initial.orientation[i]};
        show(i, pose_at(model_.bodies[i].motion, initial, time_ + h * units_.time));
        continue;
      }
      const auto s = static_cast<std::size_t>(slot_[i]);
      velocity_[i] = velocity_after_[s];
      angular_[i] = angular_after_[s];
      if (!velocity_[i].allFinite() || !angular_[i].allFinite()) fail(i);
      position_[i] += h * velocity_[i];
      turn(i, h * angular_[i]);
    }
    gap_.resize(touches_.size());
    for (std::size_t i = 0; i < touches_.size(); ++i)
      gap_[i] = touches_[i].gap + h * dvi::relative_velocity(problem_.contacts[i], velocity_after_, angular_after_)[0];
    dvi::push_apart(problem_, gap_, penetration_slop, 1, displacement_);
    for (std::size_t s = 0; s < static_cast<std::size_t>(problem_.dynamic_bodies); ++s) {
      position_[body_of_slot_[s]] += displacement_[s].shift;
      turn(body_of_slot_[s], displacement_[s].turn);
    }
  }

  /// Turns a body; its angular momentum stays what it was while the axes turn.
  void turn(std::size_t body, const Vec3& by) {
    if (by.squaredNorm() == 0) return;
    const Vec3& inertia = model_.bodies[body].inertia;
    const Mat3 before = orientation_[body].toRotationMatrix();
    orientation_[body] = (rotation_of(by) * orientation_[body]).normalized();
    if (inertia.x() == inertia.y() && inertia.y() == inertia.z()) return;
    const Mat3 after = orientation_[body].toRotationMatrix();
    const Vec3 momentum = before * inertia.cwiseProduct(before.transpose() * angular_[body]);
    angular_[body] = after * (after.transpose() * momentum).cwiseQuotient(inertia);
  }

  Model model_;
  SolverOptions options_;
  dvi::Units units_;
  dvi::ContactFinder finder_;
  std::vector<Vec3> placed_velocity_, placed_angular_;  // by body, for the finder
  std::vector<double> turning_speed_;
  std::vector<char> present_;
  FclContacts fcl_;
  std::unique_ptr<LcpSolver> solver_;
  std::vector<int> first_part_, body_of_part_;
  std::vector<std::int32_t> slot_;  // of each body in the problem: dynamic ones first
  std::vector<std::size_t> body_of_slot_;

  // State, in the world's own units; by body.
  double time_ = 0;  // [s]
  std::vector<Vec3> position_, velocity_, angular_;
  std::vector<Quat> orientation_;

  // Of the last step.
  std::vector<Mat3> rotation_;
  std::vector<Touch> touches_;
  dvi::ConeProblem problem_;  // by slot
  std::vector<ContactImpulse> impulse_;
  std::vector<Vec3> velocity_after_, angular_after_;
  std::vector<double> gap_;
  std::vector<dvi::Displacement> displacement_;
  double last_step_ = 1;
};

}  // namespace

std::vector<std::string> unsupported(const Model& model) {
  std::vector<std::string> names = contact_effect_names(model);
  if (model.periodic.any()) names.push_back("periodic");
  if (std::any_of(model.bodies.begin(), model.bodies.end(), [](const Body& body) { return body.yield.has_value(); }))
    names.push_back("yield");
  return names;
}

std::unique_ptr<World> make_world(const Model& model, const SolverOptions& options) {
  validate(model);
  if (!(options.tolerance > 0) || !(options.max_iterations > 0) || options.threads < 1 || !(options.search_margin >= 1))
    throw Error("solver", "tolerance and max_iterations must be positive, threads and search_margin at least 1", "");
  if (options.law == ContactLaw::relaxed)
    throw Error("solver", "dart has no relaxed contact law", "use the exact one, or the backend dvi");
  if (options.integration != Integration::symplectic_euler)
    throw Error("solver.integration", "dart is stepped by symplectic Euler alone", "leave it at its default, or use dvi");
  return std::make_unique<WorldDart>(model, options);
}

}  // namespace repose::dart
