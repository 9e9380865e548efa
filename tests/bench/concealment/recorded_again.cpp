#include "tests/bench/concealment/recorded_again.hpp"

#include <numeric>

#include "analysis/diagnosis/problem.hpp"
#include "analysis/diagnosis/scene_values.hpp"
#include "backends/backends.hpp"
#include "core/scene_yaml.hpp"
#include "core/yaml_tree.hpp"
#include "scenarios/history.hpp"

namespace repose::concealment {
namespace {

using diagnosis::Problem;
using diagnosis::SetValues;

constexpr std::uint64_t noise_stream = 2000;  // none of those that drew the case

/// The bundle with starts that are known: nothing is fitted here.
Bundle begun_as_told(Bundle bundle, const std::string& scene) {
  bundle.scene = parse_scene(scene, "scene");
  bundle.calibrate.clear();
  for (BundleRun& run : bundle.runs) run.free.clear();
  return bundle;
}

std::vector<std::size_t> all_of(const Bundle& bundle) {
  std::vector<std::size_t> all(bundle.runs.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

/// The scene of each run with the change, and the keys that it sets.
struct ChangedRun {
  YamlNode scene;
  std::vector<Override> set;
};

std::vector<ChangedRun> changed_runs(const Bundle& bundle, const diagnosis::Change& change) {
  const Problem problem(bundle, all_of(bundle), simulate_with(find_backend("dvi"), false));
  const diagnosis::Layout layout = problem.layout({});
  std::vector<ChangedRun> runs;
  for (std::size_t i = 0; i < bundle.runs.size(); ++i) {
    const SetValues to = diagnosis::changed(problem, layout, diagnosis::Values(), i, change);
    ChangedRun run{problem.runs()[i].tree, bundle.runs[i].set};
    diagnosis::put_values(run.scene, to.parameters, Eigen::Map<const Eigen::VectorXd>(to.values.data(), static_cast<Eigen::Index>(to.values.size())));
    for (const diagnosis::Parameter& p : to.parameters) {
      std::erase_if(run.set, [&](const Override& o) { return o.path == p.key; });
      run.set.push_back({p.key, emit_yaml(*node_at(run.scene, p.key))});
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace

std::optional<diagnosis::Change> change_in_words(const Bundle& bundle, const std::string& what) {
  const Problem problem(bundle, all_of(bundle), simulate_with(find_backend("dvi"), false));
  for (const diagnosis::Change& change : diagnosis::changes_of(problem, diagnosis::start_of(problem, problem.layout({}), {})))
    if (change.words() == what) return change;
  return {};
}

Bundle recorded_again(const ConcealedCase& made, const diagnosis::Change& change, std::uint64_t seed) {
  const TrueWorld& world = made.world;
  Bundle real = begun_as_told(made.bundle, world.scene);
  for (std::size_t i = 0; i < real.runs.size(); ++i) real.runs[i].set = world.sets[i];
  const std::vector<ChangedRun> planned = changed_runs(begun_as_told(made.bundle, made.bundle.scene.text), change), lived = changed_runs(real, change);
  Bundle both = made.bundle;
  Random random(seed, noise_stream);
  for (std::size_t i = 0; i < planned.size(); ++i) {
    BundleRun run = made.bundle.runs[i];
    run.id += "-again";
    run.set = planned[i].set;
    run.observations = record(world.experiment, live(emit_yaml(lived[i].scene), {}, world.experiment.body, world.conditions), world.recorder);
    for (std::size_t k = 0; k < run.observations.size(); ++k) {
      disturb(world.sensor, world.experiment.noise, random, run.observations[k]);
      run.observations[k].file = run.id + "-" + std::to_string(k + 1) + ".csv";
    }
    both.runs.push_back(std::move(run));
  }
  return both;
}

}  // namespace repose::concealment
