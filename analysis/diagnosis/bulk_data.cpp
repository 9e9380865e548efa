#include "analysis/diagnosis/bulk_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/diagnosis/bulk_profile.hpp"
#include "analysis/heap_profile.hpp"
#include "core/error.hpp"
#include "core/random.hpp"
#include "core/scene_yaml.hpp"
#include "core/yaml_reader.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t enough_replicates = 3;
constexpr std::size_t least_to_split = 3;
constexpr double longer = 1.05;  // than the shortest: worth a note
constexpr double covers = 0.8;   // of the plate's radius: a profile of few rings has its last place before the edge

bool same_settings(const std::vector<Override>& a, const std::vector<Override>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Override& x, const Override& y) { return x.path == y.path && x.value == y.value; });
}

/// 0 in every run, with no stated error: the bare plate before a layer. No packing changes it and its size gives no resolution, so it cannot be weighed.
bool is_always_zero(const BulkSummary& summary, const Bundle& bundle) {
  return std::all_of(bundle.runs.begin(), bundle.runs.end(), [&](const BundleRun& run) {
    const bool stated = std::any_of(run.observations.begin(), run.observations.end(), [&](const Observation& o) { return o.name == summary.observable && o.sd > 0; });
    return !stated && value_of(summary, run.observations) == 0;
  });
}

/// Runs of equal settings, in the order of the bundle.
std::vector<std::vector<std::size_t>> settings_of(const Bundle& bundle) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < bundle.runs.size(); ++i) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return same_settings(bundle.runs[g.front()].set, bundle.runs[i].set); });
    if (group == groups.end())
      groups.push_back({i});
    else
      group->push_back(i);
  }
  return groups;
}

/// Time of the last value; infinite for what is no series, or has none.
double end_of(const Observation& o) {
  if (o.kind == ObservableKind::series)
    for (std::size_t i = o.time.size(); i > 0; --i)
      if (std::isfinite(o.value[i - 1])) return o.time[i - 1];
  return INFINITY;
}

std::vector<BulkSummary> common_summaries(const Bundle& bundle, std::vector<std::string>& notes) {
  std::vector<BulkSummary> common;
  for (const BulkSummary& s : summaries_of(bundle.runs.front().observations)) {
    const auto lacks = std::find_if(bundle.runs.begin(), bundle.runs.end(), [&](const BundleRun& run) { return !std::isfinite(value_of(s, run.observations)); });
    if (lacks != bundle.runs.end())
      notes.push_back(fmt::format("`{}` is left out: run {} does not have it.", s.name, lacks->id));
    else if (is_always_zero(s, bundle))
      notes.push_back(fmt::format("`{}` is left out: it is 0 in every run.", s.name));
    else
      common.push_back(s);
  }
  if (common.empty())
    throw Error("runs", "no bulk observable is there in every run, other than 0",
                "give each run the same: angle_of_repose, heap, discharged_mass, mass_on_base, surface_angle, roller_force_*, a surface");
  return common;
}

void split(std::vector<std::size_t> runs, Random& random, std::vector<std::size_t>& train, std::vector<std::size_t>& held) {
  for (std::size_t i = runs.size(); i > 1; --i) std::swap(runs[i - 1], runs[random.below(i)]);
  const std::size_t out = runs.size() < least_to_split ? 0 : runs.size() / 3;
  held.assign(runs.begin(), runs.begin() + static_cast<std::ptrdiff_t>(out));
  train.assign(runs.begin() + static_cast<std::ptrdiff_t>(out), runs.end());
  std::sort(held.begin(), held.end());
  std::sort(train.begin(), train.end());
}

Eigen::MatrixXd rows_of_runs(const Bundle& bundle, const std::vector<std::size_t>& runs, const std::vector<BulkSummary>& summaries) {
  Eigen::MatrixXd rows(static_cast<Index>(runs.size()), static_cast<Index>(summaries.size()));
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (std::size_t k = 0; k < summaries.size(); ++k)
      rows(static_cast<Index>(i), static_cast<Index>(k)) = value_of(summaries[k], bundle.runs[runs[i]].observations);
  return rows;
}

}  // namespace

std::size_t BulkData::first_fitted() const {
  const auto found = std::find_if(settings.begin(), settings.end(), [](const BulkSetting& s) { return !s.train_runs.empty(); });
  return static_cast<std::size_t>(found - settings.begin());  // the reader refuses bundles that hold out everything
}

BulkData bulk_data(const Bundle& bundle, std::uint64_t seed, std::vector<std::string>& notes) {
  BulkData data;
  data.summaries = common_summaries(bundle, notes);
  for (const BulkSummary& chosen : three_of(data.summaries))
    for (std::size_t k = 0; k < data.summaries.size(); ++k)
      if (data.summaries[k].name == chosen.name) data.tested.push_back(static_cast<Index>(k));

  Random random(seed, 7);
  std::vector<std::string> held_ids;
  std::size_t fewest = bundle.runs.size();
  for (const std::vector<std::size_t>& group : settings_of(bundle)) {
    BulkSetting setting;
    setting.set = bundle.runs[group.front()].set;
    if (bundle.split_given)
      for (const std::size_t i : group) (bundle.runs[i].held_out ? setting.held_runs : setting.train_runs).push_back(i);
    else
      split(group, random, setting.train_runs, setting.held_runs);
    setting.like = bundle.runs[(setting.train_runs.empty() ? setting.held_runs : setting.train_runs).front()].observations;
    for (const std::size_t i : setting.held_runs) held_ids.push_back(bundle.runs[i].id);
    setting.train = rows_of_runs(bundle, setting.train_runs, data.summaries);
    setting.held = rows_of_runs(bundle, setting.held_runs, data.summaries);
    fewest = std::min(fewest, setting.train_runs.size());
    data.settings.push_back(std::move(setting));
  }
  if (held_ids.empty())
    notes.push_back("Nothing is held out: candidates are weighed on the data that they were fitted to, less what their parameters cost.");
  else if (!bundle.split_given)
    notes.push_back(fmt::format("No run says whether it is held out; by seed {} these are: {}.", seed, fmt::join(held_ids, ", ")));

  data.extra = Eigen::VectorXd::Zero(static_cast<Index>(data.summaries.size()));
  for (std::size_t k = 0; k < data.summaries.size() && fewest < enough_replicates; ++k)
    for (const BundleRun& run : bundle.runs)
      for (const Observation& o : run.observations)
        if (o.kind == ObservableKind::scalar && o.name == data.summaries[k].name)
          data.extra[static_cast<Index>(k)] = std::max(data.extra[static_cast<Index>(k)], o.sd * o.sd);
  return data;
}

