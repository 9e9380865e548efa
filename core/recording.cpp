#include "core/recording.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/hdf5_file.hpp"
#include "core/recording_checkpoint.hpp"
#include "core/recording_model.hpp"
#include "core/recording_state.hpp"
#include "core/recording_xdmf.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

constexpr const char* format_name = "repose run 1";

std::string link_name(std::size_t index) { return fmt::format("/frames/{:06d}", index); }

/// Infinite radii (tools) are drawn as points.
std::vector<float> display_radii(const Model& model) {
  std::vector<float> radii;
  radii.reserve(model.bodies.size());
  for (const Body& body : model.bodies) radii.push_back(std::isfinite(body.radius) ? static_cast<float>(body.radius) : 0.f);
  return radii;
}

/// Removes the files of `folder` whose names begin and end so.
void remove_files(const fs::path& folder, const std::string& prefix, const std::string& suffix) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(prefix) && name.ends_with(suffix)) found.push_back(entry.path());
  }
  for (const fs::path& file : found) fs::remove(file);
}

void demand_same_run(const fs::path& file, const RunIdentity& stored, const RunIdentity& wanted) {
  std::string difference;
  if (stored.backend != wanted.backend)
    difference = fmt::format("backend \"{}\", not \"{}\"", stored.backend, wanted.backend);
  else if (stored.seed != wanted.seed)
    difference = fmt::format("seed {}, not {}", stored.seed, wanted.seed);
  else if (stored.scene != wanted.scene)
    difference = "another scene, or other --set values";
  else if (stored.model != wanted.model)
    difference = "grains that differ, although the scene is the same";
  if (difference.empty()) return;
  throw Error(file.string(), "this checkpoint belongs to another run: it was made with " + difference,
              "give the arguments of the interrupted run, or another --out, or leave out --resume to start anew");
}

}  // namespace

struct Recorder::Impl {
  fs::path folder;
  const Model& model;
  std::string scene_text, backend;
  RunIdentity identity;
  std::vector<double> frame_times;
  std::vector<StepRecord> steps;

  fs::path frames() const { return folder / "frames"; }
  fs::path checkpoints() const { return folder / "checkpoints"; }

  void prepare(bool resume) const {
    fs::create_directories(frames());
    fs::create_directories(checkpoints());
    const fs::path probe = folder / "probe";
    write_durably(probe, "");
    fs::remove(probe);
    for (const fs::path& place : {folder, frames(), checkpoints()}) remove_files(place, "", ".partial");
    if (resume) return;
    // The table of contents goes first: a kill in between leaves no run.h5 that links to frames that are gone.
    fs::remove(folder / "run.h5");
    fs::remove(folder / "run.xmf");
    remove_files(checkpoints(), "step-", ".h5");
    remove_files(frames(), "frame-", ".h5");
  }
};

Recorder::Recorder(fs::path folder, const Model& model, std::string scene_text, std::string backend, std::uint64_t seed,
                   bool resume)
    : impl_(new Impl{std::move(folder), model, std::move(scene_text), std::move(backend), {}, {}, {}}) {
  impl_->identity = {fingerprint(model), checksum(impl_->scene_text), seed, impl_->backend};
  const char* remedy = "choose a folder that can be written with --out";
  try {
    impl_->prepare(resume);
  } catch (const fs::filesystem_error& problem) {
    throw Error(impl_->folder.string(), "this folder cannot be prepared: " + problem.code().message(), remedy);
  } catch (const Error& problem) {
    throw Error(problem.place(), problem.problem(), remedy);
  }
}

Recorder::~Recorder() = default;

void Recorder::frame(const Snapshot& state) {
  Hdf5Writer file(Hdf5Writer::Packing::compressed);
  write_snapshot<float>(file, "", state);
  write_durably(impl_->frames() / frame_file_name(impl_->frame_times.size()), file.bytes());
  impl_->frame_times.push_back(state.time);
}

