#pragma once
/// Small experiments of few bodies, drawn at random: what an experimenter would set up, and what could be concealed in it.
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "analysis/bundle/bundle.hpp"
#include "core/random.hpp"

namespace repose::concealment {

/// What happens to samples on their way into the record, in the order: scale and tilt of lengths, origin and bias, clock.
struct Recorder {
  double length = 1, time = 1;    ///< recorded = factor * true
  double offset = 0;              ///< [s], recorded time = true + offset
  double tilt_x = 0, tilt_y = 0;  ///< [deg], of the recording's axes against the world's
  double bias = 0;                ///< of a series, in its unit
  Vec3 origin = Vec3::Zero();     ///< [m] of the world, as recorded
};

/// The world with an effect at one strength.
struct Change {
  std::vector<Override> scene;    ///< keys of the scene
  Recorder recorder;              ///< of a measurement effect; else nothing
  std::string parameter;          ///< as a diagnosis names it: "effects.magnus.lift", "length_scale.factor"
  double value = 0, null = 0;     ///< of that parameter, and where it does nothing
};

/// An effect of the library (or, with a leading "outside:", none of it) that can be concealed.
struct Concealable {
  std::string effect;
  double lower = 0, upper = 0;    ///< of the strength, > 0; drawn evenly in its logarithm
  bool either_sign = false;
  std::string phase;              ///< where it acts ("rolling"); empty: everywhere
  std::function<Change(double strength)> at;
};

struct PlannedRun {
  std::string id;
  std::vector<Override> set;      ///< what the experimenter believes of the start
};

struct Experiment {
  std::string family;
  std::string scene;                    ///< YAML without the constants
  std::vector<Override> constants;      ///< of pairs and effects, true in the nominal world
  std::string knob;                     ///< the constant that level C1 sets wrong and lets calibrate; may be empty
  double knob_lower = 0, knob_upper = 0;
  bool knob_unmeasured = false;         ///< calibrated on every level
  std::vector<PlannedRun> runs;
  std::vector<std::string> free;
  std::vector<Observation> observables;
  double rate = 100;                    ///< [Hz]
  std::map<std::string, double> noise;  ///< standard deviations
  std::string body;                     ///< whose path is the headline
  std::vector<Concealable> effects;
  std::vector<std::pair<std::string, std::string>> opposed;  ///< pairs that can cancel in part
};

/// "throw", "roll", "slide", "bounce", "spin", "impact", "lob", "accelerometer", "shaken", "conveyor".
const std::vector<std::string>& families();
Experiment draw_experiment(const std::string& family, Random& random);

/// Even in the logarithm.
double log_uniform(Random& random, double lower, double upper);

}  // namespace repose::concealment
