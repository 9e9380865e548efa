#pragma once
/// What `repose check` prints and every run starts with: is this scene something that grains can do?
#include <cstdint>
#include <string>
#include <vector>

#include "core/scene.hpp"

namespace repose {

struct Finding {
  enum class Level { note, warning, refusal } level = Level::note;
  std::string place;    ///< scene key
  std::string message;  ///< what was found, against what is usual
  std::string remedy;   ///< the likely intention ("did you mean 2.5 g/cm3?"); empty for a note
};

/// Densities, sizes, speeds, step against size and speed, Bond and inertial numbers, overlaps, count, memory and expected
/// time. `model` is the realised scene; nullptr where the count alone is already absurd. Includes check_before_realising.
std::vector<Finding> check_plausibility(const Scene& scene, const Model* model);

/// The checks that need no model, to be made before grains are drawn (a count of 1e9 must not be realised first).
std::vector<Finding> check_before_realising(const Scene& scene);

}  // namespace repose
