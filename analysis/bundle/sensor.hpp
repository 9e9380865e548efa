#pragma once
/// What sensors see of a simulated history: samples at a rate, with noise and dropouts.
#include <cstdint>
#include <map>
#include <string>

#include "analysis/bundle/bundle.hpp"
#include "analysis/history.hpp"
#include "core/random.hpp"

namespace repose {

/// Fills `observation` (a trajectory or a series; its kind, name, body and axis are given) with exact samples at
/// `times`. Throws Error if the history does not hold what is asked for.
void observe(const History& history, const std::vector<double>& times, Observation& observation);

struct SensorModel {
  double rate = 100;                    ///< [Hz], > 0
  std::map<std::string, double> noise;  ///< standard deviation by observable; orientation [rad] about each axis
  double dropouts = 0;                  ///< share of the samples that are missing, in [0, 1)
};

/// Adds independent Gaussian noise and takes samples away (their fields become NaN, the time stays). The same random
/// stream gives the same record.
void disturb(const SensorModel& sensor, Random& random, Observation& observation);

/// A standard normal number (Box & Muller).
double normal(Random& random);

}  // namespace repose
