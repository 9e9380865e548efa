/// repose study: a parameter sweep with replicates.
#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "analysis/heap_measurement.hpp"
#include "backends/backends.hpp"
#include "core/error.hpp"
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

// Every point's scene, checked as `repose check` would. Warnings that several points share are told once.
std::vector<Scene> scenes_of(const StudyPlan& plan, const Options& options) {
  std::vector<Scene> scenes;
  for (const StudyPoint& point : plan.points) {
    Options own = options;
    own.threads = 1;
    own.seed = plan.first_seed;
    own.overrides = point.set;
    Prepared prepared = prepare(point.scene, own);
    if (!heap_site(prepared.scene))
      throw Error(point.scene.string() + ": tools", "the scene has no base to measure a heap on", "add a tool of kind base");
    scenes.push_back(std::move(prepared.scene));
  }
  return scenes;
}

// One number per observable; what could not be measured is null.
json observables_of(const Model& model, const RunReport& run, const HeapMeasurement& heap) {
  const HeapGrains& grains = heap.repose.grains;
  const double count = static_cast<double>(model.grain_count());
  json o = {{"grains_on_base", grains.heap.size()},
            {"heap_mass", grains.heap_mass},
            {"coverage", heap.repose.profile.coverage},
            {"at_rest", heap.rest.at_rest ? 1 : 0},
            {"time_at_end", run.final_state.time},
            {"converged_fraction", run.converged_fraction},
            {"cycling_fraction", run.cycling_fraction},
            {"iterations_mean", run.iterations_mean},
            {"residual_max", run.residual_max},
            {"contacts_per_grain", count > 0 ? run.contacts_mean / count : 0},
            {"penetration_diameters", grains.diameter > 0 ? run.max_penetration / grains.diameter : 0},
            {"wall_s", run.wall_s}};
  const auto optional = [&](const char* name, bool there, double value) { o[name] = there ? json(value) : json(nullptr); };
  const ReposeAngle angle = heap.repose.angle.value_or(ReposeAngle{});
  const bool has_angle = heap.repose.angle.has_value();
  optional("angle_of_repose", has_angle, angle.value);
  optional("sd_azimuth", has_angle, angle.sd);
  optional("angle_radial", has_angle, angle.radial);
  optional("angle_whole_depth", has_angle, angle.whole_depth);
  optional("concavity", has_angle, angle.concavity);
  optional("apex_diameters", has_angle && grains.diameter > 0, angle.apex / grains.diameter);
  optional("solid_fraction", heap.solid.has_value(), heap.solid ? heap.solid->value : 0);
  optional("discharge_rate", heap.rate.has_value(), heap.rate ? heap.rate->rate : 0);
  optional("discharge_over_beverloo", heap.rate && heap.beverloo && *heap.beverloo > 0,
           heap.rate && heap.beverloo ? heap.rate->rate / *heap.beverloo : 0);
  return o;
}

std::optional<json> pour(const Backend& backend, const Scene& scene, std::uint64_t seed) {
  const Model model = realise(scene, seed);
  const std::unique_ptr<World> world = backend.make(model, scene.solver);
  const std::optional<HeapSite> site = heap_site(scene);
  const std::optional<Outlet> outlet = funnel_outlet(scene);
  DischargeCurve discharge;
  if (outlet) discharge.add(model, model.initial, *outlet);
  Snapshot before = model.initial, latest = model.initial;
  RunHooks hooks;
  hooks.interrupted = interrupted;
  hooks.finished = [&](const Snapshot& state, const StepReport&) {
    if (outlet) discharge.add(model, state, *outlet);
    before = std::exchange(latest, state);
    return assess_rest(model, state, *site, outlet).at_rest;
  };
  const Schedule schedule{scene.solver.time_step, scene.duration, scene.frame_interval, 1e9};
  const RunReport report = run(*world, model, schedule, nullptr, hooks);
  if (report.end == RunReport::End::interrupted) return std::nullopt;
  return observables_of(model, report, measure_heap(scene, model, report.final_state, &before, std::move(discharge)));
}

std::map<std::string, ReferenceSet> references_of(const StudyPlan& plan) {
  std::map<std::string, ReferenceSet> references;
  for (const StudySeries& s : plan.series)
    if (!s.reference.empty() && !references.contains(s.reference)) references[s.reference] = load_reference(reference_file(s.reference));
  return references;
}

