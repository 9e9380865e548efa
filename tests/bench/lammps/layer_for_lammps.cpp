/// layer_for_lammps: hands the bed of `repose layer` to LAMMPS, and measures what LAMMPS made of it as `repose layer` measures its own.
///
///   layer_for_lammps SCENE.yaml --young PA --beds DIR --out DIR
///   layer_for_lammps SCENE.yaml --measure --beds DIR --out DIR
///
/// Both need the bed that `repose layer SCENE.yaml --beds DIR` made. layer_against_lammps.sh runs all of it.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "analysis/neighbour_grid.hpp"
#include "core/error.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/bed.hpp"
#include "scenarios/layer_measurement.hpp"
#include "tests/bench/lammps/lammps_input.hpp"

namespace {

using namespace repose;

struct Case {
  Scene scene;
  Spreading spreading;
};

Case opened(const std::filesystem::path& beds, const Options& options) {
  Case c;
  c.scene = load_scene(options.file, options.overrides);
  demand_layer(c.scene, options.file.string());
  const Prepared prepared = prepare(bed_scene(c.scene), options);
  const std::optional<Bed> bed = make_bed(prepared, options, beds);
  if (!bed) throw Error("bed", "interrupted", "run it again");
  c.spreading = over_the_bed(c.scene, prepared.model, bed->state, options);
  return c;
}

/// All frames of a dump whose atoms are sorted, as states of the model; grains that were lost stay where they began.
std::vector<Snapshot> frames_of(const std::filesystem::path& file, const Model& model) {
  std::ifstream in(file);
  if (!in) throw Error(file.string(), "cannot be read", "run LAMMPS first");
  std::vector<std::size_t> grains;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].role == BodyRole::grain) grains.push_back(i);
  std::vector<Snapshot> frames;
  std::string line;
  while (std::getline(in, line)) {
    if (line.starts_with("ITEM: TIMESTEP")) frames.push_back(model.initial);
    if (!line.starts_with("ITEM: ATOMS")) continue;
    while (in.peek() != 'I' && std::getline(in, line)) {
      std::istringstream row(line);
      std::size_t id = 0;
      Vec3 x, v;
      if (!(row >> id >> x.x() >> x.y() >> x.z() >> v.x() >> v.y() >> v.z()) || id == 0 || id > grains.size())
        throw Error(file.string(), "a line is not an atom: " + line, "run LAMMPS again");
      frames.back().position[grains[id - 1]] = x;
      frames.back().velocity[grains[id - 1]] = v;
    }
  }
  if (frames.empty()) throw Error(file.string(), "holds no frame", "run LAMMPS again");
  return frames;
}

/// Overlaps of pairs of spheres in mean diameters.
void add_overlaps(const Model& model, const Snapshot& state, std::vector<double>& overlaps) {
  std::vector<Vec3> centres;
  std::vector<double> radius;
  double largest = 0, sum = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].role == BodyRole::grain) {
      centres.push_back(state.position[i]);
      radius.push_back(model.bodies[i].radius);
      largest = std::max(largest, radius.back());
      sum += 2 * radius.back();
    }
  const double diameter = sum / static_cast<double>(radius.size());
  const NeighbourGrid grid(centres, 2 * largest);
  for (std::size_t i = 0; i < centres.size(); ++i)
    grid.near(centres[i], [&](int other) {
      const auto j = static_cast<std::size_t>(other);
      if (j <= i) return true;
      const double overlap = radius[i] + radius[j] - (centres[i] - centres[j]).norm();
      if (overlap > 0) overlaps.push_back(overlap / diameter);
      return true;
    });
}

void tell(const std::string& who, const LayerMeasurement& m) {
  constexpr double um = 1e6;
  fmt::print("{:<8} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.4f} {:>8.4f} {:>10.2f}\n", who, m.before.roughness.Sa * um, m.after.roughness.Sa * um,
             m.before.heights.mean * um, m.after.heights.mean * um, m.before.packing.fraction.value_or(0), m.after.packing.fraction.value_or(0), m.thickness.mean * um);
}

void measure(const Case& c, const std::filesystem::path& folder) {
  const Model& model = c.spreading.prepared.model;
  const Snapshot before = frames_of(folder / "settled.dump", model).back(), after = frames_of(folder / "final.dump", model).back();
  std::vector<double> overlaps;
  for (const Snapshot& frame : frames_of(folder / "spread.dump", model)) add_overlaps(model, frame, overlaps);
  std::sort(overlaps.begin(), overlaps.end());
  const auto quantile = [&](double q) { return overlaps.empty() ? 0 : overlaps[static_cast<std::size_t>(q * static_cast<double>(overlaps.size() - 1))]; };
  fmt::print("overlaps while spreading, mean diameters: median {:.4f}, 99 % {:.4f}, 99.9 % {:.4f}, largest {:.4f}\n", quantile(0.5), quantile(0.99),
             quantile(0.999), quantile(1));
  fmt::print("{:<8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10}\n", "", "Sa0 um", "Sa um", "mean0 um", "mean um", "packing0", "packing", "layer um");
  tell("LAMMPS", measure_layer(*c.scene.layer, model, before, after, {}, c.spreading.path.lowest, c.spreading.path.from));
}

}  // namespace

int main(int argc, char** argv) {
  CommandInfo info;
  info.name = "lammps";
  info.summary = "Hands the bed of `repose layer` to LAMMPS (--young), and measures the layer that LAMMPS spread (--measure).";
  info.example = "layer_for_lammps scenarios/configs/layer-quick.yaml --young 2e5 --beds out/beds --out out/lammps";
  info.file = "SCENE.yaml";
  info.file_required = true;
  std::string beds = "out/beds";
  double young = 0, share = 0.2;
  bool measured = false;
  return run_command(
      argc, argv, info,
      [&](const Options& options) {
        const Case c = opened(beds, options);
        if (measured) {
          measure(c, options.out);
          return exit_status::done;
        }
        if (!(young > 0)) throw Error("--young", "is missing", "give the modulus of grains and walls in Pa, such as 2e5");
        const LammpsSettings settings{young, rayleigh_step(c.spreading.prepared.model, young, share), 0.01, options.out};
        write_lammps_input(c.scene, c.spreading, settings);
        fmt::print("step {:.3g} s, {:.0f} steps to spread\n", settings.time_step, c.spreading.prepared.scene.duration / settings.time_step);
        return exit_status::done;
      },
      [&](CLI::App& app) {
        app.add_option("--beds", beds, "folder of settled beds (default out/beds)")->type_name("DIR");
        app.add_option("--young", young, "of grains and walls [Pa]");
        app.add_option("--share", share, "of the Rayleigh time, as step (default 0.2)");
        app.add_flag("--measure", measured, "measure what LAMMPS left in --out");
      });
}
