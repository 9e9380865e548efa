#pragma once
/// A recording bundle: what was measured, in how many runs, and what the experimenter knew. Pure data; SI units.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/math.hpp"
#include "core/scene.hpp"
#include "core/scene_yaml.hpp"

namespace repose {

enum class ObservableKind { trajectory, series, profile, surface, scalar };

/// "trajectory", "series", ...
const std::string& kind_name(ObservableKind kind);

/// One measured thing of one run. NaN stands for what was not observed, wherever numbers are allowed to be missing.
struct Observation {
  ObservableKind kind = ObservableKind::trajectory;
  std::string name;          ///< "position" for a trajectory; else the name of the series, profile, surface or scalar
  std::string body;          ///< of a trajectory and of `specific_force`; may be empty for others
  std::optional<Vec3> axis;  ///< of `specific_force`: unit, body frame
  std::string unit;          ///< as given; values are in it
  std::string file;          ///< as given in recording.yaml; empty for a scalar

  std::vector<double> time;    ///< trajectory, series: [s], ascending. profile: empty if it has no time
  std::vector<Vec3> position;  ///< trajectory [m]: of the shape's own origin
  std::vector<Quat>
      orientation;               ///< trajectory: body to world, unit; empty if not observed at all. NaN: missing sample
  std::vector<double> at, at_y;  ///< profile: radius or x [m]; surface: x and y [m]
  std::vector<double> value;     ///< series: in `unit`; profile, surface: height [m]
  double scalar = 0, sd = 0;     ///< scalar, and its standard deviation (0: not given), in `unit`
};

/// One run, or one window of it.
struct BundleRun {
  std::string id;
  std::vector<Override> set;      ///< scene keys that differ in this run
  std::vector<std::string> free;  ///< start values (scene keys) to be estimated from the run itself
  bool held_out = false;
  double from = 0;  ///< [s] on the recording's clock: the run begins there, and times below count from it
  std::vector<Observation> observations;
};

struct Bundle {
  std::string title, source, licence;
  std::filesystem::path scene_file;     ///< of the nominal scene
  Scene scene;                          ///< the nominal scene, overrides applied
  std::vector<std::string> calibrate;   ///< scene keys of constants that nobody measured
  std::map<std::string, double> noise;  ///< standard deviation by observable ("position", "orientation" [rad], ...)
  bool split_given = false;             ///< a run says whether it is held out
  std::vector<BundleRun> runs;
  std::vector<std::string> warnings;  ///< what is doubtful, in words
};

/// Does a spin change where a body goes: is there something that it may touch, or an air that it lifts itself by?
bool path_shows_spin(const Scene& scene);

}  // namespace repose
