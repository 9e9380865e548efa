#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <variant>

#include "analysis/bundle/read_bundle.hpp"
#include "analysis/bundle/stray_samples.hpp"

namespace repose {
namespace {

constexpr double longest_fair_gap = 50;     // times the usual interval
constexpr std::size_t differences_that_tell_noise = 8;  // third ones, of a run (recorded_noise.hpp)
constexpr double shortest_fair_part = 300;  // the scene lasts at most so many times longer than its record

/// Equal numbers; two missing ones are equal, too.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])))) return false;
  return true;
}

bool same(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!(a[i][k] == b[i][k] || (std::isnan(a[i][k]) && std::isnan(b[i][k])))) return false;
  return true;
}

bool same(const std::vector<Quat>& a, const std::vector<Quat>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Quat& p, const Quat& q) {
    return p.coeffs() == q.coeffs() || (std::isnan(p.w()) && std::isnan(q.w()));
  });
}

bool same_data(const Observation& a, const Observation& b) {
  return a.kind == b.kind && a.name == b.name && a.body == b.body && same(a.time, b.time) && same(a.position, b.position) &&
         same(a.orientation, b.orientation) && same(a.at, b.at) && same(a.value, b.value) && (a.kind != ObservableKind::scalar || a.scalar == b.scalar);
}

/// Single numbers may be equal by chance: something with many samples must be, too.
bool same_data(const BundleRun& a, const BundleRun& b) {
  if (a.observations.size() != b.observations.size()) return false;
  bool many = false;
  for (std::size_t i = 0; i < a.observations.size(); ++i) {
    if (!same_data(a.observations[i], b.observations[i])) return false;
    many = many || a.observations[i].kind != ObservableKind::scalar;
  }
  return many;
}

/// Every sample of the same value: a sensor that hangs, or one body taken for another.
bool stands_still(const Observation& o) {
  const bool placed = std::any_of(o.position.begin(), o.position.end(), [](const Vec3& p) { return !p.array().isNaN().all(); });
  if (o.kind == ObservableKind::trajectory && !placed) return false;
  for (std::size_t i = 1; i < o.position.size(); ++i)
    if (!same({o.position[0]}, {o.position[i]})) return false;
  for (std::size_t i = 1; i < o.value.size(); ++i)
    if (o.value[i] != o.value[0]) return false;
  return o.kind == ObservableKind::trajectory || o.kind == ObservableKind::series;
}

/// Longest interval between samples over the middle one; 1 with fewer than five.
double longest_gap(const std::vector<double>& time) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < time.size(); ++i) intervals.push_back(time[i] - time[i - 1]);
  if (intervals.size() < 4) return 1;
  std::sort(intervals.begin(), intervals.end());
  return intervals.back() / intervals[intervals.size() / 2];
}

/// A record that begins later than it is long: rarely the end of what the scene does, mostly a clock that ran before.
void doubt_beginning(const BundleRun& run, std::vector<std::string>& doubts) {
  double begin = INFINITY, end = -INFINITY;
  for (const Observation& o : run.observations) {
    if (o.time.empty() || o.kind == ObservableKind::profile) continue;
    begin = std::min(begin, o.time.front());
    end = std::max(end, o.time.back());
  }
  if (std::isfinite(begin) && begin > end - begin)
    doubts.push_back(fmt::format("run {}: the first sample is at {:.6g} s, and the scene begins at 0; if the clock ran before the run began, say when that was: "
                                 "`from: {:.6g}`",
                                 run.id, run.from + begin, run.from + begin));
}

void doubt_clocks(const BundleRun& run, const Scene& scene, std::vector<std::string>& doubts) {
  const Observation* latest_begin = nullptr;
  const Observation* earliest_end = nullptr;
  for (const Observation& o : run.observations) {
    if (o.time.empty() || o.kind == ObservableKind::profile) continue;
    if (latest_begin == nullptr || o.time.front() > latest_begin->time.front()) latest_begin = &o;
    if (earliest_end == nullptr || o.time.back() < earliest_end->time.back()) earliest_end = &o;
    if (longest_gap(o.time) > longest_fair_gap)
      doubts.push_back(fmt::format("run {}: `{}` has a gap {:.0f} times as long as its usual interval; was the clock set, or were samples lost?", run.id,
                                   o.name, longest_gap(o.time)));
    if (!scene.layer && o.time.back() < scene.duration / shortest_fair_part && o.time.size() > 4)
      doubts.push_back(fmt::format("run {}: `{}` ends after {:.3g} s of the scene's {:.3g} s; are its times in seconds?", run.id, o.name, o.time.back(),
                                   scene.duration));
  }
  if (latest_begin != nullptr && latest_begin->time.front() > earliest_end->time.back())
    doubts.push_back(fmt::format("run {}: `{}` begins after `{}` has ended; do they share one clock?", run.id, latest_begin->name, earliest_end->name));
}

