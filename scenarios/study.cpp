/// repose study: a parameter sweep with replicates.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/atomic_file.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/experiment.hpp"
#include "scenarios/installation.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/reference_file.hpp"
#include "scenarios/simulate.hpp"
#include "scenarios/jobs.hpp"
#include "scenarios/study_plan.hpp"
#include "scenarios/study_report.hpp"
#include "scenarios/study_summary.hpp"
#include "scenarios/version.hpp"

namespace {

using namespace repose;
using nlohmann::json;

std::unique_ptr<Experiment> experiment_of(const StudyPlan& plan, const Options& options) {
  Options own = options;
  own.threads = 1;
  own.seed = plan.first_seed;
  const StudyPoint& first = plan.points.front();
  return load_scene(first.scene, first.set).layer ? layer_experiment(own) : heap_experiment(own);
}

// Every point's scene, checked as `repose check` would.
std::vector<Scene> scenes_of(const StudyPlan& plan, const Experiment& experiment) {
  std::vector<Scene> scenes;
  for (const StudyPoint& point : plan.points) {
    scenes.push_back(load_scene(point.scene, point.set));
    scenes.back().solver.threads = 1;
    experiment.check(scenes.back(), point.scene.string());
  }
  return scenes;
}

std::map<std::string, ReferenceSet> references_of(const StudyPlan& plan) {
  std::map<std::string, ReferenceSet> references;
  for (const StudySeries& s : plan.series)
    if (!s.reference.empty() && !references.contains(s.reference)) references[s.reference] = load_reference(reference_file(s.reference));
  return references;
}

void tell(const json& study, const Experiment& experiment, const Options& options) {
  const ToldObservable& principal = experiment.told().front();
  fmt::print("{}{}\n", principal.label, principal.unit.empty() ? "" : " [" + principal.unit + "]");
  fmt::print("{:<28} {:<34} {:>8} {:>7} {:>10} {:>8} {:>4}\n", "series", "point", "mean", "se", "sd within", "sd seed", "n");
  for (const json& point : study["points"]) {
    const auto series = point["series"].get<std::string>(), label = point["label"].get<std::string>();
    if (!point["observables"].contains(principal.name)) {
      fmt::print("{:<28} {:<34} not measured\n", series, label);
      continue;
    }
    const json& a = point["observables"][principal.name];
    const auto number = [&](const std::string& key) {
      return a.contains(key) && a[key].is_number() ? fmt::format("{:.2f}", principal.factor * a[key].get<double>()) : std::string("-");
    };
    fmt::print("{:<28} {:<34} {:>8} {:>7} {:>10} {:>8} {:>4}\n", series, label, number("mean"), number("se"), number(experiment.scatter_within()),
               number("sd_seed"), a["n"].get<int>());
  }
  for (const json& series : study["series"]) {
    if (!series.contains("slope")) continue;
    const auto told = [&](const json& slope) {
      return fmt::format("{:.3g} +- {:.2g}", principal.factor * slope["value"].get<double>(), principal.factor * slope["se"].get<double>());
    };
    const auto per = series["x_unit"].get<std::string>();
    fmt::print("slope of {}: {} {}{}", series["name"].get<std::string>(), told(series["slope"]), principal.unit, per.empty() ? "" : "/" + per);
    if (series.contains("reference") && series["reference"].contains("slope")) fmt::print("; published {}", told(series["reference"]["slope"]));
    fmt::print("\n");
  }
  for (const auto& [what, file] : {std::pair{"report", "report.html"}, {"result", "study.json"}})
    fmt::print("{:<9}{}\n", what, (options.out / file).string());
}

int study(const Options& options) {
  StudyPlan plan = load_study(options.file.empty() ? config_file("study_table2.yaml") : options.file);
  for (StudyPoint& point : plan.points) point.set.insert(point.set.end(), options.overrides.begin(), options.overrides.end());
  const std::map<std::string, ReferenceSet> references = references_of(plan);
  const std::unique_ptr<Experiment> experiment = experiment_of(plan, options);
  const std::vector<Scene> scenes = scenes_of(plan, *experiment);
  std::vector<Job> jobs;
  const std::string build = std::string(version()) + " " + commit();
  for (std::size_t p = 0; p < plan.points.size(); ++p)
    for (int s = 0; s < plan.points[p].seeds; ++s) {
      // --seed moves the first seed of the plan: 1, the default, leaves it.
      const std::uint64_t seed = plan.first_seed + options.seed - 1 + static_cast<std::uint64_t>(s);
      jobs.push_back({p, seed, job_key(scenes[p].text, seed, options.backend, build)});
    }
  std::error_code ignored;
  std::filesystem::remove(options.out / "study.json", ignored);

  JobsReport report;
  {
    ProgressDisplay display(options.quiet);
    JobsHooks hooks;
    hooks.interrupted = interrupted;
    hooks.progress = [&](const JobsProgress& p) {
      display.show(static_cast<double>(p.done), static_cast<double>(p.total), p.remaining_s,
                   fmt::format("{} of {} runs ({} reused, {} failed)", p.done, p.total, p.reused, p.failed));
    };
    report = run_jobs(jobs, options.out, options.threads, [&](const Job& job) { return experiment->run(scenes[job.scene], job.seed); }, hooks);
  }
  if (interrupted() && report.progress.done < report.progress.total) {
    fmt::print(stderr, "interrupted after {} of {} runs; the same command goes on from here\n", report.progress.done, report.progress.total);
    return exit_status::interrupted;
  }
  json result = summarise_study(plan, jobs, report, references, {experiment->told().front().name, experiment->scatter_within()});
  result["scenario"] = "study";
  result["backend"] = options.backend;
  result["seed"] = options.seed;
  result["wall_s"] = report.progress.wall_s;
  result["version"] = version();
  result["commit"] = commit();
  for (const auto& [name, value] : experiment->measured())
    result["measured"][name] = {{"value", value.value}, {"uncertainty", value.uncertainty.value_or(0)}, {"unit", value.unit}};
  write_atomically(options.out / "report.html", report::to_html(study_report(plan, result, references, *experiment)));
  write_result(options.out / "study.json", result.dump(2));
  tell(result, *experiment, options);
  std::size_t moving = 0;
  for (const json& point : result["points"]) moving += point["not_at_rest"].get<std::size_t>();
  if (moving > 0) fmt::print(stderr, "warning: {} of the {} were not at rest where they are measured; simulate longer\n", moving, experiment->called());
  for (const auto& r : report.results)
    if (r && !r->failure.empty()) fmt::print(stderr, "a run failed: {}\n", r->failure);
  return report.progress.failed > 0 ? exit_status::simulation : exit_status::done;
}

}  // namespace

int main(int argc, char** argv) {
  CommandInfo info;
  info.name = "study";
  info.summary =
      "Runs a scene at many points of its parameters with several seeds each: heaps (their angle of repose beside published values; "
      "default: Table 2 of the source study), or layers, if the scene has a `layer` block (roughness and packing). Finished runs are kept in OUT/jobs and used again; --threads runs go side by side.";
  info.example = "repose study --threads 2\n  repose study my_study.yaml --out out/my_study --set grains.powder.count=1000";
  info.file = "STUDY.yaml";
  return run_command(argc, argv, info, study);
}
