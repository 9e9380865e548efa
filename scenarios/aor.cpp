/// repose aor: powder runs out of a funnel onto a base; the angle of repose of the heap is measured.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "analysis/heap_measurement.hpp"
#include "analysis/render/camera.hpp"
#include "analysis/render/render.hpp"
#include "core/error.hpp"
#include "scenarios/heap_json.hpp"
#include "scenarios/heap_report.hpp"
#include "scenarios/installation.hpp"
#include "scenarios/reference_file.hpp"
#include "scenarios/simulate.hpp"

namespace {

using namespace repose;

std::filesystem::path scene_file(const Options& options) {
  if (!options.file.empty()) return options.file;
  return config_file(options.preset == "quick" ? "aor-quick.yaml" : "aor.yaml");
}

HeapMeasurement measure(const Prepared& prepared, const Recording& recording, const Snapshot& state) {
  DischargeCurve discharge;
  if (const auto outlet = funnel_outlet(prepared.scene))
    discharge = discharge_curve(prepared.model, recording.frames, *outlet);
  const std::size_t n = recording.frames.size();
  return measure_heap(prepared.scene, prepared.model, state, n >= 2 ? &recording.frames[n - 2] : nullptr, std::move(discharge));
}

std::string draw(const Prepared& prepared, const Options& options, const HeapMeasurement& heap, const Snapshot& state) {
  RenderOptions picture;
  picture.threads = options.threads;
  if (heap.repose.angle)
    picture.caption = fmt::format("angle of repose {:.1f}° ± {:.1f}°", heap.repose.angle->value, heap.repose.angle->se);
  return encode_png(render(prepared.model, state, frame_scene(prepared.model, state), picture));
}

void tell(const HeapMeasurement& heap, const Options& options) {
  const HeapGrains& grains = heap.repose.grains;
  if (heap.repose.angle) {
    const ReposeAngle& a = *heap.repose.angle;
    fmt::print("angle of repose  {:.2f} deg +- {:.2f} (standard error; standard deviation over {} flanks {:.2f})\n", a.value, a.se,
               a.flanks.size(), a.sd);
  } else {
    fmt::print("angle of repose  none: {}\n", heap.repose.message);
  }
  fmt::print("heap             {} grains on the base, {} over the rim; {}\n", grains.heap.size(),
             grains.trench.size() + grains.rim.size(),
             heap.repose.profile.covers_base ? "it covers the base" : "it does not cover the base");
  if (heap.solid) fmt::print("solid fraction   {:.3f} +- {:.3f}\n", heap.solid->value, heap.solid->se);
  if (heap.rest.at_rest) {
    fmt::print("at rest          fastest grain {:.2g} of sqrt(g d)\n", heap.rest.speed_max);
  } else {
    fmt::print("NOT at rest      {}: make `duration` longer\n", heap.rest.reason);
  }
  if (heap.rest.in_funnel > 0)
    fmt::print("warning          {} grains stay in the funnel: its outlet is clogged, or closed; a wider one lets them out\n",
               heap.rest.in_funnel);
  for (const auto& [what, file] : {std::pair{"picture", "heap.png"}, {"report", "report.html"}, {"result", "result.json"}})
    fmt::print("{:<17}{}\n", what, (options.out / file).string());
}

int pour(const Options& options) {
  const Prepared prepared = prepare(scene_file(options), options);
  const std::optional<HeapSite> site = heap_site(prepared.scene);
  if (!site) throw Error("tools", "the scene has no base to pour a heap on", "add a tool of kind base, or use `repose run`");
  const std::optional<Outlet> outlet = funnel_outlet(prepared.scene);
  const auto finished = [&](const Snapshot& state, const StepReport&) {
    return assess_rest(prepared.model, state, *site, outlet).at_rest;
  };
  const RunReport report = simulate(prepared, options, "result.json", finished);
  const int status = report_status(report, options);
  if (report.end == RunReport::End::interrupted) return status;

  // Before the frames are read back: the peak memory in it is that of the simulation.
  nlohmann::ordered_json result = nlohmann::ordered_json::parse(common_result("aor", prepared, options, report));
  const Recording recording = read_recording(options.out / "run.h5");
  const HeapMeasurement heap = measure(prepared, recording, report.final_state);
  const std::string picture = draw(prepared, options, heap, report.final_state);
  write_atomically(options.out / "heap.png", picture);
  const auto measured = load_reference(reference_file("pa650/table1.yaml")).single("angle_of_repose");
  write_atomically(options.out / "report.html",
                   report::to_html(heap_report({prepared, options, report, recording.steps, heap, picture, measured})));
  result.update(nlohmann::ordered_json(heap_json(heap)));
  write_result(options.out / "result.json", result.dump(2));
  tell(heap, options);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CommandInfo info;
  info.name = "aor";
  info.summary =
      "Pours powder through a funnel onto a base and measures the angle of repose from side views; writes result.json, run.h5, "
      "heap.png and report.html. Ends when the heap is at rest.";
  info.example = "repose aor --preset quick\n  repose aor --set pairs.pa12-pa12.rolling_friction=0.1 --out out/rough";
  info.file = "SCENE.yaml";
  info.presets = {"standard", "quick"};
  return run_command(argc, argv, info, pour);
}
