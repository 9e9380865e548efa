#pragma once
/// The world that was recorded: simulated more finely than any fit, on any backend, with forces that no library has; and
/// the sensors that watched it.
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "analysis/history.hpp"
#include "tests/bench/concealment/experiment.hpp"

namespace repose::concealment {

/// A force [N] on the body `Experiment::body` by time, place and velocity; empty: none.
using ForceField = std::function<Vec3(double t, const Vec3& x, const Vec3& v)>;

struct Conditions {
  std::string backend = "dvi";
  double step_factor = 0.25, tolerance_factor = 0.1;  ///< against the scene's own
  ForceField field;
};

/// A field makes time windows of force from the path that it gave, four times over. Throws Error if the run fails, or if the
/// backend lacks something.
History live(const std::string& scene, const std::vector<Override>& changes, const std::string& body, const Conditions& conditions);

/// Exact samples through the recorder, at the experiment's rate in recorded time.
std::vector<Observation> record(const Experiment& experiment, const History& history, const Recorder& recorder);

/// Noise that is not the fit's: none of the kinds is white and Gaussian with independent dropouts.
struct TrueSensor {
  enum class Kind { heavy_tails, correlated, rounded, bursts } kind = Kind::heavy_tails;
  double correlation = 0;   ///< of neighbours, AR(1)
  double dropouts = 0;      ///< share of samples
};
const char* name_of(TrueSensor::Kind kind);
TrueSensor draw_sensor(Random& random);
void disturb(const TrueSensor& sensor, const std::map<std::string, double>& noise, Random& random, Observation& observation);

/// One number of a record that a reader would compare first: how far the body came; bounces: the mean height of the second half; spins:
/// the angle turned about the vertical; an accelerometer: the mean of the second half.
double headline(const std::string& family, const Observation& observation);

/// Root mean square of the difference of two records in units of the noise.
double signal(const std::vector<Observation>& a, const std::vector<Observation>& b, const std::map<std::string, double>& noise);

/// When the body is in a phase; impacts are widened to one sample on both sides.
std::vector<std::array<double, 2>> times_in_phase(const History& history, const std::string& body, const std::string& phase, double sample);

}  // namespace repose::concealment