void tell(const json& study, const Options& options) {
  fmt::print("{:<28} {:<34} {:>8} {:>7} {:>10} {:>8} {:>4}\n", "series", "point", "angle", "se", "sd azimuth", "sd seed", "n");
  for (const json& point : study["points"]) {
    const auto series = point["series"].get<std::string>(), label = point["label"].get<std::string>();
    if (!point["observables"].contains("angle_of_repose")) {
      fmt::print("{:<28} {:<34} no angle\n", series, label);
      continue;
    }
    const json& a = point["observables"]["angle_of_repose"];
    const auto number = [&](const char* key) { return a[key].is_number() ? fmt::format("{:.2f}", a[key].get<double>()) : std::string("-"); };
    fmt::print("{:<28} {:<34} {:>8} {:>7} {:>10} {:>8} {:>4}\n", series, label, number("mean"), number("se"), number("sd_azimuth"),
               number("sd_seed"), a["n"].get<int>());
  }
  for (const json& series : study["series"]) {
    if (!series.contains("slope")) continue;
    fmt::print("slope of {}: {:.1f} +- {:.1f} deg", series["name"].get<std::string>(), series["slope"]["value"].get<double>(), series["slope"]["se"].get<double>());
    if (series.contains("reference") && series["reference"].contains("slope"))
      fmt::print("; published {:.1f} +- {:.1f}", series["reference"]["slope"]["value"].get<double>(),
                 series["reference"]["slope"]["se"].get<double>());
    fmt::print("\n");
  }
  for (const auto& [what, file] : {std::pair{"report", "report.html"}, {"result", "study.json"}})
    fmt::print("{:<9}{}\n", what, (options.out / file).string());
}

int study(const Options& options) {
  StudyPlan plan = load_study(options.file.empty() ? config_file("study_table2.yaml") : options.file);
  for (StudyPoint& point : plan.points) point.set.insert(point.set.end(), options.overrides.begin(), options.overrides.end());
  const std::map<std::string, ReferenceSet> references = references_of(plan);
  const Backend& backend = find_backend(options.backend);
  const std::vector<Scene> scenes = scenes_of(plan, options);
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
    report = run_jobs(jobs, options.out, options.threads, [&](const Job& job) { return pour(backend, scenes[job.scene], job.seed); }, hooks);
  }
  if (interrupted() && report.progress.done < report.progress.total) {
    fmt::print(stderr, "interrupted after {} of {} runs; the same command goes on from here\n", report.progress.done, report.progress.total);
    return exit_status::interrupted;
  }
  json result = summarise_study(plan, jobs, report, references);
  result["scenario"] = "study";
  result["backend"] = options.backend;
  result["seed"] = options.seed;
  result["wall_s"] = report.progress.wall_s;
  result["version"] = version();
  result["commit"] = commit();
  const auto measured = load_reference(reference_file("pa650/table1.yaml")).single("angle_of_repose");
  const auto solid = load_reference(reference_file("pa650/powder.yaml")).single("solid_fraction");
  if (measured) result["measured"] = {{"value", measured->value}, {"uncertainty", measured->uncertainty.value_or(0)}, {"unit", measured->unit}};
  write_atomically(options.out / "report.html", report::to_html(study_report(plan, result, references, measured, solid)));
  write_result(options.out / "study.json", result.dump(2));
  tell(result, options);
  for (const auto& r : report.results)
    if (r && !r->failure.empty()) fmt::print(stderr, "a run failed: {}\n", r->failure);
  return report.progress.failed > 0 ? exit_status::simulation : exit_status::done;
}

}  // namespace

int main(int argc, char** argv) {
  CommandInfo info;
  info.name = "study";
  info.summary =
      "Runs a scene at many points of its parameters with several seeds each and compares the angle of repose with published values; "
      "default: Table 2 of the source study. Finished runs are kept in OUT/jobs and used again; --threads runs go side by side.";
  info.example = "repose study --threads 2\n  repose study my_study.yaml --out out/my_study --set grains.powder.count=1000";
  info.file = "STUDY.yaml";
  return run_command(argc, argv, info, study);
}