/// Start values to be estimated of bodies that their runs do not show.
void doubt_start_values(const Bundle& bundle, std::vector<std::string>& doubts) {
  std::map<std::string, std::vector<std::string>> unseen;  // runs, by key
  for (const BundleRun& run : bundle.runs)
    for (const std::string& key : run.free) {
      if (!key.starts_with("bodies.")) continue;
      bool placed = false, turned = false;
      for (const Observation& o : run.observations) {
        if (!key.starts_with("bodies." + o.body + ".")) continue;
        placed = true;
        turned = turned || !o.orientation.empty() ||
                 (key.ends_with(".angular_velocity") && o.kind == ObservableKind::trajectory && path_shows_spin(bundle.scene));
      }
      const bool turning = key.ends_with(".orientation") || key.ends_with(".angular_velocity");
      if (!placed || (turning && !turned)) unseen[key].push_back(run.id);
    }
  for (const auto& [key, runs] : unseen)
    doubts.push_back(fmt::format("run{} {}: nothing recorded shows `{}`; it stays as in the scene", runs.size() > 1 ? "s" : "", fmt::join(runs, ", "), key));
}

/// Third differences of the samples that are there.
std::size_t third_differences(std::size_t samples, const auto& has) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples; ++i) count += has(i) ? 1 : 0;
  return count > 3 ? count - 3 : 0;
}

/// Records so short that they do not tell their own noise, where none is given.
void doubt_noise(const Bundle& bundle, std::vector<std::string>& doubts) {
  std::map<std::string, std::size_t> most;
  const auto tell = [&](const std::string& name, std::size_t samples, const auto& has) { most[name] = std::max(most[name], third_differences(samples, has)); };
  for (const BundleRun& run : bundle.runs)
    for (const Observation& o : run.observations) {
      if (o.body.empty()) continue;
      for (int k = 0; k < 3; ++k) tell(o.name, o.position.size(), [&](std::size_t i) { return std::isfinite(o.position[i][k]); });
      tell(o.name, o.value.size(), [&](std::size_t i) { return std::isfinite(o.value[i]); });
      if (!o.orientation.empty()) tell("orientation", o.orientation.size(), [&](std::size_t i) { return std::isfinite(o.orientation[i].w()); });
    }
  for (const auto& [name, differences] : most)
    if (differences < differences_that_tell_noise && !bundle.noise.contains(name))
      doubts.push_back(fmt::format("the noise of `{}` is not given, and no run has the {} samples that would tell it: it is taken as a ten-thousandth of what is "
                                   "seen, and anything above that as missing physics; state it under `noise`", name, differences_that_tell_noise + 3));
}

}  // namespace

bool path_shows_spin(const Scene& scene) {
  return scene.bodies.size() > 1 || std::any_of(scene.effects.begin(), scene.effects.end(), [](const Effect& e) { return std::holds_alternative<Magnus>(e); });
}

std::vector<std::string> doubts_of(const Bundle& bundle) {
  std::vector<std::string> doubts;
  doubt_noise(bundle, doubts);
  doubt_start_values(bundle, doubts);
  for (std::size_t i = 0; i < bundle.runs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (same_data(bundle.runs[i], bundle.runs[j])) {
        doubts.push_back(
            fmt::format("runs {} and {} hold the same data: counted twice, they make every conclusion too sure",
                        bundle.runs[j].id, bundle.runs[i].id));
        break;
      }
    doubt_clocks(bundle.runs[i], bundle.scene, doubts);
    doubt_beginning(bundle.runs[i], doubts);
    for (const Observation& o : bundle.runs[i].observations)
      for (const std::string& stray : stray_samples(o)) doubts.push_back(fmt::format("run {}: {}", bundle.runs[i].id, stray));
    for (const Observation& o : bundle.runs[i].observations) {
      if (stands_still(o))
        doubts.push_back(fmt::format("run {}: `{}` never changes; is the sensor alive?", bundle.runs[i].id, o.name));
      if (!o.time.empty() && o.time.back() < 0)
        doubts.push_back(
            fmt::format("run {}: `{}` ends before time 0, where the simulation starts", bundle.runs[i].id, o.name));
      if (!o.time.empty() && o.time.front() > bundle.scene.duration)
        doubts.push_back(fmt::format("run {}: `{}` begins at {:.6g} s; are its times in seconds?", bundle.runs[i].id,
                                     o.name, o.time.front()));
      const auto& series = reserved_series();
      if (o.kind == ObservableKind::series && std::find(series.begin(), series.end(), o.name) == series.end())
        doubts.push_back(fmt::format("run {}: series `{}` is none that can be simulated; it is left out",
                                     bundle.runs[i].id, o.name));
    }
  }
  return doubts;
}

}  // namespace repose
