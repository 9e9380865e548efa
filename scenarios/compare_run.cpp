#include "scenarios/compare_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analysis/heap_measurement.hpp"
#include "analysis/ledger.hpp"
#include "core/run.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/thread_clock.hpp"

namespace repose {
namespace {

using nlohmann::json;

constexpr std::size_t most_film_frames = 40;
constexpr std::size_t most_bodies = 20;
constexpr double last_part = 0.1;        // of the run's time: loads and coordination are means over it
constexpr double bearing_weights = 0.01; // a contact carries force from this share of a mean grain's weight

// Seven digits: what a film needs, at half the size of a file.
double shortened(double x) {
  if (x == 0 || !std::isfinite(x)) return 0;
  const double unit = std::pow(10, 6 - std::floor(std::log10(std::abs(x))));
  return std::isfinite(unit) ? std::round(x * unit) / unit : x;
}

const std::string& name_of(const Model& model, std::size_t body) { return model.names[static_cast<std::size_t>(model.bodies[body].name)]; }

/// Gathers what a run tells frame by frame.
class Gatherer {
 public:
  Gatherer(const Scene& scene, const Model& model, const MeteredWorld& world, const CompareFrames& frames, const std::optional<FieldGrid>& grid)
      : model_(model), world_(world), frames_(frames), outlet_(funnel_outlet(scene)), grid_(grid) {
    for (std::size_t i = 0; i < model.bodies.size() && bodies_.size() < most_bodies; ++i)
      if (model.bodies[i].role == BodyRole::body && model.bodies[i].dynamic) bodies_.push_back(i);
    double count = 0;
    for (const Body& body : model.bodies) {
      if (body.role != BodyRole::grain) continue;
      grain_weight_ += body.mass * model.gravity.norm();
      ++count;
    }
    if (count > 0) grain_weight_ /= count;
    add(model.initial, MeteredWorld::ToolImpulses{});
  }

  void add(const Snapshot& state, MeteredWorld::ToolImpulses tools) {
    time_.push_back(state.time);
    kinetic_.push_back(world_.ledger().kinetic);
    if (outlet_) discharge_.add(model_, state, *outlet_);
    if (grid_ && seen_ % frames_.stride == 0) keep_cells(state);
    for (std::size_t i : bodies_)
      for (int k = 0; k < 3; ++k) tracks_[i][static_cast<std::size_t>(k)].push_back(state.position[i][k]);
    coordination_.push_back(coordination());
    tools_.push_back(std::move(tools));
    ++seen_;
  }

  /// Holds the last state through the frames that an early end left out.
  void complete(const Snapshot& last) {
    if (!grid_) return;
    const std::vector<double> cells = motion_field(*grid_, model_, last);
    while (film_.size() < frames_.count * cells.size())
      for (double x : cells) film_.push_back(shortened(x));
  }

  /// Means over the last part of the run, by name of what bears the load [N].
  std::map<std::string, Vec3> loads() const {
    std::map<std::string, Vec3> sum;
    double time = 0;
    for (std::size_t f = first_of_last_part(); f < tools_.size(); ++f) {
      time += tools_[f].time;
      for (std::size_t i = 0; i < tools_[f].impulse.size(); ++i)
        if (!model_.bodies[i].dynamic && model_.bodies[i].name >= 0)
          sum.try_emplace(name_of(model_, i), Vec3::Zero()).first->second += tools_[f].impulse[i];
    }
    for (auto& [name, impulse] : sum) impulse /= time > 0 ? time : 1;
    return sum;
  }
  double mean_coordination() const {
    double sum = 0, n = 0;
    for (std::size_t f = first_of_last_part(); f < coordination_.size(); ++f) {
      sum += coordination_[f];
      ++n;
    }
    return n > 0 ? sum / n : 0;
  }
  const DischargeCurve& discharge() const { return discharge_; }
  const std::vector<std::size_t>& bodies() const { return bodies_; }

  json curves() const {
    json c = {{"time", time_}, {"kinetic_energy", kinetic_}};
    if (outlet_) c["discharged_mass"] = discharge_.mass;
    return c;
  }
  const std::vector<double>& film() const { return film_; }
  json tracks() const {
    json all = json::object();
    for (const auto& [i, track] : tracks_) all[name_of(model_, i)] = {{"x", track[0]}, {"y", track[1]}, {"z", track[2]}};
    return all;
  }
  /// Farthest that a body has been from its start [m].
  double reach(std::size_t body) const {
    double most = 0;
    const auto& track = tracks_.at(body);
    for (std::size_t f = 0; f < track[0].size(); ++f)
      most = std::max(most, Vec3(track[0][f] - track[0][0], track[1][f] - track[1][0], track[2][f] - track[2][0]).norm());
    return most;
  }

