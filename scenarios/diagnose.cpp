/// repose diagnose BUNDLE: where simulation and recordings differ, what physics was left out, and whether it helps.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>

#include "analysis/bundle/read_bundle.hpp"
#include "analysis/diagnosis/bulk_diagnose.hpp"
#include "analysis/diagnosis/diagnose.hpp"
#include "backends/backends.hpp"
#include "core/effect_library.hpp"
#include "core/error.hpp"
#include "core/recording.hpp"
#include "core/yaml_reader.hpp"
#include "scenarios/bulk_diagnosis_json.hpp"
#include "scenarios/bulk_diagnosis_report.hpp"
#include "scenarios/bulk_simulation.hpp"
#include "scenarios/command_line.hpp"
#include "scenarios/diagnosis_json.hpp"
#include "scenarios/diagnosis_progress.hpp"
#include "scenarios/diagnosis_report.hpp"
#include "scenarios/history.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/simulate.hpp"
#include "scenarios/version.hpp"

namespace {

using namespace repose;

struct Own {
  std::string root;
  std::vector<std::string> candidates;
  int runs = 8, held_out = 8, replicas = 499, bootstrap = 0;
  bool one_engine = false;
};

/// As the report shows them. Of many grains every run counts.
std::vector<std::pair<std::string, std::string>> settings_of(const Options& options, const Own& own, bool bulk) {
  std::vector<std::pair<std::string, std::string>> list = {{"bundle", options.file.string()}, {"backend", options.backend}, {"seed", std::to_string(options.seed)}};
  if (!bulk) {
    list.emplace_back("runs fitted, at most", std::to_string(own.runs));
    list.emplace_back("held-out runs, at most", std::to_string(own.held_out));
  }
  list.emplace_back("version", fmt::format("{} ({})", version(), commit()));
  if (!own.candidates.empty()) list.emplace_back("candidates", fmt::format("{}", fmt::join(own.candidates, ", ")));
  if (own.one_engine) list.emplace_back("other engines", "not asked");
  for (const Override& o : options.overrides) list.emplace_back("--set " + o.path, o.value);
  return list;
}

/// The command that goes on after an interruption.
std::string same_command(const Options& options, const Own& own) {
  const Own usual;
  std::string text = fmt::format("repose diagnose '{}' --out '{}' --seed {}", options.file.string(), options.out.string(), options.seed);
  if (options.backend != Options{}.backend) text += " --backend " + options.backend;
  if (!own.root.empty()) text += " --root '" + own.root + "'";
  if (own.runs != usual.runs) text += fmt::format(" --runs {}", own.runs);
  if (own.held_out != usual.held_out) text += fmt::format(" --held-out-runs {}", own.held_out);
  if (!own.candidates.empty()) text += fmt::format(" --candidates {}", fmt::join(own.candidates, ","));
  if (own.bootstrap != usual.bootstrap) text += fmt::format(" --bootstrap {}", own.bootstrap);
  if (own.one_engine) text += " --one-engine";
  if (own.replicas != usual.replicas) text += fmt::format(" --replicas {}", own.replicas);
  if (options.allow_unsupported) text += " --allow-unsupported";
  if (options.force) text += " --force";
  for (const Override& o : options.overrides) text += fmt::format(" --set '{}={}'", o.path, o.value);
  return text;
}

/// Refuses names that the library does not have.
CLI::Validator known_effect() {
  return CLI::Validator(
      [](const std::string& name) {
        std::vector<std::string> names;
        for (const EffectRow& row : effect_library()) names.push_back(row.name);
        if (find_effect(name) != nullptr) return std::string();
        const Suggestion suggestion = suggest("no such effect:", name, names);
        return suggestion.problem + "\n  " + suggestion.remedy;
      },
      "");
}

/// Writes what every diagnosis leaves, diagnosis.json last of all, and tells it. `simulations`: so far.
int finish(const Options& options, const Own& own, nlohmann::json result, const std::string& extended_scene, const report::Report& page, bool complete, double wall_s,
           std::size_t simulations, ProgressDisplay& display) {
  result["scenario"] = "diagnose";
  result["backend"] = options.backend;
  result["seed"] = options.seed;
  result["wall_s"] = wall_s;
  result["version"] = version();
  result["commit"] = commit();
  result["complete"] = complete;
  write_atomically(options.out / "extended.yaml", extended_scene);
  write_atomically(options.out / "report.html", report::to_html(page));
  if (!complete) {
    write_atomically(options.out / "partial.json", result.dump(2));
    display.message(fmt::format("interrupted after {} simulations: what was found so far is in {} and report.html", simulations,
                                (options.out / "partial.json").string()));
    display.message("to go on: the same command again, " + same_command(options, own));
    return exit_status::interrupted;
  }
  write_atomically(options.out / "diagnosis.json", result.dump(2));
  fmt::print("{}\n\nverdict  {}\n", result["headline"].get<std::string>(), result["verdict"].get<std::string>());
  for (const auto& r : result["ranked"])
    fmt::print("  {:5.1f} %  {}\n", 100 * r["probability"].get<double>(),
               r["effects"].empty() ? "nothing missing" : fmt::format("{}", fmt::join(r["effects"].get<std::vector<std::string>>(), " + ")));
  for (const auto& [what, file] : {std::pair{"report", "report.html"}, {"scene", "extended.yaml"}, {"result", "diagnosis.json"}})
    fmt::print("{:<9}{}\n", what, (options.out / file).string());
  return exit_status::done;
}

double seconds_since(std::chrono::steady_clock::time_point begun) { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count(); }

/// Recordings of many grains. Simulations that an earlier call made are used again.
int run_bulk(const Options& options, const Own& own, const Bundle& bundle, ProgressDisplay& display) {
  BulkSimulation how;
  how.folder = options.out;
  how.workers = options.threads;
  how.allow_unsupported = options.allow_unsupported;
  how.progress = [&](const std::string& stage, const JobsProgress& p) {
    display.show(static_cast<double>(p.done), static_cast<double>(p.total), p.remaining_s, fmt::format("{}: {} of {} runs ({} reused)", stage, p.done, p.total, p.reused));
  };
  if (own.runs != Own{}.runs || own.held_out != Own{}.held_out || own.replicas != Own{}.replicas || own.bootstrap != Own{}.bootstrap || !bundle.noise.empty())
    display.message("warning: of recordings of many grains, noise, --runs, --held-out-runs, --replicas and --bootstrap say nothing: scatter is that of seeds");
  diagnosis::BulkOptions what;
  what.seed = options.seed;
  what.effects = own.candidates;
  if (!own.one_engine) what.other_backends = backends_beside(find_backend(options.backend), realise(bundle.scene, 1).grain_count());
  const auto begun = std::chrono::steady_clock::now();
  const diagnosis::BulkDiagnosis found = diagnosis::diagnose_bulk(bundle, simulate_bulk_with(find_backend(options.backend), bundle, how), what);
  if (found.models.empty()) {
    display.message("interrupted before the nominal scene was simulated; the same command goes on from here");
    return exit_status::interrupted;
  }
  return finish(options, own, bulk_diagnosis_json(found, bundle), found.extended_scene, bulk_diagnosis_report(found, bundle, settings_of(options, own, true)), !found.interrupted, seconds_since(begun),
                found.simulations, display);
}

/// As every run of a simulation begins. What is doubtful joins the bundle's own doubts.
void check_plausibility_of(Bundle& bundle, const Options& options) {
  Options how = options;
  how.allow_unsupported = true;  // what the backend lacks is told by the first simulation
  if (bundle.scene.layer || bundle.runs.empty()) return;  // its bed decides where the spreader and the grains are
  // As the first run has it: what all runs set anew stands in the scene for nothing.
  const Scene first = parse_scene(bundle.scene.text, bundle.scene_file.string(), bundle.runs.front().set, bundle.scene_file.parent_path());
  for (const Finding& finding : prepare_quietly(first, how).findings) bundle.warnings.push_back(fmt::format("nominal scene: {}: {}", finding.place, finding.message));
}

int run(const Options& options, const Own& own) {
  Bundle bundle = read_bundle(options.file, own.root, options.overrides);
  check_plausibility_of(bundle, options);
  std::error_code ignored;
  std::filesystem::create_directories(options.out, ignored);
  for (const char* old : {"diagnosis.json", "partial.json"}) std::filesystem::remove(options.out / old, ignored);
  ProgressDisplay display(options.quiet);
  for (const std::string& warning : bundle.warnings) display.message("warning: " + warning);

  if (diagnosis::is_bulk(bundle)) return run_bulk(options, own, only_simulated(bundle), display);

  diagnosis::DiagnoseOptions how;
  how.threads = options.threads;
  how.seed = options.seed;
  how.max_train_runs = own.runs;
  how.max_held_out_runs = own.held_out;
  how.replicas = own.replicas;
  how.candidates = own.candidates;
  if (!own.one_engine) how.other_backends = backends_beside(find_backend(options.backend));
  how.bootstrap = own.bootstrap;
  // Simulations are kept for the next diagnosis by the same build; a build with uncommitted changes has no name.
  const std::string build = commit();
  const bool named = build != "unknown" && !build.ends_with("-dirty");
  diagnosis::SimulationStore store(named ? options.out / "simulations.cache" : "", fmt::format("{} {} {}{}", options.backend, version(), build, options.allow_unsupported ? " without what it lacks" : ""));
  how.store = &store;
  how.interrupted = interrupted;
  const auto begun = std::chrono::steady_clock::now();
  DiagnosisProgress progress;
  std::atomic<std::size_t> simulations{0};
  how.progress = [&](const std::string& stage, double done, double total) {
    const double spent = seconds_since(begun), share = progress.share(stage, done, total);
    display.show(share, 1, progress.left(spent), fmt::format("{} ({} simulations)", stage, simulations.load()));
  };
  const Simulate simulate = simulate_with(find_backend(options.backend), options.allow_unsupported);
  const Simulate counted = [&](const SimulationRequest& request) {
    ++simulations;
    return simulate(request);
  };
  const auto found_before_the_end = [&]() -> std::optional<diagnosis::Diagnosis> {
    try {
      return diagnosis::diagnose(bundle, counted, how);
    } catch (const Error&) {
      if (!interrupted()) throw;
      return std::nullopt;
    }
  }();
  store.save();
  if (!found_before_the_end) {
    display.message("interrupted before the nominal scene was fitted; the same command goes on from here");
    return exit_status::interrupted;
  }
  const diagnosis::Diagnosis& found = *found_before_the_end;
  return finish(options, own, diagnosis_json(found), found.extended_scene, diagnosis_report(found, bundle, settings_of(options, own, false)), !found.interrupted, seconds_since(begun),
                simulations, display);
}

}  // namespace

