#include "scenarios/history.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "analysis/discharge.hpp"
#include "analysis/rest.hpp"
#include "backends/backends.hpp"
#include "core/body_frame.hpp"
#include "core/error.hpp"
#include "core/nearest.hpp"
#include "core/run.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/simulate.hpp"

namespace repose {
namespace {

/// Fills a History while a world runs.
class Keeper {
 public:
  Keeper(const Scene& scene, const Model& model, const SimulationRequest& request) : model_(model), request_(request) {
    history_.gravity = tilted_gravity(model.gravity, model.effects);
    for (const SceneBody& body : scene.bodies) {
      const int index = model.find_body(body.name);
      const Body& made = model.bodies[static_cast<std::size_t>(index)];
      if (!made.dynamic) continue;
      bodies_.push_back({static_cast<std::size_t>(index), &history_.bodies[body.name]});
      history_.radius[body.name] = made.radius;
      history_.mass[body.name] = made.mass;
    }
    for (const std::string& name : request.series) series_.push_back({name, &history_.series[name]});
    outlet_ = funnel_outlet(scene);
    base_ = tool_of<Base>(scene, "base");
    roller_ = tool_of<Roller>(scene, "roller");
    drum_ = tool_of<Drum>(scene, "drum");
    needs_contacts_ =
        request.contacts || std::any_of(request.series.begin(), request.series.end(), [](const std::string& name) {
          return name == "mass_on_base" || name.starts_with("roller_");
        });
  }

  void keep(const Snapshot& state, const World& world) {
    history_.time.push_back(state.time);
    if (needs_contacts_) world.read(contacts_);
    for (const auto& [index, track] : bodies_) keep(state, index, *track);
    for (const auto& [name, values] : series_) values->push_back(measure(name, state));
    if (request_.contacts) before_ = state;
  }

  History take() { return std::move(history_); }

 private:
  /// Index into Model::names of the first tool of the kind, or with `word` in its name; -1 if there is none.
  template <class Kind>
  int tool_of(const Scene& scene, const std::string& word) const {
    for (const Tool& tool : scene.tools)
      if (tool.name.find(word) != std::string::npos || std::holds_alternative<Kind>(tool.kind))
        for (std::size_t i = 0; i < model_.names.size(); ++i)
          if (model_.names[i] == tool.name) return static_cast<int>(i);
    return -1;
  }

  void keep(const Snapshot& state, std::size_t i, BodyTrack& track) {
    const Body& body = model_.bodies[i];
    const Pose own = own_pose(model_.shapes[static_cast<std::size_t>(body.shape)], body.scale,
                              {state.position[i], state.orientation[i]});
    track.position.push_back(own.position);
    track.orientation.push_back(own.orientation);
    track.velocity.push_back(state.velocity[i] + state.angular_velocity[i].cross(own.position - state.position[i]));
    track.spin.push_back(state.angular_velocity[i]);
    if (!request_.contacts) return;
    double total = 0, largest = 0, slip = 0, approach = 0;
    for (const Contact& contact : contacts_) {
      const auto a = static_cast<std::size_t>(contact.a), b = static_cast<std::size_t>(contact.b);
      if (a != i && b != i) continue;
      const double normal = std::max(contact.force.dot(contact.normal), 0.0);
      total += normal;
      if (normal <= largest) continue;
      largest = normal;
      const Vec3 relative = velocity_at(state, b, contact.point) - velocity_at(state, a, contact.point);
      slip = (relative - relative.dot(contact.normal) * contact.normal).norm();
      approach =
          before_
              ? -(velocity_at(*before_, b, contact.point) - velocity_at(*before_, a, contact.point)).dot(contact.normal)
              : 0;
    }
    track.normal_force.push_back(total);
    track.slip_speed.push_back(slip);
    track.approach.push_back(std::max(approach, 0.0));
  }

  static Vec3 velocity_at(const Snapshot& state, std::size_t i, const Vec3& point) {
    return state.velocity[i] + state.angular_velocity[i].cross(point - state.position[i]);
  }

  Vec3 force_on(int name) const {
    Vec3 force = Vec3::Zero();
    for (const Contact& contact : contacts_) {
      if (model_.bodies[static_cast<std::size_t>(contact.b)].name == name) force += contact.force;
      if (model_.bodies[static_cast<std::size_t>(contact.a)].name == name) force -= contact.force;
    }
    return force;
  }

  Vec3 torque_on(int name, const Vec3& about) const {
    Vec3 torque = Vec3::Zero();
    for (const Contact& contact : contacts_) {
      const Vec3 moment = (contact.point - about).cross(contact.force) + contact.torque;
      if (model_.bodies[static_cast<std::size_t>(contact.b)].name == name) torque += moment;
      if (model_.bodies[static_cast<std::size_t>(contact.a)].name == name) torque -= moment;
    }
    return torque;
  }

  /// Angle of the surface in a drum that turns [deg], positive where the drum lifts the grains: the direction from its axis to the centre of
  /// all grains, which is the normal of a flat surface however full the drum is.
  double surface_angle(const Snapshot& state) const {
    Vec3 axis = Vec3::Zero(), middle = Vec3::Zero(), centre = Vec3::Zero();
    double mass = 0;
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      const Body& body = model_.bodies[i];
      if (body.name == drum_) {
        axis = body.motion.angular_velocity.normalized();
        middle = state.position[i];
      }
      if (body.role != BodyRole::grain) continue;
      centre += body.mass * state.position[i];
      mass += body.mass;
    }
    if (axis.isZero(0) || !(mass > 0))
      throw Error("record.observables", "`surface_angle` needs grains in a drum that turns", "give the drum `motion: {angular_velocity: ...}`");
    const Vec3 down = model_.gravity.normalized(), from_axis = centre / mass - middle;
    return std::atan2(from_axis.dot(axis.cross(down)), from_axis.dot(down)) * 180 / std::numbers::pi;
  }

