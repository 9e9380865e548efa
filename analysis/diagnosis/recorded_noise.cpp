#include "analysis/diagnosis/recorded_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/diagnosis/turning.hpp"

namespace repose::diagnosis {
namespace {

constexpr double resolution = 1e-4;

/// The samples of all runs and axes in one row, apart by more than differences reach: a median of many differences says more than a
/// median of few medians.
class Collection {
 public:
  void add(const std::string& observable, const std::vector<double>& samples, double largest_range = INFINITY) {
    double low = INFINITY, high = -INFINITY;
    for (const double x : samples)
      if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
    if (high > low) ranges_[observable] = std::max(ranges_[observable], std::min(high - low, largest_range));
    if (noise_from_differences(samples) == 0) return;  // a constant, or too short to say
    std::vector<double>& row = rows_[observable];
    row.insert(row.end(), samples.begin(), samples.end());
    row.insert(row.end(), apart, NAN);
  }

  std::map<std::string, NoiseModel> noise(const std::map<std::string, double>& given) const {
    std::map<std::string, NoiseModel> result;
    for (const auto& [name, row] : rows_) result[name] = noise_model(row);
    for (const auto& [name, sd] : given) {
      // Far below what was given, what the samples show is not the sensor: rounding, or a filter.
      const auto row = rows_.find(name);
      result[name] = {sd, result[name].sd > 0.5 * sd ? correlation_for(row->second, sd) : 0};
    }
    for (const auto& [name, range] : ranges_)
      if (result[name].sd < resolution * range) result[name] = {resolution * range, 0};
    return result;
  }

 private:
  static constexpr std::size_t apart = 6;  // three differences at stride 2
  std::map<std::string, std::vector<double>> rows_;
  std::map<std::string, double> ranges_;
};

}  // namespace

std::map<std::string, NoiseModel> recorded_noise(const Bundle& bundle, const std::vector<std::size_t>& runs) {
  Collection collection;
  for (const std::size_t index : runs)
    for (const Observation& o : bundle.runs[index].observations) {
      if (o.kind == ObservableKind::series) collection.add(o.name, o.value);
      if (o.kind != ObservableKind::trajectory) continue;
      const auto turns = turns_of(o.orientation);
      for (int k = 0; k < 3; ++k) {
        std::vector<double> x;
        for (const Vec3& p : o.position) x.push_back(p[k]);
        collection.add("position", x);
        if (!o.orientation.empty()) collection.add("orientation", turns[static_cast<std::size_t>(k)], 2 * std::numbers::pi);
      }
    }
  return collection.noise(bundle.noise);
}

}  // namespace repose::diagnosis
