/// repose view: stills and films of a recorded run.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "analysis/render/render.hpp"
#include "analysis/report/film.hpp"
#include "analysis/report/video.hpp"
#include "core/error.hpp"
#include "core/recording.hpp"
#include "scenarios/command_line.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/progress.hpp"

namespace {

using namespace repose;

/// A page of more than this many bytes is slow to open: its frames are thinned.
constexpr std::size_t largest_page = 40'000'000;

struct ViewOptions {
  long frame = -1;   ///< -1: the last
  double time = -1;  ///< [s]; < 0: not given
  bool film = false;
  std::string view = "iso", only, colour, format;
  std::vector<std::string> hide;
  int width = 0, height = 0;  ///< 0: chosen
  int frames = 150;
  double rate = 25;
  double azimuth_deg = 0;
  int samples = 0;
};

void add_options(CLI::App& app, ViewOptions& o) {
  auto* frame = app.add_option("--frame", o.frame, "number of the frame, from 0 (default: the last)")
                    ->check(CLI::NonNegativeNumber);
  app.add_option("--time", o.time, "the frame nearest to this time [s]")
      ->check(CLI::NonNegativeNumber)
      ->excludes(frame);
  app.add_flag(
      "--film", o.film,
      "all frames as a film: film.html, a page that plays without network, and film.mp4 if ffmpeg is on the PATH");
  app.add_option("--view", o.view, "iso (default), side or top; flanks keep their angle in side and top")
      ->check(CLI::IsMember({"iso", "side", "top"}));
  app.add_option("--azimuth", o.azimuth_deg, "turns the eye about z [degrees]");
  app.add_option("--only", o.only, "draw only the grains of this shape")->type_name("SHAPE");
  app.add_option("--colour", o.colour, "what the colours of grains tell: shape, or population (default if only that differs)")
      ->check(CLI::IsMember({"shape", "population"}));
  app.add_option("--hide", o.hide, "bodies and tools that are not drawn")->type_name("NAME");
  app.add_option("--format", o.format, "png; with --film also html or mp4 (default: html, and mp4 if possible)")
      ->check(CLI::IsMember({"png", "html", "mp4"}));
  app.add_option("--width", o.width, "of the picture [pixels] (default 1600, film 960)")->check(CLI::Range(16, 16384));
  app.add_option("--height", o.height, "of the picture [pixels] (default: width / 1.6; film: to suit)")
      ->check(CLI::Range(16, 16384));
  app.add_option("--samples", o.samples, "rays per pixel (default 6, film 3)")->check(CLI::Range(1, 1024));
  app.add_option("--frames", o.frames,
                 "at most so many frames in a film (default 150); a page of more than 40 MB is thinned further")
      ->check(CLI::Range(2, 100000));
  app.add_option("--rate", o.rate, "frames per second of the film (default 25)")->check(CLI::Range(0.1, 240.0));
}

std::size_t recorded_frames(const std::filesystem::path& run) {
  std::error_code problem;
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(run.parent_path() / "frames", problem))
    if (entry.path().extension() == ".h5") ++count;
  return count;
}

/// Shapes tell nothing where all grains have the same and several populations are mixed.
bool only_populations_differ(const Model& model) {
  std::set<std::string> shapes;
  std::set<int> populations;
  for (const Body& body : model.bodies) {
    if (body.role != BodyRole::grain) continue;
    shapes.insert(model.shapes[static_cast<std::size_t>(body.shape)].kind);
    populations.insert(body.name);
  }
  return shapes.size() == 1 && populations.size() > 1;
}

RenderOptions picture_of(const ViewOptions& view, const Options& options, const Model& model, double time) {
  RenderOptions picture;
  picture.width = view.width;
  picture.height = view.height;
  picture.samples = view.samples;
  picture.threads = options.threads;
  picture.hide = view.hide;
  picture.only = view.only;
  picture.by_population = view.colour == "population" || (view.colour.empty() && only_populations_differ(model));
  picture.caption = fmt::format("t = {:.4g} s", time);
  return picture;
}

FrameOptions framing_of(const ViewOptions& view) {
  FrameOptions framing;
  framing.view = view_named(view.view);
  framing.azimuth_deg = view.azimuth_deg;
  framing.hide = view.hide;
  if (view.width > 0 && view.height > 0) framing.aspect = static_cast<double>(view.width) / view.height;
  return framing;
}

void check_names(const Model& model, const ViewOptions& view) {
  for (const std::string& name : view.hide)
    if (std::find(model.names.begin(), model.names.end(), name) == model.names.end())
      throw Error("--hide", "the run has no body or tool '" + name + "'",
                  model.names.empty() ? "leave it out" : fmt::format("its names: {}", fmt::join(model.names, ", ")));
}

const Snapshot& chosen_frame(const std::vector<Snapshot>& frames, const ViewOptions& view, std::size_t& number) {
  if (view.time >= 0) {
    const auto nearest = std::min_element(frames.begin(), frames.end(), [&](const Snapshot& a, const Snapshot& b) {
      return std::abs(a.time - view.time) < std::abs(b.time - view.time);
    });
    number = static_cast<std::size_t>(nearest - frames.begin());
    return *nearest;
  }
  if (view.frame < 0) {
    number = frames.size() - 1;
    return frames.back();
  }
  number = static_cast<std::size_t>(view.frame);
  if (number >= frames.size())
    throw Error("--frame", fmt::format("there is no frame {}", number),
                fmt::format("the last is {}", frames.size() - 1));
  return frames[number];
}