int main(int argc, char** argv) {
  CommandInfo info;
  info.name = "diagnose";
  info.summary =
      "Compares recordings with the scene that should explain them: locates the mismatch, names the physics that was left out, models it, and shows the fit on "
      "recordings that were not used.";
  info.example = "repose record scenarios/configs/concealed_roll.yaml --out out/rolls\n  repose diagnose out/rolls";
  info.file = "BUNDLE";
  info.file_required = true;
  Own own;
  return run_command(argc, argv, info, [&](const Options& options) { return run(options, own); }, [&](CLI::App& app) {
    app.add_option("--root", own.root, "where the CSV files lie (default: beside recording.yaml)")->type_name("DIR");
    app.add_option("--runs", own.runs, "at most so many runs are fitted (default 8)")->type_name("N")->check(CLI::Range(1, 10000));
    app.add_option("--held-out-runs", own.held_out, "at most so many held-out runs are judged (default 8)")->type_name("N")->check(CLI::Range(1, 10000));
    app.add_option("--candidates", own.candidates, "only these effects are tried, parted by commas (default: the whole library; many grains: the likeliest eight)")
        ->type_name("NAMES")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(known_effect());
    app.add_option("--bootstrap", own.bootstrap, "so many recordings are simulated from the nominal fit and diagnosed anew, for its lack of fit (default 0: noise alone)")
        ->type_name("N")
        ->check(CLI::Range(0, 0) | CLI::Range(99, 100000));  // fewer could never reach the level of 1 %
    app.add_flag("--one-engine", own.one_engine, "do not ask whether another engine made the recordings");
    // Two tests share the level, so that the least p is 2 / (N + 1).
    app.add_option("--replicas", own.replicas, "of noise, for p values; fewer than 199 could not show a lack of fit at 1 % (default 499)")
        ->type_name("N")
        ->check(CLI::Range(199, 100000));
  });
}
