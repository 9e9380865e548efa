#include "backends/bullet/world_bullet.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "backends/bullet/bodies.hpp"
#include "backends/bullet/contact_search.hpp"
#include "backends/bullet/sequential_impulse.hpp"
#include "backends/dvi/impact.hpp"
#include "core/error.hpp"

namespace repose::bullet {

namespace {

constexpr double touching = 1e-6;  // of R*: bodies that touch stand apart by rounding

using dvi::ConeContact;
using dvi::Impulse;

/// A contact of the last step with its impulse, in world axes so that a turned frame changes nothing.
struct KeptContact {
  std::int32_t a = 0, b = 0;
  std::uint64_t features = 0;
  Vec3 force = Vec3::Zero();   ///< impulse on b
  Vec3 couple = Vec3::Zero();  ///< on b
  dvi::ContactPoint point;
};

template <class T>
auto name_of(const T& contact) {
  return std::tuple(contact.a, contact.b, contact.features);
}

class WorldBullet final : public World {
 public:
  WorldBullet(const Model& model, const SolverOptions& options)
      : model_(model), options_(options), bodies_(model_, dvi::units_of(model_)), search_(bodies_) {
    for (const bool dynamic : {true, false})
      for (std::size_t i = 0; i < model_.bodies.size(); ++i)
        if (model_.bodies[i].dynamic == dynamic) body_of_slot_.push_back(i);
    slot_.resize(body_of_slot_.size());
    for (std::size_t s = 0; s < body_of_slot_.size(); ++s) slot_[body_of_slot_[s]] = static_cast<std::int32_t>(s);
    problem_.dynamic_bodies = static_cast<std::int32_t>(
        std::count_if(model_.bodies.begin(), model_.bodies.end(), [](const Body& body) { return body.dynamic; }));
  }

  StepReport step(double dt, const BodyLoads& loads) override {
    if (!(dt > 0) || !std::isfinite(dt)) throw Error("step", "the time step must be a positive number", "");
    if (loads.force.size() != model_.bodies.size())
      throw Error("step", "the loads are not those of this model", "fill them with evaluate_loads()");
    const double h = dt / bodies_.units().time;
    bodies_.place_prescribed(dt);
    bodies_.apply(loads, h);
    const std::vector<FoundContact>& found = search_.find(h, options_.search_margin);
    build_bodies();
    build_contacts(found, h);
    warm_start(found, h);
    const dvi::SolveReport solved = solve(h);
    const StepReport report = report_of(found, solved);
    keep(found);
    move(h);
    bodies_.time += dt;
    last_step_ = h;
    return report;
  }

  void read(Snapshot& state) const override { bodies_.read(state); }

  void read(std::vector<Contact>& contacts) const override {
    const dvi::Units& units = bodies_.units();
    contacts.clear();
    for (const KeptContact& kept : kept_) {
      Contact contact;
      contact.a = kept.a;
      contact.b = kept.b;
      contact.point = kept.point.point * units.length;
      contact.normal = kept.point.normal;
      contact.gap = kept.point.gap * units.length;
      contact.force = kept.force * (units.force() / last_step_);
      contact.torque = kept.couple * (units.force() * units.length / last_step_);
      contacts.push_back(contact);
    }
  }

  void save(Frame& frame) const override {
    const dvi::Units& units = bodies_.units();
    read(frame.state);
    std::vector<double>& numbers = frame.numbers["contact_impulses"];
    std::vector<std::int64_t>& ids = frame.integers["contact_ids"];
    numbers.clear();
    ids.clear();
    for (const KeptContact& kept : kept_) {
      for (int k = 0; k < 3; ++k) numbers.push_back(kept.force[k] * units.impulse());
      for (int k = 0; k < 3; ++k) numbers.push_back(kept.couple[k] * units.impulse() * units.length);
      ids.insert(ids.end(), {kept.a, kept.b, static_cast<std::int64_t>(kept.features)});
    }
    frame.numbers["last_step"] = {last_step_ * units.time};
  }

