#pragma once
/// What a recording makes of the true motion, and the difference of a simulation from what was recorded.
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/bundle/bundle.hpp"
#include "analysis/diagnosis/hypothesis.hpp"
#include "analysis/history.hpp"

namespace repose::diagnosis {

/// One measured number sequence of a run: an axis of a position or orientation, or a series.
struct Channel {
  std::string observable;       ///< "position", "orientation", or the series' name
  std::string body;
  std::size_t observation = 0;  ///< of the run
  int axis = 0;                 ///< of a position, or of a rotation vector
  double noise = 1;             ///< standard deviation of one sample
  double phi = 0;               ///< correlation of neighbours at the usual interval
  std::vector<double> time;
  std::vector<std::size_t> at;  ///< index of each time in the observation
  Eigen::Index first = 0;       ///< of its residuals in the run's vector; as many as times
};

/// Errors of the recording:
///   recorded time = time_scale * t + offset,   recorded position = length_scale * R x + origin,   recorded series = value + bias
/// where R gives the components along axes that are turned about the world's x by tilt_x, then about its y by tilt_y [deg].
/// Lengths in a series scale with it: heights and accelerations by length_scale, speeds by length_scale / time_scale.
struct Measurement {
  double length = 1, time = 1, offset = 0;
  double tilt_x = 0, tilt_y = 0;
  Vec3 origin = Vec3::Zero();  ///< [m] of the world, as recorded
  std::map<int, double> bias;  ///< by observation of the run
  double true_time(double recorded) const { return (recorded - offset) / time; }
  Quat to_recorded() const;
  std::string text() const;  ///< all of it, for keys: equal texts make equal records
};

/// Takes from the parameters those of the measurement.
void take(const std::vector<Parameter>& parameters, const Eigen::VectorXd& values, Measurement& measurement);

/// A series that a simulation of few bodies has: of others nothing is compared.
bool is_simulated_series(const Observation& observation);

/// Rotation vector of the shorter turn [rad].
Vec3 rotation_vector(const Quat& q);

/// Simulated as it would have been recorded - recorded, channel after channel: SI units, orientations as rotation vectors [rad].
Eigen::VectorXd difference(const History& history, const BundleRun& run, const std::vector<Channel>& channels,
                           const Measurement& measurement);

}  // namespace repose::diagnosis
