/// concealment_diagnose: writes a verdict for every case that has none. After the seal was broken, with --oracle: what the diagnosis makes of a case when it
/// is told the truth; with --suggested: what it makes of the recordings that it asked for where it could not tell, beside those that there were.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <set>

#include "analysis/bundle/read_bundle.hpp"
#include "analysis/bundle/write_bundle.hpp"
#include "analysis/diagnosis/diagnose.hpp"
#include "backends/backends.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "scenarios/diagnosis_json.hpp"
#include "scenarios/history.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/jobs.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/version.hpp"
#include "tests/bench/concealment/recorded_again.hpp"
#include "tests/bench/concealment/seal.hpp"

namespace {

using namespace repose;
using namespace repose::concealment;
using nlohmann::json;

/// What a diagnosis says of the bundle in a folder, as diagnosis.json would; nullopt if it was interrupted.
std::optional<json> diagnosed(const std::function<std::filesystem::path()>& bundle_folder, const diagnosis::DiagnoseOptions& options) {
  const auto begun = std::chrono::steady_clock::now();
  json result;
  try {
    const Bundle bundle = read_bundle(bundle_folder());
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

enum class Mode { verdict, oracle, suggested };

json verdict_of(const std::filesystem::path& folder, const std::string& id) { return json::parse(read_bytes(verdict_file(folder, id))).at("observables"); }

/// What was told apart from nothing, but not from each other.
std::vector<std::string> told_names(const json& verdict) {
  std::set<std::string> names;
  for (const json& missing : verdict.at("missing")) names.insert(missing.at("effect").get<std::string>());
  for (const json& group : verdict.at("indistinguishable")) names.insert(group.begin(), group.end());
  return {names.begin(), names.end()};
}

bool asks_for_more(const json& verdict) { return verdict.at("verdict") == "ambiguous" && !verdict.at("suggested_recordings").empty(); }

bool wanted(Mode mode, const std::filesystem::path& folder, const std::string& id, const json& truth) {
  if (mode == Mode::verdict) return true;
  if (truth.at("effects").empty() || truth.at("level") == "unknown" || !std::filesystem::exists(verdict_file(folder, id))) return false;
  return mode == Mode::oracle || asks_for_more(verdict_of(folder, id));
}

/// The case with the recordings that its verdict asks for, written beside the others.
std::filesystem::path follow_suggestion(const std::filesystem::path& folder, const std::string& id, const json& truth, const json& verdict) {
  const std::uint64_t seed = truth.at("seed");
  const ConcealedCase made = make_case(truth.at("level"), seed);
  json as_made = made.truth;
  as_made["seed"] = seed;
  if (as_made != truth) throw Error(id, "these programs make another case of its seed than it was", "generate the benchmark anew", Error::Kind::simulation);
  const std::string what = verdict.at("suggested_recordings").front().at("what");
  const std::optional<diagnosis::Change> change = change_in_words(read_bundle(folder / "cases" / id), what);
  if (!change) throw Error(id, "suggests what cannot be recorded: " + what, "", Error::Kind::simulation);
  const std::filesystem::path to = folder / "suggested" / "cases" / id;
  std::filesystem::remove_all(to);
  write_bundle(to, recorded_again(made, *change, seed));
  return to;
}

int diagnose_all(const std::filesystem::path& folder, int workers, Mode mode, int limit) {
  const json manifest = read_manifest(folder);
  const json truth = mode == Mode::verdict ? json::object() : open_seal(folder, false);
  if (mode == Mode::verdict && is_open(folder)) throw Error(folder.string(), "the truth was opened already", "generate new cases from another seed");
  std::vector<std::string> ids;
  for (const std::string& id : case_ids(manifest))
    if (wanted(mode, folder, id, truth.value(id, json())) && (limit == 0 || ids.size() < static_cast<std::size_t>(limit))) ids.push_back(id);
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < ids.size(); ++i) jobs.push_back({i, 1, ids[i]});
  ProgressDisplay display(false);
  JobsHooks hooks;
  hooks.interrupted = interrupted;
  hooks.progress = [&](const JobsProgress& p) {
    display.show(static_cast<double>(p.done), static_cast<double>(p.total), p.remaining_s,
                 mode == Mode::oracle ? "cases, told the truth" : mode == Mode::suggested ? "cases, with what they asked for" : "cases");
  };
  const JobsReport report = run_jobs(
      jobs, folder / (mode == Mode::oracle ? "oracle" : mode == Mode::suggested ? "suggested" : "verdicts"), workers,
      [&](const Job& job) {
        diagnosis::DiagnoseOptions options;
        options.interrupted = interrupted;
        options.other_backends = backends_beside(find_backend("dvi"));
        if (mode == Mode::oracle) options.candidates = true_names(truth.at(job.key));
        if (mode != Mode::suggested) return diagnosed([&] { return folder / "cases" / job.key; }, options);
        const json verdict = verdict_of(folder, job.key);
        options.candidates = told_names(verdict);
        return diagnosed([&] { return follow_suggestion(folder, job.key, truth.at(job.key), verdict); }, options);
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
  bool oracle = false, suggested = false;
  app.add_option("FOLDER", folder, "as concealment_generate made it")->required();
  app.add_option("--jobs", workers, "cases side by side")->check(CLI::Range(1, 256));
  app.add_option("--first", limit, "only so many cases")->check(CLI::Range(1, 1000000));
  CLI::Option* const told = app.add_flag("--oracle", oracle, "tell the diagnosis the truth; breaks the seal");
  app.add_flag("--suggested", suggested, "make the recordings that ambiguous verdicts ask for, and diagnose with them; breaks the seal")->excludes(told);
  CLI11_PARSE(app, argc, argv);
  catch_interrupts();
  return diagnose_all(folder, workers, oracle ? Mode::oracle : suggested ? Mode::suggested : Mode::verdict, limit);
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
