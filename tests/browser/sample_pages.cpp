/// Writes report.html, film.html, a diagnosis-<verdict>.html for each verdict and that of a heap, diagnosis-heap.html, into the folder given: what check_pages.sh opens.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "analysis/render/render.hpp"
#include "analysis/report/film.hpp"
#include "core/recording.hpp"
#include "scenarios/bulk_diagnosis_report.hpp"
#include "scenarios/diagnosis_report.hpp"
#include "tests/browser/sample_diagnosis.hpp"
#include "tests/browser/sample_report.hpp"
#include "tests/unit/picture_heap.hpp"
#include "tests/unit/stand_in_heap.hpp"

int main(int argc, char** argv) try {
  using namespace repose;
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  const Model model = test::picture_heap({.grains = 500});
  const Camera camera = frame_scene(model, model.initial);
  RenderOptions options;
  options.width = 480;
  options.height = 300;
  std::vector<FilmFrame> frames;
  Image image;
  for (int i = 0; i < 3; ++i) {
    options.caption = "frame " + std::to_string(i);
    image = render(model, model.initial, camera, options);
    frames.push_back({0.1 * i, encode_jpeg(image)});
  }
  write_atomically(folder / "report.html", report::to_html(report::sample_report(encode_png(image))));
  write_atomically(folder / "film.html", film_html("Sample <film>", frames, 25));
  Bundle bundle;
  bundle.title = "Balls pushed along a floor";
  for (int i = 1; i <= 20; ++i) {
    BundleRun run;
    run.id = "push-" + std::to_string(i);
    bundle.runs.push_back(run);
  }
  for (const auto& d : {test::sample_missing(), test::sample_none(), test::sample_ambiguous(), test::sample_unknown(), test::sample_measurement(),
                        test::sample_numerics()})
    write_atomically(folder / ("diagnosis-" + d.verdict.word + ".html"), report::to_html(diagnosis_report(d, bundle, {{"backend", "dvi"}})));
  const Bundle heaps = diagnosis::recorded_heaps(12, 500, {{"pairs.grain-grain.rolling_friction", "0.075"}});
  diagnosis::BulkOptions two;
  two.effects = {"rolling_friction", "restitution"};
  const diagnosis::BulkDiagnosis found = diagnosis::diagnose_bulk(heaps, diagnosis::stand_in(), two);
  write_atomically(folder / "diagnosis-heap.html", report::to_html(bulk_diagnosis_report(found, heaps, {{"backend", "dvi"}})));
  return 0;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "%s\n", problem.what());
  return 1;
}
