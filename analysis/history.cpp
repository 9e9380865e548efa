#include "analysis/history.hpp"

#include <algorithm>
#include <cmath>

namespace repose {
namespace {

struct Between {
  std::size_t before = 0, after = 0;
  double share = 0;  ///< of `after`
};

Between find(const std::vector<double>& times, double time) {
  if (time <= times.front()) return {};
  if (time >= times.back()) return {times.size() - 1, times.size() - 1, 0};
  // Steps are equally long, but for rounding: guess, then correct.
  const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  std::size_t i = std::min(static_cast<std::size_t>((time - times.front()) / step), times.size() - 2);
  while (i > 0 && times[i] > time) --i;
  while (i + 2 < times.size() && times[i + 1] <= time) ++i;
  return {i, i + 1, (time - times[i]) / (times[i + 1] - times[i])};
}

Vec3 mixed(const std::vector<Vec3>& values, const Between& b) {
  return values[b.before] + b.share * (values[b.after] - values[b.before]);
}

/// Hermite's cubic.
Vec3 between_steps(const History& history, const BodyTrack& track, const Between& b) {
  if (!history.smooth || b.before == b.after) return mixed(track.position, b);
  const double s = b.share, h = history.time[b.after] - history.time[b.before], r = 1 - s;
  return r * r * (1 + 2 * s) * track.position[b.before] + s * s * (3 - 2 * s) * track.position[b.after] +
         h * s * r * (r * track.velocity[b.before] - s * track.velocity[b.after]);
}

}  // namespace

BodySample sample(const History& history, const BodyTrack& track, double time) {
  const Between b = find(history.time, time);
  return {between_steps(history, track, b), mixed(track.velocity, b), mixed(track.spin, b),
          track.orientation[b.before].slerp(b.share, track.orientation[b.after])};
}

double specific_force(const History& history, const BodyTrack& track, const Vec3& axis, double time, double window) {
  if (time < history.time.front()) {  // held until it is released
    return -axis.dot(track.orientation.front().conjugate() * history.gravity);
  }
  const double from = std::max(time - window / 2, history.time.front());
  const double to = std::min(time + window / 2, history.time.back());
  const BodySample before = sample(history, track, from),
                   after = sample(history, track, std::max(to, from + 1e-3 * window));
  const Vec3 acceleration = (after.velocity - before.velocity) / std::max(to - from, 1e-3 * window);
  const Quat turned = sample(history, track, time).orientation;
  return axis.dot(turned.conjugate() * Vec3(acceleration - history.gravity));
}

double sample(const History& history, const std::vector<double>& series, double time) {
  const Between b = find(history.time, time);
  return series[b.before] + b.share * (series[b.after] - series[b.before]);
}

}  // namespace repose
