/// concealment_generate: makes cases under sealed labels.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "analysis/bundle/write_bundle.hpp"
#include "core/error.hpp"
#include "core/random.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/version.hpp"
#include "tests/bench/concealment/concealed_case.hpp"
#include "tests/bench/concealment/seal.hpp"

namespace {

using namespace repose;
using namespace repose::concealment;

void generate(const std::filesystem::path& out, const std::map<std::string, int>& counts, std::uint64_t seed) {
  if (std::filesystem::exists(out / "manifest.json")) throw Error(out.string(), "holds cases already", "choose another folder");
  std::vector<std::string> wanted;
  for (const auto& [level, count] : counts) wanted.insert(wanted.end(), static_cast<std::size_t>(count), level);
  Random random(seed, 0);
  for (std::size_t i = wanted.size(); i > 1; --i) std::swap(wanted[i - 1], wanted[random.below(i)]);
  nlohmann::json truth = nlohmann::json::object(), ids = nlohmann::json::array();
  ProgressDisplay display(false);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    display.show(static_cast<double>(i), static_cast<double>(wanted.size()), 0, "making cases");
    const std::uint64_t own = random.below(std::uint64_t{1} << 62);
    ConcealedCase made = make_case(wanted[i], own);
    const std::string id = fmt::format("case-{:03}", i + 1);
    made.bundle.title = "Experiment " + id;
    made.truth["seed"] = own;
    write_bundle(out / "cases" / id, made.bundle);
    truth[id] = made.truth;
    ids.push_back(id);
  }
  seal(out, truth, {{"cases", ids}, {"version", version()}, {"commit", commit()}});
  fmt::print("{} cases\n{}\n", wanted.size(), (out / "manifest.json").string());
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Makes recordings in which physics is concealed, with the truth under seal.\n\nExample\n  concealment_generate --out cases --cases nominal=10 C0=10 --seed 7");
  std::string out;
  std::vector<std::string> wanted;
  std::uint64_t seed = 1;
  app.add_option("--out", out, "folder")->required();
  app.add_option("--cases", wanted, fmt::format("LEVEL=COUNT ...; levels: {}", fmt::join(levels(), ", ")))->required();
  app.add_option("--seed", seed, "of everything");
  CLI11_PARSE(app, argc, argv);
  std::map<std::string, int> counts;
  for (const std::string& w : wanted) {
    const std::size_t equals = w.find('=');
    if (equals == std::string::npos) throw Error("--cases " + w, "not LEVEL=COUNT", "write C0=20");
    counts[w.substr(0, equals)] = std::stoi(w.substr(equals + 1));
  }
  generate(out, counts, seed);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