void Recorder::step(const StepRecord& record) { impl_->steps.push_back(record); }

void Recorder::checkpoint(const Frame& frame, double wall_s, bool ended) {
  write_checkpoint(impl_->checkpoints(), {impl_->identity, frame, wall_s, ended, impl_->frame_times, impl_->steps});
}

std::optional<Recorder::Resumed> Recorder::resume() {
  const std::vector<fs::path> files = find_checkpoints(impl_->checkpoints());
  std::string damage;
  for (const fs::path& file : files) {
    Checkpoint c;
    try {
      c = read_checkpoint(file);
    } catch (const Error& problem) {
      damage += (damage.empty() ? "" : "\n  ") + (problem.place() + ": " + problem.problem());
      continue;
    }
    demand_same_run(file, c.run, impl_->identity);
    // A damaged newer file would count as one of the two that are kept.
    std::error_code ignored;
    for (const fs::path& newer : files) {
      if (newer == file) break;
      fs::remove(newer, ignored);
    }
    impl_->frame_times = c.frame_times;
    impl_->steps = c.steps;
    if (!damage.empty()) damage += "\n  continuing from the checkpoint before it, " + file.string();
    return Resumed{std::move(c.frame), c.wall_s, c.ended, std::move(c.steps), damage};
  }
  if (files.empty()) return std::nullopt;
  throw Error(impl_->checkpoints().string(), "no checkpoint is intact\n  " + damage,
              "nothing can be resumed from; leave out --resume to start anew");
}

void Recorder::finish() {
  Hdf5Writer file(Hdf5Writer::Packing::compressed);
  file.write_text("/format", format_name);
  file.write_text("/scene", impl_->scene_text);
  file.write_text("/backend", impl_->backend);
  file.write("/seed", std::vector<std::uint64_t>{impl_->identity.seed});
  write_model(file, "/model", impl_->model);
  file.write("/display/radius", display_radii(impl_->model));
  write_steps(file, "/steps", impl_->steps);
  file.write("/frame_times", impl_->frame_times);
  for (std::size_t i = 0; i < impl_->frame_times.size(); ++i) file.link(link_name(i), "frames/" + frame_file_name(i));
  write_durably(impl_->folder / "run.xmf", xdmf_text(impl_->model.bodies.size(), impl_->frame_times, impl_->model.periodic));
  write_durably(impl_->folder / "run.h5", file.bytes());
}

Recording read_recording(const fs::path& run_h5, int every) {
  if (every < 1) throw Error("every", fmt::format("{} is not a positive number of frames", every), "use 1 to read all");
  const Hdf5Reader file(run_h5, "give the run.h5 of a run of this project; if it is damaged, run the scene again with --resume");
  if (!file.has("/format") || file.read_text("/format") != format_name)
    throw Error(run_h5.string(), "is an HDF5 file, but not a recording of this version of the project",
                "give the run.h5 that a run wrote");
  Recording recording;
  recording.scene_text = file.read_text("/scene");
  recording.backend = file.read_text("/backend");
  recording.seed = file.read<std::uint64_t>("/seed", 1, 1).front();
  recording.model = read_model(file, "/model");
  validate(recording.model);
  recording.steps = read_steps(file, "/steps");
  const std::size_t count = file.read<double>("/frame_times").size();
  for (std::size_t i = 0; i < count; ++i) {
    if (i % static_cast<std::size_t>(every) != 0 && i + 1 != count) continue;
    if (!file.has(link_name(i)))
      throw Error((run_h5.parent_path() / "frames" / frame_file_name(i)).string(),
                  fmt::format("frame {} of {} is missing or damaged", i, count),
                  "keep the folder frames beside run.h5; run the scene again with --resume if the file is lost");
    recording.frames.push_back(read_snapshot<float>(file, link_name(i), recording.model.bodies.size()));
  }
  return recording;
}

}  // namespace repose
