#include "analysis/diagnosis/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/observation_model.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"

namespace repose::diagnosis {
namespace {

constexpr double resolution = 1e-4;  // of an observable's range: less noise than that is taken for a number that was not disturbed
constexpr double largest_numerics = 3;  // of the noise: a coarser step is for the candidate `time_step` to tell
constexpr double failed = 1e3;  // residual of a simulation that ended in failure: far from every sensible one

Vec3 rotation_vector(const Quat& q) {
  const Eigen::AngleAxisd turn(q.w() < 0 ? Quat(-q.w(), -q.x(), -q.y(), -q.z()) : q);
  return turn.angle() * turn.axis();
}

/// What the measurement effects of a run's values do.
struct Sensor {
  double length = 1, time = 1, offset = 0;
  double tilt_x = 0, tilt_y = 0;
  std::map<int, double> bias;
  Quat turned() const {
    constexpr double degree = 0.017453292519943295;
    return Quat(Eigen::AngleAxisd(tilt_y * degree, Vec3::UnitY()) * Eigen::AngleAxisd(tilt_x * degree, Vec3::UnitX())).conjugate();
  }
};

void take(const std::vector<Parameter>& parameters, const Values& values, Sensor& sensor) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double v = values[static_cast<Eigen::Index>(i)];
    switch (parameters[i].use) {
      case Parameter::Use::length_scale: sensor.length = v; break;
      case Parameter::Use::time_scale: sensor.time = v; break;
      case Parameter::Use::time_offset: sensor.offset = v; break;
      case Parameter::Use::tilt_x: sensor.tilt_x = v; break;
      case Parameter::Use::tilt_y: sensor.tilt_y = v; break;
      case Parameter::Use::bias: sensor.bias[parameters[i].component] = v; break;
      case Parameter::Use::scene:
      case Parameter::Use::turn: break;
    }
  }
}

/// Sets numbers and components of vectors in a scene tree.
void put(YamlNode& tree, const std::vector<Parameter>& parameters, const Values& values, const std::vector<Quat>& start_orientation,
         std::size_t& turned) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& p = parameters[i];
    const double v = values[static_cast<Eigen::Index>(i)];
    if (p.use == Parameter::Use::scene) {
      if (p.component < 0) {
        set_path(tree, p.key, fmt::format("{}", v));
        continue;
      }
      if (const YamlNode* vector = node_at(tree, p.key); vector == nullptr || vector->kind != YamlNode::Kind::sequence)
        set_path(tree, p.key, "[0, 0, 0]");  // not written out in the scene
      set_path(tree, fmt::format("{}.{}", p.key, p.component), fmt::format("{}", v));
    } else if (p.use == Parameter::Use::turn && p.component == 0) {
      const Vec3 w(v, values[static_cast<Eigen::Index>(i) + 1], values[static_cast<Eigen::Index>(i) + 2]);
      const Quat q = (rotation_of(w) * start_orientation.at(turned++)).normalized();
      set_path(tree, p.key, fmt::format("[{}, {}, {}, {}]", q.w(), q.x(), q.y(), q.z()));
    }
  }
}

double spacing(const std::vector<double>& time) {
  return time.size() < 2 ? 1 : (time.back() - time.front()) / static_cast<double>(time.size() - 1);
}

}  // namespace

Problem::Problem(const Bundle& bundle, const std::vector<std::size_t>& runs, Simulate simulate)
    : bundle_(bundle), simulate_(std::move(simulate)), scale_(natural_scale(realise(bundle.scene, 1))) {
  find_noise(runs);
  const YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  for (const std::string& key : bundle.calibrate) {
    Parameter p;
    p.key = key;
    p.lower = 0;
    p.upper = 1e6;
    for (const EffectRow& row : effect_library())
      for (const EffectParameter& q : row.parameters)
        if (const std::size_t dot = key.rfind('.'); q.key.ends_with(key.substr(dot)) && q.key.starts_with(key.substr(0, key.find('.')))) {
          const EffectBounds bounds = bounds_of(q, scale_);
          p.lower = bounds.lower;
          p.upper = bounds.upper;
          p.unit = q.unit;
          p.null = bounds.nominal;
        }
    const YamlNode* node = node_at(tree, key);
    p.start = node != nullptr && node->kind == YamlNode::Kind::scalar ? parse_quantity(node->text, dimension::none) : 0.3;
    p.step = 1e-3 * std::max(std::abs(p.start), 0.1 * std::min(p.upper - p.lower, 10.0));
    calibrated_.push_back(p);
  }
  for (const std::size_t index : runs) add_run(index);
  add_numerics();
}

