/// repose layer: a roller or a blade spreads a pile of powder over a settled bed; the surface is measured before and after.
#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/render/height_picture.hpp"
#include "core/areal_filter.hpp"
#include "core/scene_yaml.hpp"
#include "scenarios/bed.hpp"
#include "scenarios/installation.hpp"
#include "scenarios/layer_half_step.hpp"
#include "scenarios/layer_json.hpp"
#include "scenarios/layer_measurement.hpp"
#include "scenarios/layer_report.hpp"
#include "scenarios/spreading.hpp"

namespace {

using namespace repose;

std::filesystem::path scene_file(const Options& options) {
  return options.file.empty() ? config_file("layer-" + options.preset + ".yaml") : options.file;
}

/// How much higher the surface stands after than before; the Gaussian mean over a square's edge, because cell by cell a grain that
/// rolled aside is a spot of its own height.
std::string draw_thickness(const LayerMeasurement& m, double square) {
  const HeightGrid map = gaussian_mean(m.thickness_map, std::max(square, least_filter_cells * m.thickness_map.cell));
  const HeightFigures f = height_figures(map);
  const double low = f.quantile[1], high = f.quantile[7];
  return encode_png(height_picture({{"layer thickness", map.nx, map.ny, &map.height}}, map.cell, low, high > low ? high : low + map.cell, "thickness"));
}

std::string draw_surfaces(const LayerMeasurement& m) {
  // One scale, from the 0.1 % to the 99.9 % quantile of both: a single deep hole would flatten all colours.
  const double low = std::min(m.before.heights.quantile.front(), m.after.heights.quantile.front());
  const double high = std::max(m.before.heights.quantile.back(), m.after.heights.quantile.back());
  const auto panel = [](const char* title, const HeightGrid& g) { return HeightPanel{title, g.nx, g.ny, &g.height}; };
  return encode_png(height_picture({panel("before", m.before.grid), panel("after", m.after.grid)}, m.after.grid.cell, low,
                                   high > low ? high : low + m.after.grid.cell, "height"));
}

/// Where powder does not hide the plate, Sa is that of grains and plate together.
std::string uncovered(const BedSurface& s) {
  if (s.coverage == 0) return "   bare plate";
  return s.coverage < 1 ? fmt::format("   grains over {:.1f} % of the plate", 100 * s.coverage) : "";
}

void tell(const LayerMeasurement& m, const Scene& scene, const SpreaderPath& path, const Bed& bed, const RunReport& report,
          const Options& options) {
  constexpr double um = 1e6;
  const LayerSetup& setup = *scene.layer;
  fmt::print("bed              {} in {}; {}, {:.3g} s simulated\n", bed.reused ? "reused, settled before" : "settled now", bed.folder.string(),
             bed.at_rest ? "at rest" : "NOT at rest: make layer.settle longer", bed.time);
  fmt::print("spreader         lowest line {:.1f} um above the plate, {:.1f} um above the mean surface\n", (path.lowest - setup.plate) * um,
             (path.lowest - setup.plate - m.before.heights.mean) * um);
  fmt::print("{:<17}{:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "surface [um]", "mean", "min", "max", "sd", "Sa", "Sq", "packing");
  for (const auto& [name, s] : {std::pair{"  before", &m.before}, {"  after", &m.after}})
    fmt::print("{:<17}{:>10.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9}{}\n", name, s->heights.mean * um, s->heights.min * um,
               s->heights.max * um, s->heights.sd * um, s->roughness.Sa * um, s->roughness.Sq * um,
               s->packing.fraction ? fmt::format("{:.3f}", *s->packing.fraction) : "-", uncovered(*s));
  const std::size_t squares = m.after.highest.top.size();
  fmt::print("highest grains of squares of {:.0f} um\n", setup.square * um);
  const SquareFigures &before = m.before.squares.front(), &after = m.after.squares.front();
  for (const auto& [name, f] : {std::pair{"  centres before", &before.centres}, {"  centres after", &after.centres}, {"  tops before", &before.tops},
                                {"  tops after", &after.tops}})
    if (f->n > 0)
      fmt::print("{:<17}{:>10.2f} {:>9.2f} {:>9.2f} {:>9.2f}{}\n", name, f->mean * um, f->min * um, f->max * um, f->sd * um,
                 f->n < squares ? fmt::format("   of {} of {} squares", f->n, squares) : "");
    else
      fmt::print("{:<17}{:>10} {:>9} {:>9} {:>9}   of no square\n", name, "-", "-", "-", "-");
  const SpreaderLoad& l = m.load;
  fmt::print("layer            {:.2f} um thick in the mean (standard error {}); {} grains came into the region\n", m.thickness.mean * um,
             m.thickness_se ? fmt::format("{:.2f} um", *m.thickness_se * um) : "not known", m.moved_in);
  if (m.solid_of_gap) fmt::print("solid that came  {:.2f} um of volume per area, {:.3f} of the gap\n", m.solid_per_area * um, *m.solid_of_gap);
  if (l.used > 0)
    fmt::print("force            [{:.3g}, {:.3g}, {:.3g}] N, torque about y {:.3g} N m: mean of {} of {} steps over the region\n", l.force.x(), l.force.y(),
               l.force.z(), l.torque.y(), l.used, l.steps);
  else
    fmt::print("force            not known: none of {} steps over the region tells it\n", l.steps);
  if (l.used < l.steps)
    fmt::print("                 {} did not converge, {} others overlapped deeper than {:.2g} um, a hundredth of a mean diameter\n", l.steps - l.converged,
               l.converged - l.used, l.overlap_allowed * um);
  if (spreader_of(scene).yield)
    fmt::print("rise             {:.3g} um in the mean, {:.3g} um at most: how far the powder lifted the spreader\n", l.rise * um,
               l.rise_largest * um);
  if (m.lost > 0) fmt::print("warning          {} grains lie below the plate\n", m.lost);
  fmt::print("wall time        {:.1f} s for the bed{}, {:.1f} s for the layer\n", bed.wall_s, bed.reused ? " (then)" : "", report.wall_s);
  for (const auto& [what, file] :
       {std::pair{"surfaces", "surface.vdb"}, {"picture", "surface.png"}, {"report", "report.html"}, {"result", "result.json"}})
    fmt::print("{:<17}{}\n", what, (options.out / file).string());
}

void warn(const LayerMeasurement& m) {
  for (const Doubt& doubt : doubts_of(m)) fmt::print(stderr, "warning: {}\n  {}\n", doubt.what, doubt.remedy);
}

/// A bed is kept however well its steps converged, so this is told whenever it is used.
int bed_status(const Bed& bed) {
  if (bed.converged_contacts >= least_converged) return exit_status::done;
  fmt::print(stderr, "the solver converged for {:.1f} % of the contacts of the settling bed only (95 % are asked for; largest residual {:.2g})\n"
             "  make layer.settle_time_step smaller or solver.max_iterations larger\n", 100 * bed.converged_contacts, bed.residual_max);
  return exit_status::simulation;
}

/// Before the bed settles, which may take hours: what an earlier run left is not of this one, and its checkpoints would stop a later --resume.
void clear(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* file : {"result.json", "report.html", "surface.png", "surface.vdb"}) std::filesystem::remove(folder / file, ignored);
  std::filesystem::remove_all(folder / "checkpoints", ignored);
}

int spread(const Options& options, const std::filesystem::path& beds, bool half_step) {
  const Scene scene = load_scene(scene_file(options), options.overrides);
  demand_layer(scene, "");
  const LayerSetup& setup = *scene.layer;
  Prepared bed_prepared = prepare_bed(scene, options);
  std::vector<Finding> told = bed_prepared.findings;
  add_missing(check_spreading(scene, options), told);
  repose::tell(told);
  if (!goes_on(options)) clear(options.out);
  std::optional<Bed> bed = make_bed(bed_prepared, options, beds);
  if (!bed) {
    fmt::print(stderr, "interrupted while the bed settled; the same command with --resume goes on from here\n");
    return exit_status::interrupted;
  }
  Spreading spreading = over_the_bed(scene, bed_prepared.model, bed->state, options);
  bed_prepared.model = {};  // half a kilobyte a grain that nothing looks at again
  bed->state = {};
  const auto told_before = static_cast<std::ptrdiff_t>(told.size());
  add_missing(spreading.prepared.findings, told);
  repose::tell({told.begin() + told_before, told.end()});
  add_missing(bed_prepared.findings, spreading.prepared.findings);
  const Prepared& prepared = spreading.prepared;
  const SpreaderPath& path = spreading.path;
  const RunReport report = simulate(prepared, options, "result.json", {}, setup.spreader);
  const int status = std::max(report_status(report, options), bed_status(*bed));
  if (report.end == RunReport::End::interrupted) return status;

  // The report draws the frame in which the spreader is over the middle of the region; all frames may be larger than what simulated them.
  const double over_the_middle = (0.5 * (setup.lower.x() + setup.upper.x()) - path.from) / setup.speed;
  const int every = std::max(1, static_cast<int>(std::lround(over_the_middle / prepared.scene.frame_interval)));
  const Recording recording = read_recording(options.out / "run.h5", every);
  const LayerMeasurement layer =
      measure_layer(setup, prepared.model, prepared.model.initial, report.final_state, recording.steps, path.lowest, path.from);
  if (const std::optional<Finding> jam = doubt_of_overlap(layer.load, report.max_penetration)) {
    spreading.prepared.findings.push_back(*jam);
    repose::tell({*jam});
  }
  write_vdb(options.out / "surface.vdb", {{"before", layer.before.grid}, {"after", layer.after.grid}});
  const std::string picture = draw_surfaces(layer), thickness = draw_thickness(layer, setup.square);
  write_atomically(options.out / "surface.png", picture);
  const std::string common = common_result("layer", prepared, options, report);  // here: its peak memory is that of spreading and measuring
  const auto write = [&](const std::optional<HalfStep>& half) {
    write_atomically(options.out / "report.html", report::to_html(layer_report({prepared, options, report, recording, layer, path, *bed, picture, thickness, half})));
    nlohmann::ordered_json result = nlohmann::ordered_json::parse(common);
    result.update(nlohmann::ordered_json(layer_json(layer, setup, path, *bed)));
    if (half) result["half_step"] = half_step_json(*half);
    write_result(options.out / "result.json", result.dump(2));
  };
  write({});
  tell(layer, scene, path, *bed, report, options);
  warn(layer);
  if (!half_step) return status;
  const std::optional<HalfStep> half = spread_with_half_step(spreading, layer, options.quiet);
  if (!half) {
    fmt::print(stderr, "interrupted before half the step was through; all else is written, and the same command with --resume tries that again\n");
    return exit_status::interrupted;
  }
  write(half);
  fmt::print("half the step    {}\n", half_step_in_words(*half));
  if (half->converged_fraction >= least_converged) return status;
  fmt::print(stderr, "with half the step the solver converged in {:.1f} % of the steps only (95 % are asked for)\n  make solver.max_iterations larger\n",
             100 * half->converged_fraction);
  return std::max(status, exit_status::simulation);
}

}  // namespace

int main(int argc, char** argv) {
  CommandInfo info;
  info.name = "layer";
  info.summary =
      "Spreads a pile of powder over a settled bed with a roller or a blade and measures the surface before and after; writes "
      "result.json, run.h5, surface.vdb, surface.png and report.html. The settled bed is kept and used again by runs that differ in "
      "the spreader alone.";
  info.example = "repose layer --preset quick\n  repose layer --set layer.rotation=counter_rotating --out out/counter";
  info.file = "SCENE.yaml";
  info.presets = {"quick", "desk", "study"};
  std::string beds = "out/beds";
  bool half_step = false;
  return run_command(
      argc, argv, info, [&](const Options& options) { return spread(options, beds, half_step); },
      [&](CLI::App& app) {
        app.add_option("--beds", beds, "folder of settled beds (default out/beds)")->type_name("DIR");
        app.add_flag("--half-step", half_step, "spread once more with half the step: are roughness, packing and force converged in it?");
      });
}
