#include "analysis/bundle/windows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "analysis/bundle/read_bundle.hpp"

namespace repose {
namespace {

constexpr std::size_t stretch = 8;  // samples that have to be smooth

/// Sequences of numbers of a trajectory: observed axes, and vector parts of the orientation against its first sample.
std::vector<std::vector<double>> sequences(const Observation& o) {
  std::vector<std::vector<double>> result(o.orientation.empty() ? 3 : 6);
  for (const Vec3& p : o.position)
    for (std::size_t k = 0; k < 3; ++k) result[k].push_back(p[static_cast<Eigen::Index>(k)]);
  for (const Quat& q : o.orientation) {
    const Quat turned = q * o.orientation.front().conjugate();
    for (std::size_t k = 0; k < 3; ++k)
      result[3 + k].push_back((turned.w() < 0 ? -1 : 1) * turned.vec()[static_cast<Eigen::Index>(k)]);
  }
  return result;
}

/// Root mean square of what a parabola through the samples from `first` on leaves; NaN where there are too few.
double roughness(const std::vector<double>& time, const std::vector<double>& value, std::size_t first) {
  if (first + stretch > time.size()) return std::numeric_limits<double>::quiet_NaN();
  Eigen::Matrix<double, stretch, 3> basis;
  Eigen::Matrix<double, stretch, 1> x;
  for (std::size_t i = 0; i < stretch; ++i) {
    const double t = time[first + i] - time[first];
    basis.row(static_cast<Eigen::Index>(i)) << 1, t, t * t;
    x[static_cast<Eigen::Index>(i)] = value[first + i];
  }
  const Eigen::Vector3d fit = basis.colPivHouseholderQr().solve(x);
  return (basis * fit - x).norm() / std::sqrt(static_cast<double>(stretch));
}

/// How rough the samples from each one on are: the worst sequence, each in units of its median. Infinite where unknown.
std::vector<double> roughness_of(const Observation& o) {
  std::vector<double> worst(o.time.size(), 0);
  for (const std::vector<double>& sequence : sequences(o)) {
    std::vector<double> rough, known;
    for (std::size_t i = 0; i < o.time.size(); ++i) {
      rough.push_back(roughness(o.time, sequence, i));
      if (std::isfinite(rough.back())) known.push_back(rough.back());
    }
    if (known.empty()) continue;  // an axis that was not observed
    const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
    std::nth_element(known.begin(), middle, known.end());
    for (std::size_t i = 0; i < worst.size(); ++i)
      worst[i] = std::isfinite(rough[i]) ? std::max(worst[i], *middle > 0 ? rough[i] / *middle : 0)
                                         : std::numeric_limits<double>::infinity();
  }
  return worst;
}

}  // namespace

std::vector<BundleRun> in_windows(const BundleRun& run, double length) {
  const auto seen = std::find_if(run.observations.begin(), run.observations.end(),
                                 [](const Observation& o) { return o.kind == ObservableKind::trajectory; });
  if (seen == run.observations.end()) return {run};
  const double end = seen->time.back();
  const int count = std::max(1, static_cast<int>(std::lround(end / length)));
  const std::vector<double> rough = roughness_of(*seen);
  std::vector<double> begins{0};
  for (int n = 1; n < count; ++n) {
    const double target = n * end / count;
    std::size_t best = rough.size();
    for (std::size_t i = 0; i < rough.size(); ++i)
      if (std::abs(seen->time[i] - target) <= length / 3 && (best == rough.size() || rough[i] < rough[best])) best = i;
    if (best < rough.size() && std::isfinite(rough[best])) begins.push_back(seen->time[best]);
  }
  std::vector<BundleRun> windows;
  for (std::size_t n = 0; n < begins.size(); ++n) {
    BundleRun window = run;
    window.from += begins[n];
    if (begins.size() > 1) window.id = fmt::format("{}@{:.3f}", run.id, window.from);
    const double until = n + 1 < begins.size() ? std::nextafter(begins[n + 1], 0) : std::numeric_limits<double>::infinity();
    bool enough = true;
    for (Observation& o : window.observations) {
      if (o.kind != ObservableKind::trajectory && o.kind != ObservableKind::series) continue;
      cut(o, begins[n], until);
      enough = enough && o.time.size() >= 2;
    }
    if (enough) windows.push_back(std::move(window));
  }
  return windows;
}

}  // namespace repose
