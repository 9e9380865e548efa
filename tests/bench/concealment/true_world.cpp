#include "tests/bench/concealment/true_world.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "analysis/bundle/sensor.hpp"
#include "analysis/diagnosis/locate.hpp"
#include "backends/backends.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/history.hpp"

namespace repose::concealment {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int field_passes = 4;
constexpr int windows_of_a_field = 150;

Quat tilted(const Recorder& r) {
  constexpr double degree = std::numbers::pi / 180;
  return Quat(Eigen::AngleAxisd(r.tilt_y * degree, Vec3::UnitY()) * Eigen::AngleAxisd(r.tilt_x * degree, Vec3::UnitX())).conjugate();
}

/// The field along a path, constant within each window.
std::vector<WindowLoad> windows_of(const ForceField& field, const History& history, const std::string& body) {
  std::vector<WindowLoad> windows;
  const BodyTrack& track = history.bodies.at(body);
  const double end = history.time.back(), length = end / windows_of_a_field;
  for (int i = 0; i < windows_of_a_field; ++i) {
    const double from = i * length;
    const BodySample s = sample(history, track, from + length / 2);
    const Vec3 force = field(from + length / 2, s.position, s.velocity);
    if (force.norm() > 0) windows.push_back({body, from, from + length, force, Vec3::Zero()});
  }
  return windows;
}

/// Standard numbers of one channel.
class Noise {
 public:
  Noise(const TrueSensor& sensor, Random& random) : sensor_(sensor), random_(random) {}
  double next() {
    switch (sensor_.kind) {
      case TrueSensor::Kind::heavy_tails: {
        const boost::math::students_t tails(4);  // of variance 2
        return boost::math::quantile(tails, random_.uniform()) / std::sqrt(2);
      }
      case TrueSensor::Kind::correlated:
        last_ = begun_ ? sensor_.correlation * last_ + std::sqrt(1 - sensor_.correlation * sensor_.correlation) * normal(random_) : normal(random_);
        begun_ = true;
        return last_;
      case TrueSensor::Kind::rounded:
      case TrueSensor::Kind::bursts:
        break;
    }
    return normal(random_);
  }
  /// A reading in steps of the noise.
  double read(double value, double sd) const { return sensor_.kind == TrueSensor::Kind::rounded && sd > 0 ? sd * std::round(value / sd) : value; }

 private:
  const TrueSensor& sensor_;
  Random& random_;
  double last_ = 0;
  bool begun_ = false;
};

double sd_of(const std::map<std::string, double>& noise, const std::string& name) {
  const auto found = noise.find(name);
  return found == noise.end() ? 0 : found->second;
}

}  // namespace

History live(const std::string& text, const std::vector<Override>& changes, const std::string& body, const Conditions& conditions) {
  Scene scene = parse_scene(text, "world", changes);
  scene.solver.time_step *= conditions.step_factor;
  scene.solver.tolerance *= conditions.tolerance_factor;
  SimulationRequest request;
  request.scene = &scene;
  request.contacts = true;
  const Backend& backend = find_backend(conditions.backend);
  if (backend.has_second_order) scene.solver.integration = Integration::second_order;
  History history = run_history(backend, request, false).history;
  for (int pass = 0; conditions.field && pass < field_passes; ++pass) {
    request.loads = windows_of(conditions.field, history, body);
    history = run_history(backend, request, false).history;
  }
  if (!history.converged) throw Error("world", "did not converge", "", Error::Kind::simulation);
  return history;
}

std::vector<Observation> record(const Experiment& experiment, const History& history, const Recorder& recorder) {
  std::vector<double> recorded, real;
  const double end = history.time.back();
  for (int i = 0; i / experiment.rate <= end; ++i) {
    const double t = i / experiment.rate, truth = (t - recorder.offset) / recorder.time;
    if (truth < 0 || truth > end) continue;
    recorded.push_back(t);
    real.push_back(truth);
  }
  const Quat turn = tilted(recorder);
  std::vector<Observation> result;
  for (Observation o : experiment.observables) {
    observe(history, real, o);
    o.time = recorded;
    for (Vec3& x : o.position) x = recorder.length * (turn * x) + recorder.origin;
    for (Quat& q : o.orientation) q = turn * q;
    for (double& v : o.value) v += recorder.bias;
    result.push_back(std::move(o));
  }
  return result;
}

