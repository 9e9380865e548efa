#pragma once
/// What a study runs: points (sets of scene keys) in named series, each with several seeds.
///
///   title: Table 2 of the source study
///   scene: aor-quick.yaml                 # beside this file
///   seeds: 8                              # per point, numbered from first_seed
///   first_seed: 1
///   set: {grains.powder.count: 2500}      # for all points; keys as after --set
///   series:
///     table2:
///       label: seven shapes
///       reference: pa650/table2.yaml      # published values to compare with
///       set: {}                           # for this series
///       vary:                             # lists in one map go together; maps of the list are crossed
///         - {pairs.pa12-pa12.rolling_friction: [0.05, 0.1], pairs.pa12-pa12.spinning_friction: [0.05, 0.1]}
///       points: [{label: sliding only, set: {...}}]   # instead of, or beside, `vary`
///       seeds: 8                          # if not that of the study
///       scene: aor.yaml                   # if not that of the study
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/scene_yaml.hpp"

namespace repose {

struct StudyPoint {
  std::size_t series = 0;      ///< index into StudyPlan::series
  std::string label;
  std::optional<double> x;     ///< value of the first varied key, if it is a number, in StudySeries::x_unit
  std::vector<Override> set;   ///< of the study, of the series, of the point, in this order
  int seeds = 0;
  std::filesystem::path scene;  ///< resolved against the folder of the study
};

struct StudySeries {
  std::string name, label, reference;  ///< reference: may be empty
  std::string x_key;                   ///< the first varied key; empty if none
  std::string x_unit;                  ///< as its values were written ("um"); empty if without, or not the same for all
};

struct StudyPlan {
  std::string title;
  std::uint64_t first_seed = 1;
  std::vector<StudySeries> series;
  std::vector<StudyPoint> points;
};

/// Throws Error naming file, line and key.
StudyPlan load_study(const std::filesystem::path& file);
StudyPlan parse_study(const std::string& text, const std::string& name, const std::filesystem::path& folder);

}  // namespace repose
