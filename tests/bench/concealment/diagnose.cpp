/// concealment_diagnose: writes a verdict for every case that has none. With --oracle, after the seal was broken: what the
/// diagnosis makes of a case when it is told the truth.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>

#include "analysis/bundle/read_bundle.hpp"
#include "analysis/diagnosis/diagnose.hpp"
#include "backends/backends.hpp"
#include "core/error.hpp"
#include "scenarios/diagnosis_json.hpp"
#include "scenarios/history.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/jobs.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/version.hpp"
#include "tests/bench/concealment/seal.hpp"

namespace {

using namespace repose;
using namespace repose::concealment;
using nlohmann::json;

/// What a diagnosis says of a bundle, as diagnosis.json would; nullopt if it was interrupted.
std::optional<json> diagnosed(const std::filesystem::path& bundle_folder, const diagnosis::DiagnoseOptions& options) {
  const auto begun = std::chrono::steady_clock::now();
  json result;
  try {
    const Bundle bundle = read_bundle(bundle_folder);
    const diagnosis::Diagnosis found = diagnosis::diagnose(bundle, simulate_with(find_backend("dvi"), false), options);
    if (found.interrupted) return std::nullopt;
    result = diagnosis_json(found);
  } catch (const Error& failure) {
    if (interrupted()) return std::nullopt;
    result = {{"verdict", "failed"}, {"failure", failure.what()}};  // counts as wrong, whatever the truth
  }
  result["wall_s"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  result["commit"] = commit();
  return result;
}

std::vector<std::string> true_names(const json& truth) {
  std::vector<std::string> names;
  for (const json& effect : truth.at("effects")) names.push_back(effect.at("effect"));
  return names;
}

int diagnose_all(const std::filesystem::path& folder, int workers, bool oracle, int limit) {
  const json manifest = read_manifest(folder);
  const json truth = oracle ? open_seal(folder, false) : json::object();
  if (!oracle && is_open(folder)) throw Error(folder.string(), "the truth was opened already", "generate new cases from another seed");
  std::vector<std::string> ids;
  for (const std::string& id : case_ids(manifest)) {
    if (oracle && (truth.at(id).at("effects").empty() || truth.at(id).at("level") == "unknown" || !std::filesystem::exists(verdict_file(folder, id))))
      continue;
    if (limit == 0 || ids.size() < static_cast<std::size_t>(limit)) ids.push_back(id);
  }
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < ids.size(); ++i) jobs.push_back({i, 1, ids[i]});
  ProgressDisplay display(false);
  JobsHooks hooks;
  hooks.interrupted = interrupted;
  hooks.progress = [&](const JobsProgress& p) {
    display.show(static_cast<double>(p.done), static_cast<double>(p.total), p.remaining_s, oracle ? "cases, told the truth" : "cases");
  };
  const JobsReport report = run_jobs(
      jobs, folder / (oracle ? "oracle" : "verdicts"), workers,
      [&](const Job& job) {
        diagnosis::DiagnoseOptions options;
        options.interrupted = interrupted;
        options.other_backends = backends_beside(find_backend("dvi"));
        if (oracle) options.candidates = true_names(truth.at(job.key));
        return diagnosed(folder / "cases" / job.key, options);
      },
      hooks);
  fmt::print("{} of {} cases\n", report.progress.done, report.progress.total);
  return report.interrupted ? 130 : 0;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Diagnoses every case that has no verdict yet.\n\nExample\n  concealment_diagnose cases --jobs 2");
  std::string folder;
  int workers = 1, limit = 0;
  bool oracle = false;
  app.add_option("FOLDER", folder, "as concealment_generate made it")->required();
  app.add_option("--jobs", workers, "cases side by side")->check(CLI::Range(1, 256));
  app.add_option("--first", limit, "only so many cases")->check(CLI::Range(1, 1000000));
  app.add_flag("--oracle", oracle, "tell the diagnosis the truth; breaks the seal");
  CLI11_PARSE(app, argc, argv);
  catch_interrupts();
  return diagnose_all(folder, workers, oracle, limit);
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