  double measure(const std::string& name, const Snapshot& state) const {
    if (name == "discharged_mass") {
      if (!outlet_) throw Error("record.observables", "`discharged_mass` needs a funnel", "add a funnel to the tools");
      return mass_below(model_, state, outlet_->height);
    }
    if (name == "mass_on_base") {
      if (base_ < 0) throw Error("record.observables", "`mass_on_base` needs a base", "add a base to the tools");
      return -force_on(base_).z() / model_.gravity.norm();
    }
    if (name == "surface_angle") {
      if (drum_ < 0) throw Error("record.observables", "`surface_angle` needs a drum", "add a drum to the tools");
      return surface_angle(state);
    }
    if (name.starts_with("roller_")) {
      if (roller_ < 0) throw Error("record.observables", "`" + name + "` needs a roller", "add a roller to the tools");
      if (name == "roller_force_x") return force_on(roller_).x();
      if (name == "roller_force_z") return force_on(roller_).z();
      for (std::size_t i = 0; i < model_.bodies.size(); ++i)
        if (model_.bodies[i].name == roller_) return torque_on(roller_, state.position[i]).y();
    }
    throw Error("record.observables", "no series `" + name + "` can be recorded from a simulation",
                "those that can: discharged_mass, mass_on_base, roller_force_x, roller_force_z, roller_torque, surface_angle");
  }

  const Model& model_;
  const SimulationRequest& request_;
  History history_;
  std::vector<std::pair<std::size_t, BodyTrack*>> bodies_;
  std::vector<std::pair<std::string, std::vector<double>*>> series_;
  std::vector<Contact> contacts_;
  std::optional<Snapshot> before_;
  std::optional<Outlet> outlet_;
  int base_ = -1, roller_ = -1, drum_ = -1;
  bool needs_contacts_ = false;
};

void add_loads(const Model& model, const std::vector<WindowLoad>& windows, const Snapshot& state, BodyLoads& loads) {
  for (const WindowLoad& window : windows) {
    if (state.time < window.from || state.time >= window.to) continue;
    const auto body = static_cast<std::size_t>(model.find_body(window.body));
    loads.force[body] += window.force;
    loads.torque[body] += window.torque;
  }
}

}  // namespace

bool has_turning_drum(const Scene& scene) {
  return std::any_of(scene.tools.begin(), scene.tools.end(), [](const Tool& tool) {
    return std::holds_alternative<Drum>(tool.kind) && !tool.motion.angular_velocity.isZero(0);
  });
}

HistoryRun run_history(const Backend& backend, const SimulationRequest& request, bool allow_unsupported,
                       const std::function<void(const Progress&)>& progress) {
  HistoryRun result;
  const Scene& scene = *request.scene;
  result.model = realise(scene, request.seed);
  if (const std::vector<std::string> lacking = backend.unsupported(result.model);
      !lacking.empty() && !allow_unsupported)
    throw Error("--backend " + backend.name, "this backend cannot do: " + listing(lacking),
                "choose another backend, or give --allow-unsupported to run without that");
  const std::unique_ptr<World> world = backend.make(result.model, scene.solver);
  Keeper keeper(scene, result.model, request);
  RunHooks hooks;
  hooks.interrupted = interrupted;
  hooks.progress = progress;
  hooks.stepped = [&](const Snapshot& state, const World& stepped) { keeper.keep(state, stepped); };
  if (!request.loads.empty())
    hooks.loads = [&](const Snapshot& state, BodyLoads& loads) {
      add_loads(result.model, request.loads, state, loads);
    };
  const double duration = request.until > 0 ? request.until : scene.duration;
  const std::optional<HeapSite> site = request.until_rest ? heap_site(scene) : std::nullopt;
  if (site)
    hooks.finished = [&, outlet = funnel_outlet(scene)](const Snapshot& state, const StepReport&) {
      return assess_rest(result.model, state, *site, outlet).at_rest;
    };
  const bool second_order = scene.solver.integration == Integration::second_order;
  const RunReport report = run(*world, result.model, {scene.solver.time_step, duration, site ? scene.frame_interval : duration, 1e9, second_order}, nullptr, hooks);
  if (report.end == RunReport::End::interrupted) throw Error("", "interrupted", "", Error::Kind::simulation);
  result.history = keeper.take();
  result.history.smooth = second_order;
  result.history.converged = report.converged_fraction >= least_converged;
  result.final_state = report.final_state;
  return result;
}

Simulate simulate_with(const Backend& backend, bool allow_unsupported) {
  return [&backend, allow_unsupported](const SimulationRequest& request) {
    if (request.backend.empty()) return run_history(backend, request, allow_unsupported).history;
    return run_history(find_backend(request.backend), request, false).history;
  };
}

std::vector<std::string> backends_beside(const Backend& own, std::size_t grains) {
  std::vector<std::string> names;
  for (const Backend& backend : backends())
    if (backend.name != own.name && grains <= backend.most_grains) names.emplace_back(backend.name);
  return names;
}

}  // namespace repose