  void restore(const Frame& frame) override {
    const dvi::Units& units = bodies_.units();
    const auto numbers = frame.numbers.find("contact_impulses");
    const auto ids = frame.integers.find("contact_ids");
    const auto last = frame.numbers.find("last_step");
    const bool fits = frame.state.size() == model_.bodies.size() && numbers != frame.numbers.end() &&
                      ids != frame.integers.end() && last != frame.numbers.end() && last->second.size() == 1 &&
                      numbers->second.size() == 2 * ids->second.size() && ids->second.size() % 3 == 0;
    if (!fits)
      throw Error("checkpoint", "it does not fit this model", "resume with the scene and seed that wrote it, or start afresh");
    bodies_.load(frame.state);
    kept_.clear();
    for (std::size_t i = 0; i < ids->second.size() / 3; ++i) {
      KeptContact kept;
      kept.a = static_cast<std::int32_t>(ids->second[3 * i]);
      kept.b = static_cast<std::int32_t>(ids->second[3 * i + 1]);
      kept.features = static_cast<std::uint64_t>(ids->second[3 * i + 2]);
      for (std::size_t k = 0; k < 3; ++k) {
        kept.force[static_cast<Eigen::Index>(k)] = numbers->second[6 * i + k] / units.impulse();
        kept.couple[static_cast<Eigen::Index>(k)] = numbers->second[6 * i + 3 + k] / (units.impulse() * units.length);
      }
      kept_.push_back(kept);
    }
    last_step_ = last->second[0] / units.time;
  }

 private:
  void build_bodies() {
    const std::size_t n = body_of_slot_.size();
    problem_.inverse_mass.assign(n, {});
    problem_.velocity.resize(n);
    problem_.angular_velocity.resize(n);
    mass_.resize(n);
    for (std::size_t s = 0; s < n; ++s) {
      const std::size_t i = body_of_slot_[s];
      problem_.velocity[s] = bodies_.free_velocity[i];
      problem_.angular_velocity[s] = bodies_.free_spin[i];
      mass_[s] = {bodies_.mass_with_drag[i], bodies_.inertia_with_drag[i], bodies_.rotation[i]};
      if (!model_.bodies[i].dynamic) continue;
      const Mat3& r = bodies_.rotation[i];
      const Mat3 world = r * bodies_.inertia_with_drag[i].cwiseInverse().asDiagonal() * r.transpose();
      problem_.inverse_mass[s].mass = 1 / bodies_.mass_with_drag[i];
      problem_.inverse_mass[s].inertia = {world(0, 0), world(0, 1), world(0, 2), world(1, 1), world(1, 2), world(2, 2)};
    }
  }

  /// The law of each pair replaces Bullet's rules of combination.
  void build_contacts(const std::vector<FoundContact>& found, double h) {
    const dvi::Units& units = bodies_.units();
    problem_.contacts.resize(found.size());
    impact_.resize(found.size());
    gap_.resize(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      const auto a = static_cast<std::size_t>(found[i].a), b = static_cast<std::size_t>(found[i].b);
      const Body &body_a = model_.bodies[a], &body_b = model_.bodies[b];
      const PairLaw& law = model_.law(body_a.material, body_b.material);
      const FrictionArms arms = friction_arms(law, body_a.radius, body_b.radius);
      const dvi::ContactPoint& point = found[i].point;
      ConeContact& c = problem_.contacts[i];
      c.a = slot_[a];
      c.b = slot_[b];
      c.normal = point.normal;
      c.arm_a = point.point - bodies_.position[a];
      c.arm_b = point.point - bodies_.position[b];
      c.friction = law.friction;
      c.arm = reduced_radius(body_a.radius, body_b.radius) / units.length;
      c.rolling = arms.rolling / units.length / c.arm;
      c.spinning = arms.spinning / units.length / c.arm;
      const bool holds = law.cohesion > 0 && point.gap <= std::max(law.cohesion_range / units.length, touching * c.arm);
      c.cohesion = holds ? h * (law.cohesion / units.force()) : 0.0;
      gap_[i] = point.gap;
      const Vec3 before = bodies_.velocity[b] + bodies_.spin[b].cross(c.arm_b) - bodies_.velocity[a] -
                          bodies_.spin[a].cross(c.arm_a);
      impact_[i] = {point.gap, law.restitution, c.normal.dot(before)};
    }
  }

