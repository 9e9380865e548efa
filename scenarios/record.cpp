/// repose record SCENE.yaml: a simulated run as a recording bundle.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <mutex>
#include <numeric>

#include "analysis/bundle/read_bundle.hpp"
#include "analysis/bundle/write_bundle.hpp"
#include "analysis/heap_measurement.hpp"
#include "analysis/side_by_side.hpp"
#include "core/error.hpp"
#include "core/yaml_tree.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/layer_observations.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/record_block.hpp"
#include "scenarios/simulate.hpp"

namespace {

using namespace repose;

constexpr double told_after = 2;  // [s]
using TellProgress = std::function<void(const Progress&)>;

/// Profile and angle of the heap that a run left.
void measure_heap_into(const Prepared& prepared, const HistoryRun& run, Observation& o) {
  const HeapMeasurement heap = measure_heap(prepared.scene, run.model, run.final_state, nullptr, {});
  if (o.name == "heap") {
    o.at = heap.repose.profile.radius;
    o.value = heap.repose.profile.height;
  } else {
    if (!heap.repose.angle)
      throw Error("record.observables", "the heap has no angle of repose", "simulate longer, or with more grains");
    o.scalar = heap.repose.angle->value;
    o.sd = heap.repose.angle->se;  // of the value, not the scatter of its flanks
  }
}

/// A recording stands for the world, not for a step: few bodies are solved to second order where the backend can, unless the scene
/// names its integration.
void solve_closely(Prepared& prepared) {
  if (prepared.model.grain_count() > 0 || !prepared.backend->has_second_order) return;
  if (node_at(parse_yaml(prepared.scene.text, "scene"), "solver.integration") != nullptr) return;
  prepared.scene.solver.integration = Integration::second_order;
}

/// Everything that was asked for of a layer.
std::vector<Observation> observe_layer(const SpreadLayer& layer, const RecordBlock& block) {
  const History loads = loads_on_spreader(layer);
  std::vector<Observation> result;
  for (Observation o : block.observables) {
    if (o.kind == ObservableKind::surface)
      o = surface_of(layer, o.name, std::numeric_limits<std::size_t>::max());
    else
      observe(loads, sample_times(block.sensor.rate, loads.time.back()), o);
    result.push_back(std::move(o));
  }
  return result;
}

/// A recorded run, and whether the steps behind it converged.
struct Recorded {
  BundleRun run;
  bool converged = true;
};

/// Everything that was asked for of any other scene.
std::vector<Observation> observe_run(const Prepared& prepared, const RecordBlock& block, const Options& options, std::uint64_t seed,
                                     const TellProgress& progress, bool& converged) {
  SimulationRequest request;
  request.scene = &prepared.scene;
  request.seed = seed;
  for (const Observation& o : block.observables)
    if (o.kind == ObservableKind::series && o.body.empty()) request.series.push_back(o.name);
  const HistoryRun made = run_history(*prepared.backend, request, options.allow_unsupported, progress);
  converged = made.history.converged;
  const std::vector<double> times = sample_times(block.sensor.rate, prepared.scene.duration);
  std::vector<Observation> result;
  for (Observation o : block.observables) {
    if (o.kind == ObservableKind::trajectory || o.kind == ObservableKind::series)
      observe(made.history, times, o);
    else
      measure_heap_into(prepared, made, o);
    result.push_back(std::move(o));
  }
  return result;
}

Recorded record_run(const Scene& scene, const Prepared& prepared, const RecordBlock& block, const RecordedRun& wanted,
                    const Options& options, std::uint64_t seed, const TellProgress& progress) {
  Recorded recorded;
  BundleRun& run = recorded.run;
  run.id = wanted.id;
  run.set = wanted.set;
  run.free = block.free;
  if (scene.layer) {
    const std::optional<SpreadLayer> layer = LayerRuns(options, LayerRuns::Beds::dropped).run(scene, seed);
    if (!layer) throw Error("", "interrupted", "", Error::Kind::simulation);
    if (!layer->bed->at_rest || !layer->measured.at_rest)
      fmt::print(stderr, "warning: run {}: the grains were not at rest when their surface was measured\n  make {} longer\n", run.id,
                 layer->bed->at_rest ? "layer.rest" : "layer.settle");
    recorded.converged = layer->converged();
    run.observations = observe_layer(*layer, block);
  } else {
    run.observations = observe_run(prepared, block, options, seed, progress, recorded.converged);
  }
  for (std::size_t i = 0; i < run.observations.size(); ++i) {
    Observation& o = run.observations[i];
    Random random(options.seed, 1000 * seed + i);
    disturb(block.sensor, random, o);
    if (o.kind != ObservableKind::scalar) o.file = file_name(run.id, o, block.observables);
  }
  return recorded;
}

/// How far all runs are, which several threads tell.
class RecordingProgress {
 public:
  RecordingProgress(const Options& options, std::size_t runs) : display_(options.quiet), share_(runs, 0.0) {}

