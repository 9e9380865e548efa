#include "analysis/diagnosis/recorded_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/diagnosis/turning.hpp"

namespace repose::diagnosis {
namespace {

constexpr double resolution = 1e-4, finest_stated = 1e-6;  // of the range

/// The step of which all samples are multiples, apart from where they begin; 0: there is none, or they are too few to show it.
double step_of_readings(std::vector<double> x) {
  constexpr std::size_t enough = 8;
  constexpr double same = 1e-6, whole = 1e-3;  // of the range, of the step
  std::erase_if(x, [](double value) { return !std::isfinite(value); });
  std::sort(x.begin(), x.end());
  if (x.size() < enough || !(x.back() > x.front())) return 0;
  double step = INFINITY;
  for (std::size_t i = 1; i < x.size(); ++i)
    if (const double apart = x[i] - x[i - 1]; apart > same * (x.back() - x.front())) step = std::min(step, apart);
  const bool multiples = std::all_of(x.begin(), x.end(), [&](double value) {
    const double steps = (value - x.front()) / step;
    return std::abs(steps - std::round(steps)) < whole * std::max(1.0, steps * whole);
  });
  return multiples ? step : 0;
}

/// The samples of all runs and axes in one row: a median of many differences says more than a median of few medians.
class Collection {
 public:
  void add(const std::string& observable, const std::vector<double>& time, const std::vector<double>& samples, double largest_range = INFINITY) {
    double low = INFINITY, high = -INFINITY;
    for (const double x : samples)
      if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
    if (high > low) {
      ranges_[observable] = std::max(ranges_[observable], std::min(high - low, largest_range));
      const double step = step_of_readings(samples);
      const auto [known, first] = steps_.emplace(observable, step);
      if (!first) known->second = std::min(known->second, step);
    }
    if (noise_from_differences({time, samples}) == 0) return;  // a constant, or too short to say
    TimedSamples& row = rows_[observable];
    row.time.insert(row.time.end(), time.begin(), time.end());
    row.value.insert(row.value.end(), samples.begin(), samples.end());
    row.time.push_back(NAN);
    row.value.push_back(NAN);
  }

  std::map<std::string, NoiseModel> noise(const std::map<std::string, double>& given) const {
    std::map<std::string, NoiseModel> result;
    for (const auto& [name, row] : rows_) result[name] = noise_model(row);
    for (const auto& [name, stated] : given) {
      // Readings in steps of q err by q / sqrt(12) more than the sensor does, if the samples scatter by more than was stated.
      double sd = stated;
      if (const auto step = steps_.find(name); step != steps_.end() && result[name].sd > stated)
        sd = std::min(result[name].sd, std::sqrt(stated * stated + step->second * step->second / 12));
      // Far below what was given, what the samples show is not the sensor: rounding, or a filter.
      const auto row = rows_.find(name);
      result[name] = {sd, result[name].sd > 0.5 * sd ? correlation_for(row->second, sd) : 0};
    }
    for (const auto& [name, range] : ranges_)
      if (const double least = (given.contains(name) ? finest_stated : resolution) * range; result[name].sd < least) result[name] = {least, 0};
    return result;
  }

 private:
  std::map<std::string, TimedSamples> rows_;
  std::map<std::string, double> ranges_;
  std::map<std::string, double> steps_;  ///< of the readings, the least of all runs and axes
};

Collection samples_of(const Bundle& bundle, const std::vector<std::size_t>& runs) {
  Collection collection;
  for (const std::size_t index : runs)
    for (const Observation& o : bundle.runs[index].observations) {
      if (o.kind == ObservableKind::series) collection.add(o.name, o.time, o.value);
      if (o.kind != ObservableKind::trajectory) continue;
      const auto turns = turns_of(o.orientation);
      for (int k = 0; k < 3; ++k) {
        std::vector<double> x;
        for (const Vec3& p : o.position) x.push_back(p[k]);
        collection.add("position", o.time, x);
        if (!o.orientation.empty()) collection.add("orientation", o.time, turns[static_cast<std::size_t>(k)], 2 * std::numbers::pi);
      }
    }
  return collection;
}

}  // namespace

std::map<std::string, NoiseModel> recorded_noise(const Bundle& bundle, const std::vector<std::size_t>& runs) {
  return samples_of(bundle, runs).noise(bundle.noise);
}

std::map<std::string, NoiseModel> scatter_of_samples(const Bundle& bundle, const std::vector<std::size_t>& runs) {
  return samples_of(bundle, runs).noise({});
}

}  // namespace repose::diagnosis