 private:
  void keep_cells(const Snapshot& state) {
    for (double x : motion_field(*grid_, model_, state)) film_.push_back(shortened(x));
  }

  std::size_t first_of_last_part() const {
    const double from = time_.back() - last_part * (time_.back() - time_.front());
    for (std::size_t f = 1; f < time_.size(); ++f)
      if (time_[f] >= from && f + 1 < time_.size()) return f + 1;
    return time_.size() - 1;
  }

  // 2 * pairs of grains that press on each other / grains.
  double coordination() const {
    std::set<std::pair<int, int>> pairs;
    for (const Contact& c : world_.contacts())
      if (model_.bodies[static_cast<std::size_t>(c.a)].role == BodyRole::grain &&
          model_.bodies[static_cast<std::size_t>(c.b)].role == BodyRole::grain && c.force.norm() > bearing_weights * grain_weight_)
        pairs.emplace(c.a, c.b);
    const double grains = static_cast<double>(model_.grain_count());
    return grains > 0 ? 2 * static_cast<double>(pairs.size()) / grains : 0;
  }

  const Model& model_;
  const MeteredWorld& world_;
  const CompareFrames& frames_;
  std::optional<Outlet> outlet_;
  std::optional<FieldGrid> grid_;
  std::vector<std::size_t> bodies_;
  double grain_weight_ = 0;
  std::size_t seen_ = 0;
  std::vector<double> time_, kinetic_, film_, coordination_;
  DischargeCurve discharge_;
  std::map<std::size_t, std::array<std::vector<double>, 3>> tracks_;
  std::vector<MeteredWorld::ToolImpulses> tools_;
};

class Observables {
 public:
  void add(const std::string& name, std::optional<double> value, const char* unit, const char* kind, double scale) {
    all_[name] = {{"value", value ? json(*value) : json(nullptr)}, {"unit", unit}, {"kind", kind}, {"scale", scale}};
  }
  void physics(const std::string& name, std::optional<double> value, const char* unit, std::optional<double> scale = {}) {
    add(name, value, unit, "physics", scale.value_or(value ? std::abs(*value) : 0));
  }
  void quality(const std::string& name, double value, const char* unit) { add(name, value, unit, "quality", std::abs(value)); }
  const json& all() const { return all_; }