  void tell(std::size_t run, double share, const std::string& text) {
    const std::lock_guard lock(mutex_);
    share_[run] = share;
    const double all = static_cast<double>(share_.size()), done = std::accumulate(share_.begin(), share_.end(), 0.0);
    const double so_far = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
    if (so_far > told_after) display_.show(done, all, done > 0 ? so_far * (all / done - 1) : 0, text);
  }

 private:
  std::mutex mutex_;
  ProgressDisplay display_;
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  std::vector<double> share_;  ///< done of each run
};

/// Runs side by side: each has the threads that are left for it.
std::vector<Recorded> record_runs(const RecordBlock& block, const Options& options) {
  const std::size_t count = block.runs.size();
  const int at_once = std::clamp(static_cast<int>(count), 1, options.threads);
  Options of_one = options;
  of_one.threads = options.threads / at_once;
  RecordingProgress progress(options, count);
  std::vector<Recorded> recorded(count);
  side_by_side(count, at_once, [&](std::size_t i) {
    std::vector<Override> changes = options.overrides;
    changes.insert(changes.end(), block.conceal.begin(), block.conceal.end());
    changes.insert(changes.end(), block.runs[i].set.begin(), block.runs[i].set.end());
    const Scene scene = load_scene(options.file, changes);
    // Where the scene puts a spreader holds for `repose run` alone.
    Prepared prepared = scene.layer ? prepare_bed(scene, of_one) : prepare_quietly(scene, of_one);
    if (i == 0) tell(prepared.findings);  // the runs differ in little
    solve_closely(prepared);
    const std::string text = "recording " + block.runs[i].id;
    progress.tell(i, 0, text);
    recorded[i] = record_run(scene, prepared, block, block.runs[i], of_one, options.seed + i, [&](const Progress& now) {
      progress.tell(i, static_cast<double>(now.step) / static_cast<double>(std::max<std::int64_t>(1, now.steps)), text);
    });
    progress.tell(i, 1, text);
  });
  return recorded;
}

int record(const Options& options) {
  const Scene nominal = load_scene(options.file, options.overrides);
  const RecordBlock block = read_record_block(nominal, options.file.string());
  Bundle bundle;
  bundle.title = fmt::format("Simulated: {}", options.file.filename().string());
  bundle.source = fmt::format("repose record, backend {}, seed {}", options.backend, options.seed);
  bundle.scene = nominal;
  bundle.scene.text = block.scene_without_record;
  bundle.calibrate = block.calibrate;
  for (const auto& [name, sd] : block.sensor.noise)
    if (sd > 0) bundle.noise[name] = sd;
  std::vector<std::string> rough;
  try {
    for (Recorded& recorded : record_runs(block, options)) {
      if (!recorded.converged) rough.push_back(recorded.run.id);
      bundle.runs.push_back(std::move(recorded.run));
    }
  } catch (const Error&) {
    if (!interrupted()) throw;
    fmt::print(stderr, "interrupted: a bundle is written when all its runs are there; nothing was\n");
    return exit_status::interrupted;
  }
  write_bundle(options.out, bundle);
  fmt::print("{} run{} of {} observable{}\n{}\n", bundle.runs.size(), bundle.runs.size() == 1 ? "" : "s",
             block.observables.size(), block.observables.size() == 1 ? "" : "s",
             (options.out / "recording.yaml").string());
  if (rough.empty()) return exit_status::done;
  fmt::print(stderr, "repose record: fewer than {:.0f} % of the steps converged in {}: what was recorded is not what the scene says\n  use a smaller solver.time_step, or more "
             "solver.max_iterations\n", 100 * least_converged, fmt::join(rough, ", "));
  return exit_status::simulation;
}

}  // namespace

int main(int argc, char** argv) {
  CommandInfo info;
  info.name = "record";
  info.summary =
      "Simulates a scene and writes what sensors would have seen of it, as a recording bundle: recording.yaml, "
      "nominal.yaml and CSV "
      "files. The scene's `record` block says what, how often and how well.";
  info.example = "repose record scenarios/configs/bouncing_balls.yaml --out out/balls";
  info.file = "SCENE.yaml";
  info.file_required = true;
  return run_command(argc, argv, info, record);
}