const char* name_of(TrueSensor::Kind kind) {
  constexpr const char* names[] = {"heavy tails", "correlated", "rounded", "bursts of dropouts"};
  return names[static_cast<std::size_t>(kind)];
}

TrueSensor draw_sensor(Random& random) {
  TrueSensor sensor;
  sensor.kind = static_cast<TrueSensor::Kind>(random.below(4));
  if (sensor.kind == TrueSensor::Kind::correlated) sensor.correlation = random.uniform(0.2, 0.6);
  sensor.dropouts = sensor.kind == TrueSensor::Kind::bursts ? 0.15 : random.uniform(0, 0.03);
  return sensor;
}

void disturb(const TrueSensor& sensor, const std::map<std::string, double>& noise, Random& random, Observation& o) {
  const double sd = sd_of(noise, o.name), turn = sd_of(noise, "orientation");
  std::vector<Noise> channel(6, Noise(sensor, random));
  int lost = 0;
  for (std::size_t i = 0; i < o.time.size(); ++i) {
    const int burst = sensor.kind == TrueSensor::Kind::bursts ? 5 : 1;
    if (i > 0 && lost == 0 && random.uniform() < sensor.dropouts / burst) lost = burst;
    if (o.kind == ObservableKind::trajectory) {
      Vec3 w;
      for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<std::size_t>(k);
        o.position[i][k] = channel[c].read(o.position[i][k] + sd * channel[c].next(), sd);
        w[k] = turn * channel[c + 3].next();
      }
      o.orientation[i] = (o.orientation[i] * rotation_of(w)).normalized();
      if (lost > 0) {
        o.position[i] = Vec3::Constant(nan);
        o.orientation[i] = Quat(nan, nan, nan, nan);
      }
    } else {
      o.value[i] = lost > 0 ? nan : channel[0].read(o.value[i] + sd * channel[0].next(), sd);
    }
    lost = std::max(0, lost - 1);
  }
}

double headline(const std::string& family, const Observation& o) {
  const std::size_t n = o.time.size(), half = n / 2;
  if (o.kind == ObservableKind::series || family == "bounce") {
    double sum = 0;
    for (std::size_t i = half; i < n; ++i) sum += family == "bounce" ? o.position[i].z() : o.value[i];
    return sum / static_cast<double>(n - half);
  }
  if (family == "spin") {
    double angle = 0;
    for (std::size_t i = 1; i < n; ++i) angle += 2 * (o.orientation[i] * o.orientation[i - 1].conjugate()).z();
    return angle;
  }
  return (o.position.back() - o.position.front()).norm();
}

double signal(const std::vector<Observation>& a, const std::vector<Observation>& b, const std::map<std::string, double>& noise) {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double sd = sd_of(noise, a[k].name), turn = sd_of(noise, "orientation");
    for (std::size_t i = 0; i < std::min(a[k].time.size(), b[k].time.size()); ++i) {
      if (a[k].kind == ObservableKind::trajectory) {
        sum += (a[k].position[i] - b[k].position[i]).squaredNorm() / (sd * sd);
        sum += std::pow(a[k].orientation[i].angularDistance(b[k].orientation[i]) / turn, 2);
        count += 6;
      } else {
        sum += std::pow((a[k].value[i] - b[k].value[i]) / sd, 2);
        count += 1;
      }
    }
  }
  return std::sqrt(sum / std::max(1.0, count));
}

std::vector<std::array<double, 2>> times_in_phase(const History& history, const std::string& body, const std::string& phase, double sample) {
  std::vector<std::array<double, 2>> times;
  const std::vector<diagnosis::Phase> phases = diagnosis::phases_of(history, history.bodies.at(body), history.radius.at(body));
  const double margin = phase == "impact" ? sample : 0;
  for (std::size_t i = 0; i < phases.size(); ++i) {
    if (diagnosis::phase_name(phases[i]) != phase) continue;
    const double from = history.time[i] - margin, to = history.time[std::min(i + 1, phases.size() - 1)] + margin;
    if (!times.empty() && from <= times.back()[1])
      times.back()[1] = to;
    else
      times.push_back({from, to});
  }
  return times;
}

}  // namespace repose::concealment
