#pragma once
/// One case: a bundle in which something is concealed, and the truth about it.
#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "analysis/bundle/bundle.hpp"
#include "tests/bench/concealment/true_world.hpp"

namespace repose::concealment {

/// nominal   nothing is concealed
/// C0        one effect, its name withheld
/// C1        one effect, and a constant that nobody measured set so that the headline agrees all the same
/// C2        one effect that acts in one phase only
/// C3        two effects that partly cancel in the headline
/// C4        recorded by Bullet or DART; every other one with nothing concealed
/// unknown   a force that no effect of the library is: a gust, a field in a strip, a spring
const std::vector<std::string>& levels();

/// What recorded the bundle.
struct TrueWorld {
  Experiment experiment;
  std::string scene;                         ///< YAML, with its true constants and effects
  std::vector<std::vector<Override>> sets;   ///< of each run: how it really began
  Recorder recorder;
  Conditions conditions;
  TrueSensor sensor;
};

struct ConcealedCase {
  Bundle bundle;
  TrueWorld world;
  nlohmann::json truth;  ///< level, family, backend, effects [{effect, parameter, value, null, phase}], where {run: [[from, to]]},
                         ///< sensor, signal (rms against the nominal, in sigma)
};

/// The same level and seed give the same case. Throws Error if a hundred draws give none.
ConcealedCase make_case(const std::string& level, std::uint64_t seed);

}  // namespace repose::concealment
