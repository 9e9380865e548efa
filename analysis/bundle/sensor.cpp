#include "analysis/bundle/sensor.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double noise_of(const SensorModel& sensor, const std::string& name) {
  const auto found = sensor.noise.find(name);
  return found == sensor.noise.end() ? 0 : found->second;
}

Vec3 normal3(Random& random) {
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

double mean_interval(const std::vector<double>& times) {
  return times.size() < 2 ? 1 : (times.back() - times.front()) / static_cast<double>(times.size() - 1);
}

}  // namespace

double normal(Random& random) {
  const double radius = std::sqrt(-2 * std::log(random.uniform()));
  return radius * std::cos(2 * std::numbers::pi * random.uniform());
}

void observe(const History& history, const std::vector<double>& times, Observation& o) {
  o.time = times;
  const bool of_a_body =
      o.kind == ObservableKind::trajectory || o.name == "specific_force" || o.name == "speed" || o.name == "height";
  if (!of_a_body) {
    const auto series = history.series.find(o.name);
    if (series == history.series.end())
      throw Error(o.name, "is not a series that this simulation tells", "leave it out");
    for (const double t : times) o.value.push_back(sample(history, series->second, t));
    return;
  }
  const auto body = history.bodies.find(o.body);
  if (body == history.bodies.end())
    throw Error(o.name, "body `" + o.body + "` does not move freely", "record a body that is neither fixed nor driven");
  const BodyTrack& track = body->second;
  for (const double t : times) {
    const BodySample state = sample(history, track, t);
    if (o.kind == ObservableKind::trajectory) {
      o.position.push_back(state.position);
      o.orientation.push_back(state.orientation);
    } else if (o.name == "speed") {
      o.value.push_back(state.velocity.norm());
    } else if (o.name == "height") {
      o.value.push_back(state.position.z());
    } else {
      o.value.push_back(specific_force(history, track, *o.axis, t, mean_interval(times)));
    }
  }
}

void disturb(const SensorModel& sensor, Random& random, Observation& o) {
  const double sd = noise_of(sensor, o.name), turn = noise_of(sensor, "orientation");
  if (o.kind == ObservableKind::scalar) {
    o.scalar += sd * normal(random);
    o.sd = std::hypot(o.sd, sd);  // what it has from its own measurement stays
    return;
  }
  for (std::size_t i = 0; i < o.time.size() || (o.time.empty() && i < o.value.size()); ++i) {
    // The draws do not depend on what is missing, so that a record with dropouts is the same record with gaps.
    const bool lost = random.uniform() < sensor.dropouts;
    if (o.kind == ObservableKind::trajectory) {
      o.position[i] += sd * normal3(random);
      o.orientation[i] = (o.orientation[i] * rotation_of(turn * normal3(random))).normalized();
      if (lost) {
        o.position[i] = Vec3::Constant(nan);
        o.orientation[i] = Quat(nan, nan, nan, nan);
      }
    } else {
      o.value[i] += sd * normal(random);
      if (lost) o.value[i] = nan;
    }
  }
}

}  // namespace repose