void Problem::find_noise(const std::vector<std::size_t>& runs) {
  std::map<std::string, std::vector<NoiseModel>> found;
  std::map<std::string, double> ranges;
  const auto widen = [&](const std::string& name, const std::vector<double>& samples) {
    double low = INFINITY, high = -INFINITY;
    for (const double x : samples)
      if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
    if (high > low) ranges[name] = std::max(ranges[name], high - low);
  };
  const auto add = [&](const std::string& name, const std::vector<double>& samples) {
    widen(name, samples);
    if (const NoiseModel noise = noise_model(samples); noise.sd > 0) found[name].push_back(noise);
  };
  for (const std::size_t index : runs)
    for (const Observation& o : bundle_.runs[index].observations) {
      if (o.kind == ObservableKind::series) add(o.name, o.value);
      if (o.kind != ObservableKind::trajectory) continue;
      for (int k = 0; k < 3; ++k) {
        std::vector<double> x, turn;
        for (const Vec3& p : o.position) x.push_back(p[k]);
        add("position", x);
        for (const Quat& q : o.orientation) turn.push_back(rotation_vector(q * o.orientation.front().conjugate())[k]);
        if (!turn.empty() && std::isfinite(o.orientation.front().w())) add("orientation", turn);
      }
    }
  for (auto& [name, models] : found) {
    const auto middle = models.begin() + static_cast<std::ptrdiff_t>(models.size() / 2);
    std::nth_element(models.begin(), middle, models.end(), [](const NoiseModel& a, const NoiseModel& b) { return a.sd < b.sd; });
    noise_[name] = *middle;
    std::nth_element(models.begin(), middle, models.end(), [](const NoiseModel& a, const NoiseModel& b) { return a.phi < b.phi; });
    noise_[name].phi = middle->phi;
  }
  for (const auto& [name, sd] : bundle_.noise) noise_[name].sd = sd;
  for (auto& [name, range] : ranges) {
    NoiseModel& noise = noise_[name];
    if (noise.sd < resolution * range) noise = {resolution * range, 0};
  }
}

void Problem::add_numerics() {
  std::map<std::string, std::vector<double>> errors;  // by observable, of each run: rms in units of the noise
  Layout coarse = layout({}), fine = coarse;
  fine.step_factor = 0.5;
  Values shared(static_cast<Eigen::Index>(coarse.shared.size()));
  for (Eigen::Index i = 0; i < shared.size(); ++i) shared[i] = coarse.shared[static_cast<std::size_t>(i)].start;
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    Values own(static_cast<Eigen::Index>(runs_[run].start.size()));
    for (Eigen::Index i = 0; i < own.size(); ++i) own[i] = runs_[run].start[static_cast<std::size_t>(i)].start;
    const Eigen::VectorXd d = plain_residual(coarse, run, shared, own) - plain_residual(fine, run, shared, own);
    for (const Channel& c : runs_[run].channels)
      if (!c.time.empty())
        errors[c.observable].push_back(d.segment(c.first, static_cast<Eigen::Index>(c.time.size())).norm() / std::sqrt(static_cast<double>(c.time.size())));
  }
  for (auto& [name, list] : errors) {
    const auto middle = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2);
    std::nth_element(list.begin(), middle, list.end());
    const double grown = std::sqrt(1 + std::min(*middle, largest_numerics) * std::min(*middle, largest_numerics));
    noise_[name].sd *= grown;
  }
  for (RunData& data : runs_)
    for (Channel& c : data.channels) c.noise = noise_.at(c.observable).sd;
  cache_.clear();
}

