#include "scenarios/simulate.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "backends/backends.hpp"
#include "core/error.hpp"
#include "core/nearest.hpp"
#include "core/recording_checkpoint.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/version.hpp"

namespace repose {
namespace {

using Json = nlohmann::ordered_json;

const char* level_name(Finding::Level level) {
  switch (level) {
    case Finding::Level::note: return "note";
    case Finding::Level::warning: return "warning";
    case Finding::Level::refusal: return "refusal";
  }
  return "";
}

std::string told(const Finding& finding) {
  return fmt::format("{}: {}{}{}", finding.place, finding.message, finding.remedy.empty() ? "" : "\n  ", finding.remedy);
}

/// Throws for what is absurd; `findings` keeps what is doubtful.
void judge(std::vector<Finding> findings, bool force, std::vector<Finding>& kept) {
  std::string refused;
  for (const Finding& finding : findings)
    if (finding.level == Finding::Level::refusal) refused += fmt::format("\n{}", told(finding));
  if (!refused.empty() && !force)
    throw Error("", "this scene is refused, for it is not something that grains do:" + refused,
                "mend the scene, or give --force if it is meant so");
  for (Finding& finding : findings)
    if (finding.level != Finding::Level::note) kept.push_back(std::move(finding));
}

/// Scalars that read as numbers or truth values become such; all others are texts.
Json json_of(const YAML::Node& node) {
  if (node.IsMap()) {
    Json object = Json::object();
    for (const auto& entry : node) object[entry.first.as<std::string>()] = json_of(entry.second);
    return object;
  }
  if (node.IsSequence()) {
    Json list = Json::array();
    for (const auto& entry : node) list.push_back(json_of(entry));
    return list;
  }
  if (!node.IsScalar()) return nullptr;
  if (node.Tag() != "!") {  // "!" is the tag of a quoted text
    if (long long whole = 0; YAML::convert<long long>::decode(node, whole)) return whole;
    if (double number = 0; YAML::convert<double>::decode(node, number)) return number;
    if (bool truth = false; YAML::convert<bool>::decode(node, truth)) return truth;
  }
  return node.Scalar();
}

std::int64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{1024} * usage.ru_maxrss;
}

const char* end_name(RunReport::End end) {
  switch (end) {
    case RunReport::End::done: return "duration";
    case RunReport::End::stopped: return "finished_early";
    case RunReport::End::interrupted: return "interrupted";
  }
  return "";
}

}  // namespace

Prepared prepare(const std::filesystem::path& scene_file, const Options& options) {
  return prepare(load_scene(scene_file, options.overrides), options);
}

Prepared prepare(Scene scene, const Options& options, const std::function<void(Model&)>& adjust) {
  Prepared p = prepare_quietly(std::move(scene), options, adjust);
  tell(p.findings);
  return p;
}

void tell(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) fmt::print(stderr, "{}: {}\n", level_name(finding.level), told(finding));
}

void rename(const KeyNames& names, std::vector<Finding>& findings) {
  for (Finding& finding : findings)
    if (const auto name = names.find(finding.place); name != names.end()) finding.place = name->second;
}

void add_missing(const std::vector<Finding>& from, std::vector<Finding>& to) {
  for (const Finding& finding : from)
    if (std::none_of(to.begin(), to.end(), [&](const Finding& f) { return f.place == finding.place && f.message == finding.message; })) to.push_back(finding);
}

Prepared prepare_quietly(Scene scene, const Options& options, const std::function<void(Model&)>& adjust, const KeyNames& names) {
  const auto renamed = [&names](std::vector<Finding> findings) {
    rename(names, findings);
    return findings;
  };
  Prepared p;
  p.backend = &find_backend(options.backend);
  p.scene = std::move(scene);
  p.scene.solver.threads = options.threads;
  std::vector<Finding> before;
  judge(renamed(check_before_realising(p.scene)), options.force, before);
  p.model = realise(p.scene, options.seed);
  if (adjust) adjust(p.model);
  judge(renamed(check_plausibility(p.scene, &p.model)), options.force, p.findings);
  p.unsupported = p.backend->unsupported(p.model);
  if (!p.unsupported.empty() && !options.allow_unsupported)
    throw Error("--backend " + options.backend, "this backend cannot do: " + listing(p.unsupported),
                "choose another backend, or give --allow-unsupported to run without that");
  return p;
}

