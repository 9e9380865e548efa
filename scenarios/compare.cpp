/// repose compare: the same scene, seeds and grains on each backend; do they agree, and if not, where and why?
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <sstream>

#include "analysis/report/report.hpp"
#include "backends/backends.hpp"
#include "core/error.hpp"
#include "scenarios/compare_cost.hpp"
#include "scenarios/compare_report.hpp"
#include "scenarios/compare_summary.hpp"
#include "scenarios/compare_verdict.hpp"
#include "scenarios/installation.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/simulate.hpp"
#include "scenarios/version.hpp"

namespace {

using namespace repose;
using nlohmann::json;

constexpr const char* seven_shapes =
    "{sphere: 1, ellipsoid: 1, twin: 1, uneven_twin: 1, sphere_cone: 1, sphere_ellipsoid: 1, pierced_twin: 1}";

/// The command's own options.
struct Own {
  std::string backends;
  int seeds = 5;
  bool no_refine = false, cost = false;
  CostOptions costs;
};

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> names;
  std::stringstream text(list);
  for (std::string name; std::getline(text, name, ',');)
    if (!name.empty()) names.push_back(name);
  return names;
}

std::vector<Contender> contenders_of(const Own& own, std::size_t least) {
  std::vector<std::string> names = split(own.backends);
  if (own.backends.empty())
    for (const Backend& backend : backends()) names.push_back(backend.name);
  std::vector<Contender> list;
  for (const std::string& name : names) {
    Contender c{name, nullptr, {}};
    try {
      c.backend = &find_backend(name);
    } catch (const Error& unknown) {
      throw Error("--backends", unknown.problem(), unknown.remedy());
    }
    // The same backend again is a check of its reproducibility.
    const auto same = std::count_if(list.begin(), list.end(), [&](const Contender& other) { return other.backend == c.backend; });
    if (same > 0) c.label += fmt::format("-{}", same + 1);
    list.push_back(std::move(c));
  }
  if (list.size() < least) {
    std::string known;
    for (const Backend& backend : backends()) known += (known.empty() ? "" : ",") + backend.name;
    throw Error("--backends", fmt::format("{} cannot be compared with anything", list.empty() ? "nothing" : list.front().label),
                "name two or more, for example --backends " + known);
  }
  return list;
}

Prepared prepared_scene(Options& options) {
  options.allow_unsupported = true;  // asked for each backend below
  if (!options.file.empty()) return prepare(options.file, options);
  if (options.preset == "shapes") options.overrides.insert(options.overrides.begin(), {"grains.powder.mix", seven_shapes});
  return prepare(config_file("compare.yaml"), options);
}

Comparison planned(const Prepared& prepared, std::vector<Contender> contenders, const Options& options, const Own& own) {
  Comparison c;
  c.contenders = std::move(contenders);
  c.grains = prepared.model.grain_count();
  c.random = c.grains > 0;
  c.seeds = c.random ? static_cast<std::size_t>(own.seeds) : 1;
  c.tolerance = prepared.scene.solver.tolerance;
  c.frames = compare_frames(prepared.scene);
  if (c.random) c.grid = field_grid(prepared.scene, prepared.model);
  for (std::size_t k = 0; k < c.contenders.size(); ++k)
    for (Refinement how : refinements) {
      if (how != Refinement::none && own.no_refine) continue;
      if (how == Refinement::tenth_tolerance && !c.contenders[k].backend->has_tolerance) continue;
      CompareVariant v{k, how, prepared.scene};
      v.scene.solver.threads = 1;  // runs go side by side instead
      if (how == Refinement::half_step) v.scene.solver.time_step /= 2;
      if (how == Refinement::tenth_tolerance) {
        v.scene.solver.tolerance /= 10;
        v.scene.solver.max_iterations *= 10;
      }
      c.variants.push_back(std::move(v));
    }
  // Films are kept with their runs, so the cells are part of a run's name.
  const std::string cells = !c.grid ? "" : fmt::format(" {} {} {} {} {} {} {}", c.grid->origin.x(), c.grid->origin.y(), c.grid->origin.z(), c.grid->ring,
                                                       c.grid->layer, c.grid->rings, c.grid->layers);
  const std::string build = std::string(version()) + " " + commit();
  // Seed by seed: after the first of them every backend has shown what a run costs, and the time left is no guess.
  for (std::size_t s = 0; s < c.seeds; ++s)
    for (std::size_t v = 0; v < c.variants.size(); ++v) {
      const std::uint64_t seed = options.seed + s;
      const CompareVariant& variant = c.variants[v];
      c.jobs.push_back({v, seed, job_key(variant.scene.text + refinement_key(variant.refinement) + cells, seed,
                                         "compare " + c.contenders[variant.contender].label, build)});
    }
  return c;
}

JobsReport run_all(const Comparison& c, const Options& options) {
  ProgressDisplay display(options.quiet);
  JobsHooks hooks;
  hooks.interrupted = interrupted;
  hooks.progress = [&](const JobsProgress& p) {
    display.show(static_cast<double>(p.done), static_cast<double>(p.total), p.remaining_s,
                 fmt::format("{} of {} runs ({} reused, {} failed)", p.done, p.total, p.reused, p.failed));
  };
  return run_jobs(c.jobs, options.out, options.threads, [&](const Job& job) {
    const CompareVariant& v = c.variants[job.scene];
    return compare_run(*c.contenders[v.contender].backend, v.scene, job.seed, c.frames, c.grid);
  }, hooks);
}