void Problem::set_up_channels(RunData& data) const {
  data.channels.clear();
  data.size = 0;
  const auto add = [&](const std::string& observable, const std::string& body, int axis, const std::vector<double>& time,
                       const auto& observed) {
    Channel c;
    c.observable = observable;
    c.body = body;
    c.axis = axis;
    const auto noise = noise_.find(observable);
    c.noise = noise == noise_.end() || noise->second.sd == 0 ? 1e-6 : noise->second.sd;
    c.phi = noise == noise_.end() ? 0 : noise->second.phi;
    c.first = data.size;
    for (std::size_t i = 0; i < time.size(); ++i)
      if (time[i] <= data.horizon && observed(i)) c.time.push_back(time[i]);
    data.size += static_cast<Eigen::Index>(c.time.size());
    data.channels.push_back(std::move(c));
  };
  for (std::size_t n = 0; n < data.run->observations.size(); ++n) {
    const Observation& o = data.run->observations[n];
    if (o.kind == ObservableKind::trajectory) {
      for (int k = 0; k < 3; ++k) add("position", o.body, k, o.time, [&](std::size_t i) { return std::isfinite(o.position[i][k]); });
      if (!o.orientation.empty())
        for (int k = 0; k < 3; ++k)
          add("orientation", o.body, k, o.time, [&](std::size_t i) { return std::isfinite(o.orientation[i].w()); });
    } else if (o.kind == ObservableKind::series && (o.name == "specific_force" || o.name == "speed" || o.name == "height")) {
      add(o.name, o.body, static_cast<int>(n), o.time, [&](std::size_t i) { return std::isfinite(o.value[i]); });
    }
  }
}

void Problem::add_run(std::size_t index) {
  RunData data;
  data.run = &bundle_.runs[index];
  data.tree = parse_yaml(bundle_.scene.text, "scene");
  for (const Override& change : data.run->set) set_path(data.tree, change.path, change.value);
  std::map<std::string, double> noise;
  for (const auto& [name, model] : noise_) noise[name] = model.sd;
  data.start = start_values(*data.run, data.tree, noise);
  for (const Observation& o : data.run->observations)
    if (!o.time.empty()) data.horizon = std::max(data.horizon, o.time.back());
  set_up_channels(data);
  if (data.size == 0)
    throw Error("run " + data.run->id, "holds nothing that a few-body simulation can be compared with",
                "give a trajectory, or a series specific_force, speed or height");
  runs_.push_back(std::move(data));
  find_horizon(runs_.size() - 1);
}

void Problem::find_horizon(std::size_t run) {
  RunData& data = runs_[run];
  const auto k = static_cast<Eigen::Index>(data.start.size());
  if (k == 0) return;
  const Layout nominal = layout({});
  Values shared(static_cast<Eigen::Index>(nominal.shared.size())), own(k), spread(k);
  for (Eigen::Index i = 0; i < shared.size(); ++i) shared[i] = nominal.shared[static_cast<std::size_t>(i)].start;
  for (Eigen::Index i = 0; i < k; ++i) {
    own[i] = data.start[static_cast<std::size_t>(i)].start;
    spread[i] = 2 * data.start[static_cast<std::size_t>(i)].step;
  }
  // Where the response to the uncertainty of the start is no longer a straight line, a fit has nothing to hold on to.
  const Eigen::VectorXd middle = plain_residual(nominal, run, shared, own);
  double horizon = data.horizon;
  for (int trial = 0; trial < 4; ++trial) {
    Values signs(k);
    for (Eigen::Index i = 0; i < k; ++i) signs[i] = ((trial >> (i % 2)) + (i / 2) * trial) % 2 == 0 ? 1 : -1;
    const Eigen::VectorXd up = plain_residual(nominal, run, shared, own + signs.cwiseProduct(spread));
    const Eigen::VectorXd down = plain_residual(nominal, run, shared, own - signs.cwiseProduct(spread));
    for (const Channel& c : data.channels) {
      int bent_for = 0;
      for (std::size_t i = 0; i < c.time.size(); ++i) {
        const Eigen::Index at = c.first + static_cast<Eigen::Index>(i);
        const double bent = std::abs(up[at] + down[at] - 2 * middle[at]), straight = std::abs(up[at] - down[at]);
        bent_for = bent > std::max(5.0, 0.3 * straight) ? bent_for + 1 : 0;
        if (bent_for == 3) {
          horizon = std::min(horizon, c.time[i]);
          break;
        }
      }
    }
  }
  if (horizon < data.horizon) {
    data.horizon = horizon;
    set_up_channels(data);
  }
}

