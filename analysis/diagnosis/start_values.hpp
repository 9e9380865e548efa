#pragma once
/// Where the bodies of a run begin, as its first samples show it.
#include <map>
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"
#include "analysis/diagnosis/hypothesis.hpp"
#include "core/yaml_tree.hpp"

namespace repose::diagnosis {

/// Start values of a run from its own first samples: position and orientation, velocity and spin, from a parabola through the first ten. Along an axis on
/// which the body never moves, from all samples, and then within narrow bounds. Only for the keys of `free` that can be seen; others start from `tree`, the scene with the
/// run's own settings. A spin that only its effect on the path shows begins as the scene has it. A key may name one component (`bodies.ball.velocity.2`), or
/// a positive number.
std::vector<Parameter> start_values(const BundleRun& run, const YamlNode& tree, const std::map<std::string, double>& noise);

/// A start velocity or spin that the samples and the scene contradict each other about.
struct StartContradiction {
  std::string key;
  Vec3 read, told;
};

/// Those that differ by more than half of the larger, and beyond doubt. A scene that says zero says nothing.
std::vector<StartContradiction> contradictions(const std::vector<Parameter>& start);

}  // namespace repose::diagnosis