namespace {

struct Shortest {
  double end = INFINITY;
  std::string run;
  std::vector<std::string> cut;  // runs that go on for longer
};

bool is_heap_profile(const Observation& o) { return o.kind == ObservableKind::profile && o.name == "heap"; }

/// Radius of the plate that the heaps of a setting stand on [m]; infinite where there is none.
double plate_of(const Bundle& bundle, const std::vector<Override>& set) {
  YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  for (const Override& change : set) set_path(tree, change.path, change.value);
  const auto site = heap_site(set.empty() ? bundle.scene : read_scene(tree, bundle.scene_file.string(), bundle.scene_file.parent_path()));
  return site ? site->radius : INFINITY;
}

/// Slope, apex and volume are told of a profile's reach: one that ends earlier, or that sees the table beyond the plate, gives other numbers of the same heap. So all
/// runs of a setting are read at the places of that which ends first, as far as the plate goes.
void read_at_equal_places(Bundle& bundle, const std::vector<std::size_t>& group, std::vector<std::string>& notes) {
  std::map<std::size_t, BulkProfile> profiles;
  Shortest s;
  for (const std::size_t i : group)
    for (const Observation& o : bundle.runs[i].observations) {
      if (!is_heap_profile(o)) continue;
      BulkProfile profile = last_profile(o);
      if (profile.at.empty()) continue;
      if (profile.at.back() < s.end) s = {profile.at.back(), bundle.runs[i].id, {}};
      profiles[i] = std::move(profile);
    }
  if (profiles.empty()) return;
  const double plate = plate_of(bundle, bundle.runs[group.front()].set), end = std::min(s.end, plate);
  const auto first_to_end = std::find_if(profiles.begin(), profiles.end(), [&](const auto& p) { return p.second.at.back() == s.end; });
  std::vector<double> places = first_to_end->second.at;
  // Hardly any place on the plate: other units, which are asked for where summaries are compared, and not a longer sight.
  constexpr std::ptrdiff_t fewest_places = 4;
  if (std::count_if(places.begin(), places.end(), [&](double r) { return r <= plate; }) >= fewest_places) std::erase_if(places, [&](double r) { return r > plate; });
  for (const auto& [i, profile] : profiles) {
    if (profile.at.back() > longer * end) s.cut.push_back(bundle.runs[i].id);
    if (profile.at == places) continue;
    for (Observation& o : bundle.runs[i].observations) {
      if (!is_heap_profile(o)) continue;
      o.time.clear();
      o.value.clear();
      o.at = places;
      for (const double r : places) o.value.push_back(height_at(profile, r));
    }
  }
  if (!s.cut.empty())
    notes.push_back(fmt::format("`heap` of {} is used up to {:.4g} m from the axis, where {}: what is beyond cannot be compared.", fmt::join(s.cut, ", "), end,
                                plate < s.end ? "the plate ends" : "that of " + s.run + " ends"));
  if (end < covers * plate && std::isfinite(plate))
    notes.push_back(fmt::format("`heap` goes no further than {:.0f} % of the plate's radius: its slope, apex and volume are those of this part, recorded and simulated.", 100 * end / plate));
}

}  // namespace

Bundle of_equal_length(Bundle bundle, std::vector<std::string>& notes) {
  for (const std::vector<std::size_t>& group : settings_of(bundle)) {
    read_at_equal_places(bundle, group, notes);
    std::map<std::pair<std::string, std::string>, Shortest> by_series;  // name, body
    for (const std::size_t i : group)
      for (const Observation& o : bundle.runs[i].observations)
        if (Shortest& s = by_series[{o.name, o.body}]; end_of(o) < s.end) s = {end_of(o), bundle.runs[i].id, {}};
    for (const std::size_t i : group)
      for (Observation& o : bundle.runs[i].observations) {
        Shortest& s = by_series[{o.name, o.body}];
        const double end = end_of(o);
        if (!std::isfinite(end)) continue;
        if (end > longer * s.end) s.cut.push_back(bundle.runs[i].id);
        const auto kept = static_cast<std::size_t>(std::upper_bound(o.time.begin(), o.time.end(), s.end) - o.time.begin());
        o.time.resize(kept);
        o.value.resize(kept);
      }
    for (const auto& [series, s] : by_series)
      if (!s.cut.empty())
        notes.push_back(fmt::format("`{}` of {} is cut at {:.4g} s, where that of {} ends: runs of one setting are compared over one time. If {} broke off, leave it out.",
                                    series.first, fmt::join(s.cut, ", "), s.end, s.run, s.run));
  }
  return bundle;
}

}  // namespace repose::diagnosis
