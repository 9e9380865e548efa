#include "analysis/rest.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace repose {

RestReport assess_rest(const Model& model, const Snapshot& state, const HeapSite& site,
                       const std::optional<Outlet>& outlet, const RestLimits& limits) {
  if (!(limits.speed_max > 0) || !(limits.speed_rms > 0)) throw Error("rest", "the limits must be positive", "");
  const HeapGrains grains = find_heap(model, state, site);
  RestReport report;
  report.speed_scale = std::sqrt(model.gravity.norm() * grains.diameter);
  double squares = 0;
  std::size_t counted = 0;
  const auto count = [&](int body) {
    const double speed = state.velocity[static_cast<std::size_t>(body)].norm();
    report.speed_max = std::max(report.speed_max, speed);
    squares += speed * speed;
    ++counted;
  };
  for (int body : grains.heap) count(body);
  for (const auto* group : {&grains.loose, &grains.rim})
    for (int body : *group) {
      const bool above = outlet && state.position[static_cast<std::size_t>(body)].z() >= outlet->height;
      if (above) ++report.in_funnel;
      if (!above && group == &grains.loose) ++report.falling;
      count(body);
    }
  if (counted > 0 && report.speed_scale > 0) {
    report.speed_rms = std::sqrt(squares / static_cast<double>(counted)) / report.speed_scale;
    report.speed_max /= report.speed_scale;
  }
  if (grains.heap.empty()) {
    report.reason = "no grain lies on the base";
  } else if (outlet && state.time < outlet->opens) {
    report.reason = "the funnel is still closed";
  } else if (report.falling > 0) {
    report.reason = std::to_string(report.falling) + " grains are falling onto the heap";
  } else if (report.speed_max > limits.speed_max) {
    report.reason = "a grain moves faster than the limit";
  } else if (report.speed_rms > limits.speed_rms) {
    report.reason = "the grains move too fast on average";
  }
  report.at_rest = report.reason.empty();
  return report;
}

Displacement heap_displacement(const Snapshot& before, const Snapshot& after, const HeapGrains& grains) {
  if (before.size() != after.size()) throw Error("rest", "the states differ in size", "take both from one run");
  Displacement result;
  result.interval = after.time - before.time;
  if (grains.heap.empty() || !(grains.diameter > 0)) return result;
  double squares = 0;
  for (int body : grains.heap) {
    const std::size_t i = static_cast<std::size_t>(body);
    const double moved = (after.position[i] - before.position[i]).norm() / grains.diameter;
    result.max = std::max(result.max, moved);
    squares += moved * moved;
  }
  result.rms = std::sqrt(squares / static_cast<double>(grains.heap.size()));
  return result;
}

}  // namespace repose
