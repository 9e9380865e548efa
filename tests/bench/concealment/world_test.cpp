#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/yaml_tree.hpp"
#include "tests/bench/concealment/true_world.hpp"

namespace repose::concealment {
namespace {

constexpr std::uint64_t draws = 3;
constexpr double finest = 0.05;         // of the scene's step
constexpr double of_the_noise = 0.2;    // rms: ten times what the worst of 42 runs of a family showed, and a fifth of what could be seen

std::vector<Observation> recorded(const Experiment& e, const std::string& scene, const PlannedRun& run, double step_factor) {
  Conditions conditions;
  conditions.step_factor = step_factor;
  return record(e, live(scene, run.set, e.body, conditions), {});
}

class World : public testing::TestWithParam<std::string> {};

/// A solver that loses a blow in ten, at some moments of its step only, passes every test of a single blow.
TEST_P(World, StepsOfTheSceneDoNotShowInTheReadings) {
  for (std::uint64_t k = 0; k < draws; ++k) {
    Random random(4711, k);
    const Experiment e = draw_experiment(GetParam(), random);
    YamlNode tree = parse_yaml(e.scene, "scene");
    for (const Override& o : e.constants) set_path(tree, o.path, o.value);
    const std::string scene = emit_yaml(tree);
    for (const PlannedRun& run : e.runs) {
      const std::vector<Observation> fine = recorded(e, scene, run, finest);
      EXPECT_LT(signal(recorded(e, scene, run, 1), fine, e.noise), of_the_noise) << "draw " << k << ", " << run.id;
      EXPECT_LT(signal(recorded(e, scene, run, 0.25), fine, e.noise), of_the_noise) << "a quarter of the step, draw " << k << ", " << run.id;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, World, testing::ValuesIn(families()), [](const auto& family) { return family.param; });

}  // namespace
}  // namespace repose::concealment