Layout Problem::layout(const Hypothesis& hypothesis) const {
  Layout result;
  result.hypothesis = hypothesis;
  result.shared = calibrated_;
  for (const RunData& data : runs_) result.per_run.push_back(data.start);
  for (const Term& term : hypothesis.terms) {
    const TermParameters shared = parameters_of(term, scale_, {});
    result.shared.insert(result.shared.end(), shared.shared.begin(), shared.shared.end());
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const TermParameters own = parameters_of(term, scale_, runs_[i].run->observations);
      result.per_run[i].insert(result.per_run[i].end(), own.per_run.begin(), own.per_run.end());
    }
  }
  return result;
}

YamlNode Problem::scene(const Layout& layout, std::size_t run, const Values& shared, const Values& own) const {
  const RunData& data = runs_[run];
  YamlNode tree = data.tree;
  put_terms(tree, layout.hypothesis, scale_);
  std::size_t turned = 0;
  std::vector<Quat> orientations;
  for (const Parameter& p : layout.per_run[run])
    if (p.use == Parameter::Use::turn && p.component == 0)
      for (const Observation& o : data.run->observations)
        if (p.key == "bodies." + o.body + ".orientation") {
          for (const Quat& q : o.orientation)
            if (std::isfinite(q.w())) {
              orientations.push_back(q);
              break;
            }
          break;
        }
  put(tree, layout.shared, shared, {}, turned);
  put(tree, layout.per_run[run], own, orientations, turned);
  if (layout.step_factor != 1 || layout.tolerance_factor != 1) {
    set_path(tree, "solver.time_step", fmt::format("{}", bundle_.scene.solver.time_step * layout.step_factor));
    set_path(tree, "solver.tolerance", fmt::format("{}", bundle_.scene.solver.tolerance * layout.tolerance_factor));
  }
  return tree;
}

YamlNode Problem::extended_scene(const Layout& layout, const Values& shared) const {
  YamlNode tree = parse_yaml(bundle_.scene.text, "scene");
  put_terms(tree, layout.hypothesis, scale_);
  std::size_t turned = 0;
  put(tree, layout.shared, shared, {}, turned);
  if (layout.step_factor != 1) set_path(tree, "solver.time_step", fmt::format("{}", bundle_.scene.solver.time_step * layout.step_factor));
  if (layout.tolerance_factor != 1) set_path(tree, "solver.tolerance", fmt::format("{}", bundle_.scene.solver.tolerance * layout.tolerance_factor));
  return tree;
}

History Problem::history(const Layout& layout, std::size_t run, const Values& shared, const Values& own) const {
  const Scene made = parse_scene(emit_yaml(scene(layout, run, shared, own)), bundle_.scene_file.string(), {}, bundle_.scene_file.parent_path());
  SimulationRequest request;
  request.scene = &made;
  request.contacts = true;
  request.until = std::max(runs_[run].horizon, 2 * made.solver.time_step);
  return simulate_(request);
}

Eigen::VectorXd Problem::residual(const Layout& layout, std::size_t run, const Values& shared, const Values& own,
                                  const std::vector<WindowLoad>& loads) const {
  Eigen::VectorXd r = plain_residual(layout, run, shared, own, loads);
  for (const Channel& c : runs_[run].channels)
    if (c.phi > 0) whiten(r.segment(c.first, static_cast<Eigen::Index>(c.time.size())), c.phi);
  return r;
}

