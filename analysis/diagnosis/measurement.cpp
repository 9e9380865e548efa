#include "analysis/diagnosis/measurement.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <numbers>

namespace repose::diagnosis {
namespace {

constexpr double degree = std::numbers::pi / 180;

double spacing(const std::vector<double>& time) {
  return time.size() < 2 ? 1 : (time.back() - time.front()) / static_cast<double>(time.size() - 1);
}

double of_series(const History& history, const BodyTrack& track, const Observation& o, double t, const Measurement& m) {
  if (o.name == "specific_force") return m.length * specific_force(history, track, *o.axis, t, spacing(o.time));
  const BodySample s = sample(history, track, t);
  return o.name == "speed" ? s.velocity.norm() * m.length / m.time : s.position.z() * m.length;
}

}  // namespace

Quat Measurement::to_recorded() const {
  const Eigen::AngleAxisd about_x(tilt_x * degree, Vec3::UnitX()), about_y(tilt_y * degree, Vec3::UnitY());
  return Quat(about_y * about_x).conjugate();
}

std::string Measurement::text() const {
  std::string all = fmt::format("{}|{}|{}|{}|{}|{}|{}|{}", length, time, offset, tilt_x, tilt_y, origin.x(), origin.y(), origin.z());
  for (const auto& [n, b] : bias) all += fmt::format("|{}:{}", n, b);
  return all;
}

void take(const std::vector<Parameter>& parameters, const Eigen::VectorXd& values, Measurement& m) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double v = values[static_cast<Eigen::Index>(i)];
    switch (parameters[i].use) {
      case Parameter::Use::length_scale: m.length = v; break;
      case Parameter::Use::time_scale: m.time = v; break;
      case Parameter::Use::time_offset: m.offset = v; break;
      case Parameter::Use::tilt_x: m.tilt_x = v; break;
      case Parameter::Use::tilt_y: m.tilt_y = v; break;
      case Parameter::Use::origin: m.origin[parameters[i].component] = v; break;
      case Parameter::Use::bias: m.bias[parameters[i].component] = v; break;
      case Parameter::Use::scene:
      case Parameter::Use::turn: break;
    }
  }
}

bool is_simulated_series(const Observation& o) {
  return o.kind == ObservableKind::series && (o.name == "specific_force" || o.name == "speed" || o.name == "height");
}

Vec3 rotation_vector(const Quat& q) {
  const Eigen::AngleAxisd turn(q.w() < 0 ? Quat(-q.w(), -q.x(), -q.y(), -q.z()) : q);
  return turn.angle() * turn.axis();
}

Eigen::VectorXd difference(const History& history, const BundleRun& run, const std::vector<Channel>& channels,
                           const Measurement& m) {
  const Quat turned = m.to_recorded();
  const Channel& last = channels.back();
  Eigen::VectorXd d(last.first + static_cast<Eigen::Index>(last.time.size()));
  for (const Channel& c : channels) {
    const Observation& o = run.observations[c.observation];
    const BodyTrack& track = history.bodies.at(c.body);
    const auto bias = m.bias.find(static_cast<int>(c.observation));
    for (std::size_t k = 0; k < c.time.size(); ++k) {
      const std::size_t i = c.at[k];
      const double t = m.true_time(c.time[k]);
      double& out = d[c.first + static_cast<Eigen::Index>(k)];
      if (c.observable == "position")
        out = m.length * (turned * sample(history, track, t).position)[c.axis] + m.origin[c.axis] - o.position[i][c.axis];
      else if (c.observable == "orientation")
        out = rotation_vector(turned * sample(history, track, t).orientation * o.orientation[i].conjugate())[c.axis];
      else
        out = of_series(history, track, o, t, m) + (bias == m.bias.end() ? 0 : bias->second) - o.value[i];
    }
  }
  return d;
}

}  // namespace repose::diagnosis
