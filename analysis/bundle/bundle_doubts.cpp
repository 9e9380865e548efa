#include <fmt/format.h>

#include <cmath>

#include "analysis/bundle/read_bundle.hpp"

namespace repose {
namespace {

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

bool same_data(const Observation& a, const Observation& b) {
  return a.kind != ObservableKind::scalar && a.kind == b.kind && a.name == b.name && a.body == b.body &&
         same(a.time, b.time) && same(a.position, b.position) && same(a.at, b.at) && same(a.value, b.value);
}

bool same_data(const BundleRun& a, const BundleRun& b) {
  if (a.observations.size() != b.observations.size()) return false;
  for (std::size_t i = 0; i < a.observations.size(); ++i)
    if (!same_data(a.observations[i], b.observations[i])) return false;
  return true;
}

/// Every sample of the same value: a sensor that hangs, or one body taken for another.
bool stands_still(const Observation& o) {
  for (std::size_t i = 1; i < o.position.size(); ++i)
    if (!same({o.position[0]}, {o.position[i]})) return false;
  for (std::size_t i = 1; i < o.value.size(); ++i)
    if (o.value[i] != o.value[0]) return false;
  return o.kind == ObservableKind::trajectory || o.kind == ObservableKind::series;
}

}  // namespace

std::vector<std::string> doubts_of(const Bundle& bundle) {
  std::vector<std::string> doubts;
  for (std::size_t i = 0; i < bundle.runs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      if (same_data(bundle.runs[i], bundle.runs[j])) {
        doubts.push_back(
            fmt::format("runs {} and {} hold the same data: counted twice, they make every conclusion too sure",
                        bundle.runs[j].id, bundle.runs[i].id));
        break;
      }
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
