#include "analysis/diagnosis/bulk_locate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/diagnosis/bulk_profile.hpp"
#include "analysis/diagnosis/bulk_summary.hpp"
#include "analysis/statistics.hpp"
#include "analysis/two_samples.hpp"

namespace repose::diagnosis {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int parts = 3;
using Runs = std::vector<std::vector<Observation>>;

const Observation* find(const std::vector<Observation>& all, const Observation& like) {
  for (const Observation& o : all)
    if (o.kind == like.kind && o.name == like.name && o.body == like.body) return &o;
  return nullptr;
}

/// Mean of the finite values whose places lie in [from, to].
double mean_within(const std::vector<double>& at, const std::vector<double>& value, double from, double to) {
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < at.size(); ++i)
    if (at[i] >= from && at[i] <= to && std::isfinite(value[i])) {
      sum += value[i];
      ++n;
    }
  return n > 0 ? sum / n : nan;
}

/// The stretch in which the series of the first simulated run changes.
std::pair<double, double> moving_part(const Observation& o) {
  const auto [low, high] = std::minmax_element(o.value.begin(), o.value.end());
  const double a = *low, b = *high;
  std::size_t first = 0, last = o.time.size() - 1;
  while (first < last && o.value[first] < a + 0.02 * (b - a)) ++first;
  while (last > first && o.value[last] > a + 0.98 * (b - a)) --last;
  return last > first ? std::pair{o.time[first], o.time[last]} : std::pair{o.time.front(), o.time.back()};
}

/// That a value is one more of the sample: Student's t of a prediction.
double p_of_one_more(double value, const std::vector<double>& sample) {
  const Summary s = summarise(sample);
  if (!(s.sd > 0)) return value == s.mean ? 1 : 0;
  const double n = static_cast<double>(s.n), t = std::abs(value - s.mean) / (s.sd * std::sqrt(1 + 1 / n));
  return student_two_sided(t, n - 1);
}

/// A number of each run that has it.
struct Values {
  std::vector<double> value;
  std::vector<std::size_t> run;
};

void test(BulkLocated part, const Values& of_recorded, const std::vector<double>& simulated, std::vector<BulkLocated>& found) {
  const std::vector<double>& recorded = of_recorded.value;
  if (recorded.empty() || simulated.size() < 2) return;
  const Summary a = summarise(recorded), b = summarise(simulated);
  const auto furthest = std::max_element(recorded.begin(), recorded.end(), [&](double x, double y) { return std::abs(x - b.mean) < std::abs(y - b.mean); });
  part.run = of_recorded.run[static_cast<std::size_t>(furthest - recorded.begin())];
  part.difference = a.mean - b.mean;
  const double sd = std::max(b.sd, a.sd);
  part.in_scatter = sd > 0 ? part.difference / sd : 0;
  part.p = recorded.size() > 1 ? welch_difference(recorded, simulated).p : p_of_one_more(recorded.front(), simulated);
  found.push_back(std::move(part));
}

std::string phase_of(const Observation& o) {
  if (o.name.starts_with("roller_") || o.kind == ObservableKind::surface) return "spread";
  return o.name == "discharged_mass" || o.name == "surface_angle" ? "flow" : "heap";
}

template <class Value>
Values values(const Runs& runs, const Observation& like, Value value) {
  Values result;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (const Observation* o = find(runs[i], like))
      if (const double v = value(*o); std::isfinite(v)) {
        result.value.push_back(v);
        result.run.push_back(i);
      }
  return result;
}

}  // namespace

std::vector<BulkLocated> locate_bulk(const Runs& recorded, const Runs& simulated) {
  std::vector<BulkLocated> found;
  if (recorded.empty() || simulated.empty()) return found;
  for (const Observation& o : recorded.front()) {
    const Observation* model = find(simulated.front(), o);
    if (model == nullptr) continue;
    BulkLocated part;
    part.observable = o.name;
    part.phase = phase_of(o);
    const auto compare = [&](auto value) { test(part, values(recorded, o, value), values(simulated, o, value).value, found); };
    if (o.kind == ObservableKind::scalar) compare([](const Observation& x) { return x.scalar; });
    if (o.kind == ObservableKind::surface) {
      const BulkSummary mean{o.name + "_mean", o.name, part.phase, ""}, sd{o.name + "_sd", o.name, part.phase, ""};
      compare([&](const Observation& x) { return value_of(mean, {x}); });
      part.quantity = "roughness";
      compare([&](const Observation& x) { return value_of(sd, {x}); });
    }
    const bool series = o.kind == ObservableKind::series;
    const BulkProfile profile = o.kind == ObservableKind::profile ? last_profile(o) : BulkProfile{};
    if (series ? model->time.size() < 2 : profile.at.empty()) continue;
    const auto [from, to] = series ? moving_part(*model) : std::pair{0.0, profile.at.back()};
    for (int i = 0; i < parts; ++i) {
      const double a = from + (to - from) * i / parts, b = from + (to - from) * (i + 1) / parts;
      (series ? part.t_start : part.radius_from) = a;
      (series ? part.t_end : part.radius_to) = b;
      compare([a, b, series](const Observation& x) {
        if (series) return mean_within(x.time, x.value, a, b);
        const BulkProfile p = last_profile(x);
        return mean_within(p.at, p.height, a, b);
      });
    }
  }
  std::vector<double> p;
  for (const BulkLocated& l : found) p.push_back(l.p);
  const std::vector<double> corrected = holm(p);
  for (std::size_t i = 0; i < found.size(); ++i) found[i].p = corrected[i];
  std::stable_sort(found.begin(), found.end(), [](const BulkLocated& a, const BulkLocated& b) {
    return a.p != b.p ? a.p < b.p : std::abs(a.in_scatter) > std::abs(b.in_scatter);
  });
  return found;
}

}  // namespace repose::diagnosis