int still(ViewOptions view, const Options& options) {
  if (view.width == 0) view.width = view.height > 0 ? static_cast<int>(std::lround(1.6 * view.height)) : 1600;
  if (view.height == 0) view.height = static_cast<int>(std::lround(view.width / 1.6));
  if (view.samples == 0) view.samples = RenderOptions{}.samples;
  const bool last = view.frame < 0 && view.time < 0;
  const Recording run = read_recording(options.file, last ? std::numeric_limits<int>::max() : 1);
  if (run.frames.empty()) throw Error(options.file.string(), "the run has recorded no frame", "run it longer");
  check_names(run.model, view);
  std::size_t number = 0;
  const Snapshot& state = chosen_frame(run.frames, view, number);
  const Camera camera = frame_scene(run.model, state, framing_of(view));
  const Image image = render(run.model, state, camera, picture_of(view, options, run.model, state.time));
  std::filesystem::create_directories(options.out);
  const std::filesystem::path file = options.out / (last ? "view.png" : fmt::format("view-{:06}.png", number));
  write_png(file, image);
  fmt::print("picture  {}  (t = {:.6g} s)\n", file.string(), state.time);
  return exit_status::done;
}

/// Every n-th of the frames, so that they fit on a page.
std::vector<FilmFrame> thinned(std::vector<FilmFrame> frames) {
  std::size_t bytes = 0;
  for (const FilmFrame& frame : frames) bytes += frame.jpeg.size() * 4 / 3;
  const std::size_t every = (bytes + largest_page - 1) / largest_page;
  if (every <= 1) return frames;
  std::vector<FilmFrame> kept;
  for (std::size_t i = 0; i < frames.size(); i += every) kept.push_back(std::move(frames[i]));
  return kept;
}

int film(ViewOptions view, const Options& options) {
  const bool page = view.format.empty() || view.format == "html", stills = view.format == "png";
  const bool video = view.format == "mp4" || (view.format.empty() && VideoWriter::available());
  if (view.format == "mp4" && !VideoWriter::available())
    throw Error("--format", "mp4 needs the program ffmpeg, which is not on the PATH", "install ffmpeg, or choose html");
  const std::size_t most = static_cast<std::size_t>(view.frames), all = recorded_frames(options.file);
  const std::size_t every = std::max<std::size_t>(1, all > most ? (all - 1 + most - 2) / (most - 1) : 1);
  const Recording run = read_recording(options.file, static_cast<int>(every));
  if (run.frames.empty()) throw Error(options.file.string(), "the run has recorded no frame", "run it longer");
  check_names(run.model, view);

  const std::vector<Snapshot> shown{run.frames.front(), run.frames[run.frames.size() / 2], run.frames.back()};
  if (view.samples == 0) view.samples = 3;
  if (view.width == 0 && view.height == 0) view.width = 960;
  const double aspect = fitting_aspect(run.model, shown, framing_of(view));
  if (view.height == 0) view.height = static_cast<int>(std::lround(view.width / aspect));
  if (view.width == 0) view.width = static_cast<int>(std::lround(view.height * aspect));
  const Camera camera = frame_scene(run.model, shown, framing_of(view));

  std::filesystem::create_directories(options.out);
  std::optional<VideoWriter> writer;
  if (video) writer.emplace(options.out / "film.mp4", view.width, view.height, view.rate);
  ProgressDisplay progress(options.quiet);
  std::vector<FilmFrame> frames;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < run.frames.size(); ++i) {
    if (interrupted()) return exit_status::interrupted;
    const Snapshot& state = run.frames[i];
    const Image image = render(run.model, state, camera, picture_of(view, options, run.model, state.time));
    if (page) frames.push_back({state.time, encode_jpeg(image, 82)});
    if (stills) write_png(options.out / fmt::format("film-{:06}.png", i), image);
    if (writer) writer->add(image);
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto done = static_cast<double>(i + 1), total = static_cast<double>(run.frames.size());
    progress.show(done, total, spent / done * (total - done), fmt::format("frame {} of {}", i + 1, run.frames.size()));
  }
  if (writer) {
    writer->finish();
    fmt::print("film     {}\n", (options.out / "film.mp4").string());
  }
  if (page) {
    const std::size_t count = frames.size();
    frames = thinned(std::move(frames));
    write_atomically(options.out / "film.html", film_html("Repose: " + options.file.string(), frames, view.rate));
    fmt::print("film     {}  ({} of {} recorded frames{})\n", (options.out / "film.html").string(), frames.size(),
               std::max(all, count), frames.size() < count ? ", thinned to keep the page small" : "");
  }
  if (stills) fmt::print("pictures {}\n", (options.out / "film-*.png").string());
  return exit_status::done;
}

}  // namespace

int main(int argc, char** argv) {
  ViewOptions view;
  const CommandInfo info{
      "view",
      "Pictures and films of a recorded run: grains coloured by shape or population, with shadows and a scale bar.",
      "repose view out/aor/run.h5\n"
      "repose view out/aor/run.h5 --view side --time 0.2 --hide funnel\n"
      "repose view out/aor/run.h5 --film --frames 100",
      "run.h5",
      true,
      {}};
  return run_command(
      argc, argv, info,
      [&](const Options& options) {
        if (!view.film && (view.format == "html" || view.format == "mp4")) view.film = true;
        return view.film ? film(view, options) : still(view, options);
      },
      [&](CLI::App& app) { add_options(app, view); });
}