bool goes_on(const Options& options) { return options.resume && !find_checkpoints(options.out / "checkpoints").empty(); }

RunReport simulate(const Prepared& prepared, const Options& options, const std::string& main_file,
                   std::function<bool(const Snapshot&, const StepReport&)> finished, const std::string& tracked) {
  std::error_code ignored;
  if (!goes_on(options)) std::filesystem::remove(options.out / main_file, ignored);
  Recorder recorder(options.out, prepared.model, prepared.scene.text, options.backend, options.seed, options.resume);
  const std::unique_ptr<World> world = prepared.backend->make(prepared.model, prepared.scene.solver);

  ProgressDisplay display(options.quiet);
  RunHooks hooks;
  hooks.progress = [&display](const Progress& progress) { display.show(progress); };
  hooks.warning = [&display](const std::string& text) { display.message("warning: " + text); };
  hooks.interrupted = interrupted;
  hooks.finished = std::move(finished);
  const Schedule schedule{prepared.scene.solver.time_step, prepared.scene.duration, prepared.scene.frame_interval,
                          options.checkpoint_wall_s, prepared.scene.solver.integration == Integration::second_order, tracked};
  return run(*world, prepared.model, schedule, &recorder, hooks, options.resume);
}

std::string common_result(const std::string& scenario, const Prepared& prepared, const Options& options,
                          const RunReport& report) {
  Json result;
  result["scenario"] = scenario;
  result["backend"] = options.backend;
  result["seed"] = options.seed;
  result["grains"] = prepared.model.grain_count();
  result["wall_s"] = report.wall_s;
  result["steps"] = report.steps;
  result["time"] = report.final_state.time;
  result["end"] = end_name(report.end);
  result["contacts_mean"] = report.contacts_mean;
  result["solver"] = {{"iterations_mean", report.iterations_mean},
                      {"residual_max", report.residual_max},
                      {"converged_fraction", report.converged_fraction},
                      {"cycling_fraction", report.cycling_fraction},
                      {"tolerance", prepared.scene.solver.tolerance},
                      {"time_step", prepared.scene.solver.time_step}};
  result["max_penetration"] = report.max_penetration;
  result["peak_memory_bytes"] = peak_memory_bytes();
  result["unsupported"] = prepared.unsupported;
  result["warnings"] = Json::array();
  for (const Finding& finding : prepared.findings)
    result["warnings"].push_back({{"level", level_name(finding.level)},
                                  {"place", finding.place},
                                  {"message", finding.message},
                                  {"remedy", finding.remedy}});
  result["scene"] = json_of(YAML::Load(prepared.scene.text));
  result["version"] = version();
  result["commit"] = commit();
  return result.dump(2);
}

void write_result(const std::filesystem::path& file, const std::string& json) {
  write_atomically(file, json.ends_with('\n') ? json : json + '\n');
}

void demand_converged(double converged_fraction, double residual_max, const std::string& steps, const std::string& remedy) {
  if (converged_fraction >= least_converged) return;
  throw Error("", fmt::format("the solver converged for {:.1f} % of {} only (95 % are asked for; largest residual {:.2g})", 100 * converged_fraction, steps, residual_max),
              remedy, Error::Kind::simulation);
}

int report_status(const RunReport& report, const Options& options) {
  if (report.end == RunReport::End::interrupted) {
    fmt::print(stderr, "interrupted after {} steps (t = {:.6g} s); the same command with --resume goes on from here\n",
               report.steps, report.final_state.time);
    return exit_status::interrupted;
  }
  if (report.converged_fraction < least_converged) {
    fmt::print(stderr,
               "the solver converged in {:.1f} % of the steps only (95 % are asked for; largest residual {:.2g})\n"
               "  make solver.time_step smaller or solver.max_iterations larger; what was computed is in {}\n",
               100 * report.converged_fraction, report.residual_max, options.out.string());
    return exit_status::simulation;
  }
  return exit_status::done;
}

}  // namespace repose