void tell(const json& result, const Options& options) {
  fmt::print("{:<32}", "observable");
  for (const auto& [label, ignored] : result["backends"].items()) fmt::print(" {:>22}", label);
  fmt::print("  verdict\n");
  for (const json& o : result["observables"]) {
    fmt::print("{:<32}", o["name"].get<std::string>());
    for (const auto& [label, ignored] : result["backends"].items()) {
      const json& v = o["values"][label];
      fmt::print(" {:>22}", !v["mean"].is_number() ? "-" : v["se"].is_number() ? fmt::format("{:.4g} +- {:.2g}", v["mean"].get<double>(), v["se"].get<double>())
                                                                              : fmt::format("{:.6g}", v["mean"].get<double>()));
    }
    fmt::print("  {}{}\n", o["kind"] == "cost" ? "" : o["verdict"].get<std::string>(),
               o["verdict"] == "differ" && o["kind"] != "cost" && o["standard_errors"].is_number() ? fmt::format(" {:.1f} se", o["standard_errors"].get<double>()) : "");
  }
  fmt::print("\n{}\n", result["headline"].get<std::string>());
  for (const auto& [what, file] : {std::pair{"report", "report.html"}, {"result", "compare.json"}})
    fmt::print("{:<9}{}\n", what, (options.out / file).string());
}

std::vector<std::string> warnings_of(const json& result, const Prepared& prepared) {
  std::vector<std::string> list;
  for (const Finding& finding : prepared.findings) list.push_back(finding.place + ": " + finding.message);
  for (const auto& [label, b] : result["backends"].items()) {
    if (b["failed"] > 0) list.push_back(fmt::format("{} runs of {} failed", b["failed"].get<int>(), label));
    if (const double share = b["solver"]["converged_fraction"]; b["runs"] > 0 && share < 0.95)
      list.push_back(fmt::format("{} converged in {:.1f} % of its steps only", label, 100 * share));
    for (const json& name : b["unsupported"]) list.push_back(fmt::format("{} leaves out {}", label, name.get<std::string>()));
  }
  return list;
}

int compare(Options options, const Own& own) {
  if (own.cost) return compare_cost(options, contenders_of(own, 1), own.costs);
  std::vector<Contender> contenders = contenders_of(own, 2);
  const bool allow = options.allow_unsupported;
  const Prepared prepared = prepared_scene(options);
  for (Contender& c : contenders) {
    c.unsupported = c.backend->unsupported(prepared.model);
    if (!c.unsupported.empty() && !allow)
      throw Error("--backends " + c.label, fmt::format("this backend cannot do: {}", fmt::join(c.unsupported, ", ")),
                  "leave it out, or give --allow-unsupported to run it without that");
  }
  if (prepared.model.grain_count() > 0 && own.seeds < 2)
    throw Error("--seeds", "one run of grains has no scatter to compare with", "give --seeds 2 or more; 5 also tell where three backends part");
  const Comparison comparison = planned(prepared, std::move(contenders), options, own);
  std::error_code ignored;
  std::filesystem::remove(options.out / "compare.json", ignored);
  const JobsReport report = run_all(comparison, options);
  if (interrupted() && report.progress.done < report.progress.total) {
    fmt::print(stderr, "interrupted after {} of {} runs; the same command with --resume goes on from here\n", report.progress.done, report.progress.total);
    return exit_status::interrupted;
  }
  json result = summarise_compare(comparison, report);
  result["scenario"] = "compare";
  result["title"] = options.file.empty() ? "Backends compared on " + options.preset : "Backends compared on " + options.file.filename().string();
  result["seed"] = options.seed;
  result["wall_s"] = report.progress.wall_s;
  result["version"] = version();
  result["commit"] = commit();
  result["scene_text"] = prepared.scene.text;
  result["warnings"] = warnings_of(result, prepared);
  write_atomically(options.out / "report.html", report::to_html(compare_report(result)));
  write_result(options.out / "compare.json", result.dump(2));
  tell(result, options);
  const int status = report.progress.failed > 0 ? exit_status::simulation : exit_status::done;
  for (const auto& r : report.results)
    if (r && !r->failure.empty()) fmt::print(stderr, "a run failed: {}\n", r->failure);
  // How often an engine converges is a finding of the comparison, not a failure of it.
  for (std::size_t i = prepared.findings.size(); i < result["warnings"].size(); ++i)
    fmt::print(stderr, "warning: {}\n", result["warnings"][i].get<std::string>());
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CommandInfo info;
  info.name = "compare";
  info.summary =
      "Runs one scene on several backends, with the same seeds and grains, as given, with half the step and with a tenth of the tolerance, and says for each "
      "observable whether they agree. Finished runs are kept in OUT/jobs and used again; --threads runs go side by side.";
  info.example =
      "repose compare scenarios/configs/block_on_incline.yaml\n  repose compare --seeds 4 --set grains.powder.count=500\n  repose compare --cost --out out/cost";
  info.file = "SCENE.yaml";
  info.presets = {"spheres", "shapes"};
  Own own;
  return run_command(argc, argv, info, [&](const Options& options) { return compare(options, own); }, [&](CLI::App& app) {
    app.add_option("--backends", own.backends, "those to compare (default: all)")->type_name("NAME,NAME...");
    app.add_option("--seeds", own.seeds, "runs per backend, numbered from --seed (default 5)")->type_name("N")->check(CLI::Range(1, 10000));
    app.add_flag("--no-refine", own.no_refine, "without the runs at half the step and a tenth of the tolerance");
    app.add_flag("--cost", own.cost, "instead: processor time per simulated second against the number of grains");
    app.add_option("--grains", own.costs.grains, "with --cost: numbers of grains, ascending (default 10 to 20000)")->delimiter(',')->type_name("N,N...")
        ->check(CLI::Range(10, 10000000));
    app.add_option("--cap", own.costs.cap_s, "with --cost: processor seconds for one point; a backend's last is the one that reaches it (default 60)")
        ->type_name("S")->check(CLI::Range(0.01, 1e6));
  });
}