  /// First impulses: those of the same contacts one step ago. Both lists are sorted by name.
  void warm_start(const std::vector<FoundContact>& found, double h) {
    impulse_.assign(found.size(), Impulse{});
    if (!options_.warm_start) return;
    const double ratio = last_step_ > 0 ? h / last_step_ : 1;
    auto kept = kept_.begin();
    for (std::size_t i = 0; i < found.size(); ++i) {
      while (kept != kept_.end() && name_of(*kept) < name_of(found[i])) ++kept;
      if (kept == kept_.end()) break;
      if (name_of(*kept) != name_of(found[i])) continue;
      const ConeContact& c = problem_.contacts[i];
      Vec3 t1, t2;
      dvi::tangent_frame(c.normal, t1, t2);
      const Vec3 force = ratio * kept->force, couple = ratio / c.arm * kept->couple;
      impulse_[i] = {std::max(c.normal.dot(force), -c.cohesion), t1.dot(force), t2.dot(force), t1.dot(couple),
                     t2.dot(couple), c.normal.dot(couple)};
    }
  }

  dvi::SolveReport solve(double h) {
    const dvi::ConeSolver solver = [&](const dvi::ConeProblem& problem, std::span<Impulse> impulse,
                                       std::vector<Vec3>& velocity, std::vector<Vec3>& angular) {
      return solver_.solve(problem, mass_, gap_, h, options_, impulse, velocity, angular);
    };
    return dvi::solve_with_impacts(problem_, impact_, h, options_.tolerance, solver, impulse_, velocity_after_,
                                   spin_after_, 1);
  }

  StepReport report_of(const std::vector<FoundContact>& found, const dvi::SolveReport& solved) const {
    StepReport report;
    report.contacts = static_cast<int>(found.size());
    report.iterations = solved.iterations;
    report.residual = solved.residual;
    report.converged = solved.converged;
    double work = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      report.penetration = std::max(report.penetration, -found[i].point.gap * bodies_.units().length);
      const ConeContact& c = problem_.contacts[i];
      const Impulse free = dvi::relative_velocity(c, problem_.velocity, problem_.angular_velocity);
      const Impulse after = dvi::relative_velocity(c, velocity_after_, spin_after_);
      for (std::size_t k = 0; k < 6; ++k) work += 0.5 * impulse_[i][k] * (free[k] + after[k]);
    }
    report.contact_work = work * bodies_.units().energy();
    return report;
  }

  void keep(const std::vector<FoundContact>& found) {
    kept_.resize(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      const ConeContact& c = problem_.contacts[i];
      const Impulse& g = impulse_[i];
      Vec3 t1, t2;
      dvi::tangent_frame(c.normal, t1, t2);
      kept_[i] = {found[i].a, found[i].b, found[i].features, g[0] * c.normal + g[1] * t1 + g[2] * t2,
                  c.arm * (g[3] * t1 + g[4] * t2 + g[5] * c.normal), found[i].point};
    }
  }

  void move(double h) {
    const std::vector<dvi::Displacement>& displacement = solver_.displacement();
    for (std::size_t s = 0; s < static_cast<std::size_t>(problem_.dynamic_bodies); ++s) {
      bodies_.velocity[body_of_slot_[s]] = velocity_after_[s];
      bodies_.spin[body_of_slot_[s]] = spin_after_[s];
    }
    bodies_.advance(h);
    for (std::size_t s = 0; s < static_cast<std::size_t>(problem_.dynamic_bodies); ++s) {
      bodies_.position[body_of_slot_[s]] += displacement[s].shift;
      bodies_.turn(body_of_slot_[s], displacement[s].turn);
    }
  }

  Model model_;
  SolverOptions options_;
  Bodies bodies_;
  ContactSearch search_;
  SequentialImpulse solver_;
  std::vector<std::size_t> body_of_slot_;  // dynamic bodies first, as the problem wants them
  std::vector<std::int32_t> slot_;
  std::vector<KeptContact> kept_;
  double last_step_ = 0;

  // Work space of one step.
  dvi::ConeProblem problem_;
  std::vector<MassAndAxes> mass_;
  std::vector<dvi::ImpactData> impact_;
  std::vector<double> gap_;
  std::vector<Impulse> impulse_;
  std::vector<Vec3> velocity_after_, spin_after_;
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
  if (options.law != ContactLaw::exact)
    throw Error("solver.law", "bullet solves the exact law alone", "leave the law at its default, or use dvi");
  if (options.integration != Integration::symplectic_euler)
    throw Error("solver.integration", "bullet is stepped by symplectic Euler alone", "leave it at its default, or use dvi");
  return std::make_unique<WorldBullet>(model, options);
}

}  // namespace repose::bullet
