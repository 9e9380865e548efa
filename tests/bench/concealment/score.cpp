/// concealment_score: breaks the seal and compares verdicts with the truth.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "analysis/bundle/read_bundle.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "tests/bench/concealment/results_page.hpp"
#include "tests/bench/concealment/seal.hpp"
#include "tests/bench/concealment/sparse_regression.hpp"

namespace {

using namespace repose;
using namespace repose::concealment;
using nlohmann::json;

json observables(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return nullptr;
  return json::parse(read_bytes(file)).at("observables");
}

void score(const std::vector<std::string>& folders, const std::string& page, bool partly) {
  std::vector<JudgedCase> cases;
  std::vector<std::string> told;
  for (const std::filesystem::path folder : folders) {
    const json truth = open_seal(folder, partly), manifest = read_manifest(folder);
    std::string by;
    std::size_t scored = 0;
    for (const std::string& id : case_ids(manifest)) {
      const json verdict = observables(verdict_file(folder, id));
      if (verdict.is_null()) continue;
      cases.push_back(judge(id, truth.at(id), verdict, observables(folder / "oracle" / "jobs" / (id + ".json")),
                            observables(folder / "suggested" / "jobs" / (id + ".json"))));
      cases.back().regression = sparse_regression(read_bundle(folder / "cases" / id));
      by = verdict.value("commit", "unknown");
      ++scored;
    }
    told.push_back(fmt::format("- {} of {} sealed cases, made at commit {}, diagnosed at {}; SHA-256 of the truth {}", scored, case_ids(manifest).size(),
                               manifest.value("commit", "unknown"), by, manifest.at("truth_sha256").get<std::string>()));
  }
  const std::string text = results_page(cases, told);
  if (page.empty())
    fmt::print("{}", text);
  else
    write_durably(page, text);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app(
      "Opens the truth of diagnosed cases and scores the verdicts. Run concealment_diagnose --oracle between a first call and the last: without the "
      "oracle nothing counts as detectable.\n\nExample\n  concealment_score cases --page results.md");
  std::vector<std::string> folders;
  std::string page;
  bool partly = false;
  app.add_option("FOLDER", folders, "as concealment_generate made them")->required();
  app.add_option("--page", page, "Markdown file; default: standard output");
  app.add_flag("--partly", partly, "open although cases lack their verdict; those are never scored");
  CLI11_PARSE(app, argc, argv);
  score(folders, page, partly);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
