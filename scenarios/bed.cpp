#include "scenarios/bed.hpp"

#include <cmath>

#include <fmt/format.h>

#include "analysis/bed_structure.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/hdf5_file.hpp"
#include "core/recording_model.hpp"
#include "core/recording_state.hpp"
#include "scenarios/version.hpp"

namespace repose {
namespace {

constexpr double resting = 0.01;   // of sqrt(g d)
constexpr double in_the_air = 5;   // times sqrt(d/g)
constexpr const char* remedy = "remove the folder; the bed is then made anew";

Bed read_bed(const std::filesystem::path& file, const Model& model) {
  const Hdf5Reader in(file, remedy);
  Bed bed;
  bed.state = read_snapshot<double>(in, "/state", model.bodies.size());
  const std::vector<double> figures = in.read<double>("/figures", 1, 6);
  bed.at_rest = figures[0] > 0;
  bed.time = figures[1];
  bed.wall_s = figures[2];
  bed.speed_rms = figures[3];
  bed.converged_contacts = figures[4];
  bed.residual_max = figures[5];
  return bed;
}

}  // namespace

double speed_of_grains(const Model& model, const Snapshot& state, double plate) {
  double squares = 0, n = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (model.bodies[i].role != BodyRole::grain || state.position[i].z() < plate) continue;
    squares += state.velocity[i].squaredNorm();
    n += 1;
  }
  const double scale = model.gravity.norm() * mean_diameter(model);
  return n > 0 && scale > 0 ? std::sqrt(squares / n / scale) : 0;
}

bool grains_rest(const Model& model, const Snapshot& state, double plate) { return speed_of_grains(model, state, plate) < resting; }

bool bed_rests(const Model& model, const Snapshot& state, double plate) {
  const double g = model.gravity.norm();
  return grains_rest(model, state, plate) && (g == 0 || state.time >= in_the_air * std::sqrt(mean_diameter(model) / g));
}

std::string bed_key(const Prepared& bed, const Options& options) {
  const SolverOptions& s = bed.scene.solver;
  const std::string text =
      fmt::format("{:016x} {} {} {} {} {} {} {} {} {} {} {} {} {} {} {}", fingerprint(bed.model), s.time_step, s.tolerance, s.max_iterations,
                  static_cast<int>(s.kind), static_cast<int>(s.law), static_cast<int>(s.integration), s.warm_start, s.search_margin, bed.scene.duration,
                  bed.scene.frame_interval, bed.scene.layer->plate, options.backend, options.allow_unsupported, version(), commit());
  return fmt::format("{:016x}", checksum(text));
}

std::optional<Bed> make_bed(const Prepared& prepared, const Options& options, const std::filesystem::path& folder) {
  Options own = options;
  own.out = folder / bed_key(prepared, options);
  const std::filesystem::path file = own.out / "bed.h5";
  const bool there = std::filesystem::exists(file);
  if (!there) {
    own.resume = options.resume && std::filesystem::exists(own.out / "checkpoints");
    const double plate = prepared.scene.layer->plate;
    const auto finished = [&](const Snapshot& state, const StepReport&) { return bed_rests(prepared.model, state, plate); };
    const RunReport report = simulate(prepared, own, "bed.h5", finished);
    if (report.end == RunReport::End::interrupted) return std::nullopt;
    const double speed = speed_of_grains(prepared.model, report.final_state, plate);
    Hdf5Writer out(Hdf5Writer::Packing::compressed);
    write_snapshot<double>(out, "/state", report.final_state);
    out.write("/figures", std::vector<double>{bed_rests(prepared.model, report.final_state, plate) ? 1.0 : 0.0, report.final_state.time, report.wall_s, speed,
                                              report.converged_contacts, report.residual_max});
    write_atomically(file, out.bytes());
  }
  Bed bed = read_bed(file, prepared.model);
  bed.reused = there;
  bed.folder = own.out;
  return bed;
}

}  // namespace repose
