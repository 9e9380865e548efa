#pragma once
/// The `record` block of a scene: what `repose record` writes.
///
///   record:
///     rate: 200                                    # samples per second
///     noise: {position: 1.0e-4, orientation: 1e-3} # standard deviations; none if left out
///     dropouts: 0.02                               # share of samples that are missing
///     observables:                                 # as in a bundle, without files and values
///       - {kind: trajectory, body: ball}
///       - {kind: series, name: specific_force, body: ball, axis: [0, 0, 1], unit: m/s^2}
///       - {kind: profile, name: heap}
///       - {kind: surface, name: layer_after}       # of a scene with a `layer` block: it is spread as by `repose layer`
///     runs: [{id: slow, set: {bodies.ball.velocity: [1, 0, 0]}}]   # default: one run, run-01
///     conceal: {pairs.pa12-steel.rolling_friction: 0.1}   # true of the recorded world, absent from the bundle's scene
///     free: [bodies.ball.velocity]                 # handed on to every run
///     calibrate: [pairs.pa12-steel.friction]       # handed on
#include <string>
#include <vector>

#include "analysis/bundle/sensor.hpp"
#include "scenarios/history.hpp"

namespace repose {

struct RecordedRun {
  std::string id;
  std::vector<Override> set;
};

struct RecordBlock {
  SensorModel sensor;
  std::vector<Observation> observables;  ///< without samples
  std::vector<RecordedRun> runs;
  std::vector<Override> conceal;         ///< scene keys of the recorded world that the bundle's scene does not have
  std::vector<std::string> free, calibrate;
  std::string scene_without_record;  ///< YAML
};

/// What is told of a scene with a `layer` block: surfaces `layer_before` and `layer_after`, series `roller_force_x`, `roller_force_z` and `roller_torque`
/// (of a blade likewise).
bool told_of_a_layer(const Observation& observation);

/// Throws Error naming file, line and key. A scene without the block records the poses of all free bodies, 100 a
/// second.
RecordBlock read_record_block(const Scene& scene, const std::string& name);

/// 0, 1 / rate, ... up to `duration`.
std::vector<double> sample_times(double rate, double duration);

/// "run-01.csv", with the name of the observable if the run has several, and its number if several have that.
std::string file_name(const std::string& run, const Observation& observation, const std::vector<Observation>& all);

}  // namespace repose