Eigen::VectorXd Problem::plain_residual(const Layout& layout, std::size_t run, const Values& shared, const Values& own,
                                        const std::vector<WindowLoad>& loads) const {
  const RunData& data = runs_[run];
  Sensor sensor;
  take(layout.shared, shared, sensor);
  take(layout.per_run[run], own, sensor);
  std::string text = emit_yaml(scene(layout, run, shared, own));
  std::string key = text + fmt::format("|{}|{}|{}|{}|{}|{}|{}|{}", run, data.horizon, data.size, sensor.length, sensor.time, sensor.offset,
                                       sensor.tilt_x, sensor.tilt_y);
  for (const auto& [n, bias] : sensor.bias) key += fmt::format("|{}:{}", n, bias);
  for (const WindowLoad& load : loads)
    key += fmt::format("|{} {} {} {} {} {} {} {} {}", load.body, load.from, load.to, load.force.x(), load.force.y(), load.force.z(),
                       load.torque.x(), load.torque.y(), load.torque.z());
  const std::uint64_t hash = checksum(key);
  {
    const std::lock_guard lock(mutex_);
    if (const auto known = cache_.find(hash); known != cache_.end()) return known->second;
    ++simulations_;
  }
  Eigen::VectorXd r = Eigen::VectorXd::Constant(data.size, failed);
  try {
    const Scene made = parse_scene(text, bundle_.scene_file.string(), {}, bundle_.scene_file.parent_path());
    SimulationRequest request;
    request.scene = &made;
    request.loads = loads;
    request.until = std::max((data.horizon - sensor.offset) / sensor.time + 2 * made.solver.time_step, 4 * made.solver.time_step);
    const History history = simulate_(request);
    const Quat turned = sensor.turned();
    std::size_t channel = 0;
    for (std::size_t n = 0; n < data.run->observations.size(); ++n) {
      const Observation& o = data.run->observations[n];
      const auto body = history.bodies.find(o.body);
      if (body == history.bodies.end()) continue;
      const double window = spacing(o.time);
      while (channel < data.channels.size()) {
        const Channel& c = data.channels[channel];
        const bool mine = o.kind == ObservableKind::trajectory ? c.body == o.body && (c.observable == "position" || c.observable == "orientation")
                                                               : c.observable == o.name && c.axis == static_cast<int>(n);
        if (!mine) break;
        std::size_t i = 0;
        for (std::size_t k = 0; k < c.time.size(); ++k) {
          while (o.time[i] != c.time[k]) ++i;
          const double t = (c.time[k] - sensor.offset) / sensor.time;
          double difference = 0;
          if (c.observable == "position" || c.observable == "orientation") {
            const BodySample s = sample(history, body->second, t);
            if (c.observable == "position")
              difference = (sensor.length * (turned * s.position))[c.axis] - o.position[i][c.axis];
            else
              difference = rotation_vector(turned * s.orientation * o.orientation[i].conjugate())[c.axis];
          } else {
            const BodySample s = sample(history, body->second, t);
            const double value = o.name == "specific_force" ? specific_force(history, body->second, *o.axis, t, window) * sensor.length
                                 : o.name == "speed"        ? s.velocity.norm() * sensor.length / sensor.time
                                                            : s.position.z() * sensor.length;
            const auto bias = sensor.bias.find(static_cast<int>(n));
            difference = value + (bias == sensor.bias.end() ? 0 : bias->second) - o.value[i];
          }
          r[c.first + static_cast<Eigen::Index>(k)] = std::clamp(difference / c.noise, -1e6, 1e6);
        }
        ++channel;
      }
    }
  } catch (const Error& problem) {
    if (problem.problem() == "interrupted") throw;
    r.setConstant(failed);
  }
  const std::lock_guard lock(mutex_);
  cache_.emplace(hash, r);
  return r;
}

}  // namespace repose::diagnosis