 private:
  json all_ = json::object();
};

void heap_observables(Observables& o, const HeapMeasurement& heap, double total_mass) {
  const auto& angle = heap.repose.angle;
  o.physics("angle_of_repose", angle ? std::optional(angle->value) : std::nullopt, "deg");
  o.physics("heap_apex", angle ? std::optional(angle->apex) : std::nullopt, "m");
  o.physics("heap_mass_share", heap.repose.grains.heap_mass / total_mass, "1");
  o.physics("solid_fraction", heap.solid ? std::optional(heap.solid->value) : std::nullopt, "1");
  if (!heap.discharge.time.empty()) {
    o.physics("discharged_share", heap.discharge.mass.back() / total_mass, "1");
    o.physics("discharge_rate", heap.rate ? std::optional(heap.rate->rate) : std::nullopt, "kg/s");
  }
  o.quality("at_rest", heap.rest.at_rest ? 1 : 0, "1");
}

void load_observables(Observables& o, const Gatherer& gathered, const Model& model, double weight) {
  const double g = model.gravity.norm();
  const Vec3 up = g > 0 ? Vec3(-model.gravity / g) : Vec3::UnitZ();
  const double scale = weight > 0 ? weight : 1;
  for (const auto& [name, force] : gathered.loads()) {
    const double down = -force.dot(up);
    o.physics("load." + name + ".vertical", down, "N", scale);
    o.physics("load." + name + ".horizontal", (force + down * up).norm(), "N", scale);
  }
}

void body_observables(Observables& o, const Gatherer& gathered, const Model& model, const Snapshot& end) {
  for (std::size_t i : gathered.bodies()) {
    const std::string& name = name_of(model, i);
    const double size = std::isfinite(model.bodies[i].radius) ? model.bodies[i].radius : 0, scale = std::max(gathered.reach(i), size);
    for (int k = 0; k < 3; ++k)
      o.physics(name + "." + "xyz"[k], end.position[i][k], "m", scale);
    o.physics(name + ".speed", end.velocity[i].norm(), "m/s", end.time > 0 ? scale / end.time : scale);
    o.physics(name + ".spin", end.angular_velocity[i].norm(), "rad/s", end.time > 0 ? std::max(1.0, scale / size) / end.time : 1.0);
  }
}

}  // namespace

CompareFrames compare_frames(const Scene& scene) {
  CompareFrames frames;
  const double h = scene.solver.time_step;
  frames.interval = h * std::max(1.0, std::round(std::min(scene.frame_interval, scene.duration) / h));
  const std::size_t total = static_cast<std::size_t>(std::floor(scene.duration / frames.interval * (1 + 1e-9)));
  frames.stride = std::max<std::size_t>(1, (total + most_film_frames - 1) / most_film_frames);
  frames.count = total / frames.stride + 1;
  return frames;
}

std::optional<json> compare_run(const Backend& backend, const Scene& scene, std::uint64_t seed, const CompareFrames& frames,
                                const std::optional<FieldGrid>& grid) {
  const Model model = realise(scene, seed);
  MeteredWorld world(model, backend.make(model, scene.solver));
  const std::optional<HeapSite> site = heap_site(scene);
  const std::optional<Outlet> outlet = funnel_outlet(scene);
  Gatherer gathered(scene, model, world, frames, grid);
  double told = 0;
  const auto gather = [&](const Snapshot& state) {
    gathered.add(state, world.take_impulses());
    told = state.time;
  };
  RunHooks hooks;
  hooks.interrupted = interrupted;
  hooks.finished = [&](const Snapshot& state, const StepReport&) {
    gather(state);
    return site && model.grain_count() > 0 && assess_rest(model, state, *site, outlet).at_rest;
  };
  const double start = thread_cpu_s();
  const RunReport report = run(world, model, {scene.solver.time_step, scene.duration, frames.interval, 1e9}, nullptr, hooks);
  const double cpu_s = thread_cpu_s() - start;
  if (report.end == RunReport::End::interrupted) return std::nullopt;
  if (report.final_state.time > told) gather(report.final_state);
  gathered.complete(report.final_state);

  double mass = 0;
  double height = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    mass += model.bodies[i].mass;
    height += model.bodies[i].mass * report.final_state.position[i].z();
  }
  const Ledger& ledger = world.ledger();
  const double diameter = mean_grain_diameter(model), n = static_cast<double>(model.grain_count());
  Observables o;
  json curves = gathered.curves();
  if (site && n > 0) {
    const HeapMeasurement heap = measure_heap(scene, model, report.final_state, nullptr, gathered.discharge());
    heap_observables(o, heap, mass);
    curves["radius"] = heap.repose.profile.radius;
    curves["height"] = heap.repose.profile.height;
  }
  if (n > 0) {
    o.physics("coordination_number", gathered.mean_coordination(), "1");
    o.physics("height_of_mass", height / mass, "m");
  }
  body_observables(o, gathered, model, report.final_state);
  load_observables(o, gathered, model, mass * model.gravity.norm());
  o.physics("energy_dissipated", ledger.dissipated, "J", ledger.turnover);
  o.physics("kinetic_energy", ledger.kinetic, "J", ledger.turnover);
  o.quality("energy_gain", ledger.energy_gain, "1");
  o.quality("momentum_error", ledger.momentum_error, "1");
  o.quality(diameter > 0 ? "penetration_diameters" : "penetration", diameter > 0 ? report.max_penetration / diameter : report.max_penetration,
            diameter > 0 ? "1" : "m");
  o.quality("converged_fraction", report.converged_fraction, "1");
  o.add("wall_time", report.wall_s, "s", "cost", report.wall_s);
  if (scene.solver.threads == 1) {
    o.add("processor_time", cpu_s, "s", "cost", cpu_s);
    o.add("processor_time_per_step", cpu_s / static_cast<double>(std::max<std::int64_t>(report.steps, 1)), "s", "cost", cpu_s);
  }

  return json{{"observables", o.all()},
              {"run", {{"steps", report.steps}, {"wall_s", report.wall_s}, {"contacts_mean", report.contacts_mean},
                       {"iterations_mean", report.iterations_mean}, {"residual_max", report.residual_max},
                       {"converged_fraction", report.converged_fraction}, {"cycling_fraction", report.cycling_fraction},
                       {"max_penetration", report.max_penetration}, {"time", report.final_state.time}}},
              {"curves", curves},
              {"film", gathered.film()},
              {"bodies", gathered.tracks()}};
}

}  // namespace repose
