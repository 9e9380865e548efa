// What a diagnosis must hold: the verdict, the effect, a value within its interval, and held-out runs that the extended scene fits better
// and, run anew, as the file states.
//
//   check_diagnosis OUT BUNDLE VERDICT [EFFECT PARAMETER VALUE]
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "analysis/bundle/read_bundle.hpp"
#include "analysis/bundle/sensor.hpp"
#include "backends/backends.hpp"
#include "scenarios/history.hpp"

namespace {

using namespace repose;
using nlohmann::json;

void demand(bool met, const std::string& what) {
  if (met) return;
  fmt::print(stderr, "FAILED: {}\n", what);
  std::exit(1);
}

/// Root mean square of the position residuals of a run that starts as stated.
void add_squares(const std::filesystem::path& out, const Bundle& bundle, const std::string& id, const json& own, const std::string& backend, double& squares, double& samples) {
  std::vector<Override> start;
  const BundleRun* run = nullptr;
  for (const BundleRun& r : bundle.runs)
    if (r.id == id) run = &r;
  start = run->set;
  for (const auto& [key, value] : own.items()) start.push_back({key, fmt::format("{}", value.get<double>())});
  const Scene scene = load_scene(out / "extended.yaml", start);
  SimulationRequest request;
  request.scene = &scene;
  const History history = run_history(find_backend(backend), request, false).history;
  for (const Observation& o : run->observations)
    for (std::size_t i = 0; i < o.time.size(); ++i)
      for (int k = 0; k < 3; ++k)
        if (std::isfinite(o.position[i][k])) {
          const double d = sample(history, history.bodies.at(o.body), o.time[i]).position[k] - o.position[i][k];
          squares += d * d;
          samples += 1;
        }
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path out = argv[1];
  const Bundle bundle = read_bundle(argv[2]);
  const json found = json::parse(std::ifstream(out / "diagnosis.json"));
  demand(found["verdict"] == argv[3], fmt::format("the verdict is {}: {}", found["verdict"].dump(), found["ranked"].dump()));
  if (argc < 7) return 0;
  const json& missing = found["missing"];
  demand(missing.size() == 1 && missing[0]["effect"] == argv[4], fmt::format("what is missing is {}", missing.dump()));
  const json& parameter = missing[0]["parameters"][argv[5]];
  const double value = std::atof(argv[6]), lower = parameter["lower"], upper = parameter["upper"];
  // The 90 % interval, widened by half on either side, holds the truth in 98 % of all cases.
  const double margin = 0.5 * (upper - lower);
  demand(lower - margin <= value && value <= upper + margin, fmt::format("{} is not in {} .. {}", value, lower, upper));
  const json& held = found["fit"]["heldout"];
  demand(held["extended"]["chi2_per_dof"] < held["nominal"]["chi2_per_dof"], "held-out runs are not fitted better: " + held.dump());
  if (bundle.runs.front().observations.front().kind != ObservableKind::trajectory) {
    // Two held-out packings against a scatter known from few seeds: 1.2, 2.4 and 4.8 for recordings of three seeds, where the nominal
    // leaves 17 to 23. And a packing does not repeat, so that the extended scene cannot be checked run by run.
    demand(held["extended"]["chi2_per_dof"] < 0.3 * held["nominal"]["chi2_per_dof"].get<double>(), "held-out runs are hardly fitted better: " + held.dump());
    return 0;
  }
  demand(held["extended"]["chi2_per_dof"] < 2, "held-out runs are not fitted to their noise: " + held.dump());
  if (found["verdict"] == "measurement") return 0;  // not of the scene
  double squares = 0, samples = 0;
  for (const json& id : held["runs"]) add_squares(out, bundle, id, held["extended"]["own"][id.get<std::string>()], found.value("extended_backend", "dvi"), squares, samples);
  const double stated = held["extended"]["rmse"]["position"], again = std::sqrt(squares / samples);
  demand(std::abs(again / stated - 1) < 1e-3, fmt::format("extended.yaml leaves {} m, stated are {} m", again, stated));
}
