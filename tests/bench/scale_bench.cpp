/// What a step costs against the number of grains, at a fixed depth of the bed and a fixed residual: a bed of 1,000 spheres settles
/// in a periodic cell and is laid side by side with itself, so that every size has the same contacts per grain. Gravity is then
/// tilted, and the steps of the sliding bed are timed. Prints a Markdown table. `scale_bench [--quick] [--threads N] [--page FILE]`.
#include <fmt/core.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "analysis/report/report.hpp"
#include "backends/dvi/world_dvi.hpp"
#include "core/effect.hpp"
#include "core/recording.hpp"
#include "core/run.hpp"
#include "tests/support/model_builder.hpp"

namespace repose::dvi {
namespace {

constexpr int tile_grains = 1000;
constexpr double width = 0.51e-3;          // of a tile [m]: nine diameters, which makes the bed half a millimetre deep
constexpr double settling_step = 1e-4, step = 5e-5;  // [s]
constexpr double tilt = 20 * M_PI / 180;   // enough to make the bed slide

struct Bed {
  std::vector<double> scale;  // of a sphere of unit diameter [m]
  std::vector<Vec3> position;
  std::vector<Vec3> velocity;
};

Bed loose_bed() {
  std::mt19937_64 random(1);
  std::normal_distribution<double> size(58e-6, 15e-6);
  std::uniform_real_distribution<double> jitter(-0.05, 0.05);  // [m/s], or they would stand on each other
  Bed bed;
  const int side = 5;  // grains of up to 100 um on a lattice that keeps them apart
  const double pitch = width / side;
  while (static_cast<int>(bed.scale.size()) < tile_grains) {
    const double d = size(random);
    if (d < 30e-6 || d > 100e-6) continue;
    const auto i = static_cast<int>(bed.scale.size());
    bed.scale.push_back(d);
    bed.position.push_back(pitch * Vec3(i % side + 0.5, i / side % side + 0.5, i / side / side + 0.5));
    bed.velocity.push_back(Vec3(jitter(random), jitter(random), 0));
  }
  return bed;
}

/// `across` x `along` copies of a bed.
Model model_of(const Bed& bed, int across, int along) {
  PairLaw law;
  law.friction = 0.52;
  law.rolling_friction = law.spinning_friction = 0.075;
  test::ModelBuilder builder;
  builder.material("grain", 1020).law("grain", "grain", law).floor("grain");
  builder.periodic(0, 0, across * width).periodic(1, 0, along * width);
  const Shape ball = test::shape_of("sphere", Sphere{0.5});
  for (int y = 0; y < along; ++y)
    for (int x = 0; x < across; ++x)
      for (std::size_t i = 0; i < bed.scale.size(); ++i)
        builder.body("grain", ball, {.position = bed.position[i] + width * Vec3(x, y, 0), .velocity = bed.velocity[i]}, bed.scale[i]);
  return builder.build();
}

SolverOptions options_for(double time_step, int threads) {
  SolverOptions options;
  options.time_step = time_step;
  options.threads = threads;
  return options;
}

void settle(Bed& bed, int steps) {
  const Model model = model_of(bed, 1, 1);
  const auto world = make_world(model, options_for(settling_step, 1));
  const Snapshot state = run(*world, model, {settling_step, steps * settling_step, 1e9, 1e9}, nullptr, {}).final_state;
  for (std::size_t i = 0; i < bed.scale.size(); ++i) {
    bed.position[i] = state.position[i + 1];  // body 0 is the floor
    bed.velocity[i] = state.velocity[i + 1];
  }
}

/// What the process holds now [bytes], and the most that it has held since forget_peak().
double memory(const char* field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(field)) return 1024 * std::strtod(line.c_str() + std::strlen(field), nullptr);
  return 0;
}

void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

struct Point {
  double grains, ms;
  int threads;
};

Point measure(const Bed& bed, int across, int along, int threads) {
  forget_peak();
  const Model model = model_of(bed, across, along);
  Model tilted = model;
  tilted.gravity = 9.81 * Vec3(std::sin(tilt), 0, -std::cos(tilt));
  const auto world = make_world(model, options_for(step, threads));
  Snapshot state;
  BodyLoads loads;
  constexpr int started = 10, timed = 20;
  double time = 0, contacts = 0, sweeps = 0, residual = 0;
  for (int i = 0; i < started + timed; ++i) {
    const auto start = std::chrono::steady_clock::now();
    world->read(state);
    evaluate_loads(tilted, state, loads);
    const StepReport report = world->step(step, loads);
    if (i < started) continue;
    time += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / timed;
    contacts += static_cast<double>(report.contacts) / timed;
    sweeps += static_cast<double>(report.iterations) / timed;
    residual = std::max(residual, report.residual);
  }
  const double grains = tile_grains * across * along;
  fmt::print("| {:.0f} | {:.0f} | {} | {:.0f} | {:.1e} | {:.1f} | {:.2f} | {:.1f} | {:.0f} |\n", grains, contacts, threads, sweeps, residual,
             1e3 * time, 1e6 * time / grains, 1e9 * time / contacts / sweeps, memory("VmHWM:") / 1e6);
  std::fflush(stdout);
  return {grains, 1e3 * time, threads};
}

report::Report page_of(const std::vector<Point>& points) {
  report::Chart chart;
  chart.title = "Time of a step against grains";
  chart.caption = "A bed of spheres beside itself, half a millimetre deep and sliding; h = 50 us, tolerance 1e-3. The straight line: in "
                  "proportion to the grains, from the first point.";
  chart.x = {"grains", "", true};
  chart.y = {"time of a step", "ms", true};
  std::map<int, report::Series> series;
  report::Series straight{"in proportion", {}, {}, {}, report::Series::Style::line, false};
  for (const Point& p : points) {
    report::Series& s =
        series.try_emplace(p.threads, report::Series{fmt::format("{} thread{}", p.threads, p.threads > 1 ? "s" : ""), {}, {}, {},
                                                     report::Series::Style::line_and_points, false}).first->second;
    s.x.push_back(p.grains);
    s.y.push_back(p.ms);
    straight.x.push_back(p.grains);
    straight.y.push_back(points.front().ms * p.grains / points.front().grains);
  }
  for (auto& [threads, s] : series) chart.series.push_back(std::move(s));
  chart.series.push_back(std::move(straight));
  report::Report page;
  page.title = "Cost of a step against the number of grains";
  page.sections.push_back({"", {std::move(chart)}});
  return page;
}

}  // namespace
}  // namespace repose::dvi

int main(int argc, char** argv) {
  using namespace repose::dvi;
  bool quick = false;
  std::vector<int> threads{1, 2};
  std::string page;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--quick") == 0) {
      quick = true;
    } else if (std::strcmp(argv[i], "--threads") == 0 && i + 1 < argc && std::atoi(argv[i + 1]) > 0) {
      threads = {std::atoi(argv[++i])};
    } else if (std::strcmp(argv[i], "--page") == 0 && i + 1 < argc) {
      page = argv[++i];
    } else {
      fmt::print("usage: scale_bench [--quick] [--threads N] [--page FILE]\n");
      return std::strcmp(argv[i], "--help") == 0 ? 0 : 2;
    }
  }
  Bed bed = loose_bed();
  settle(bed, quick ? 100 : 1000);
  fmt::print("A bed of 1,000 spheres beside itself, sliding; h = 50 us, tolerance 1e-3; time of a step over all of it\n\n");
  fmt::print("| grains | contacts | threads | sweeps | residual | ms a step | us a grain and step | ns a contact and sweep | peak MB |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  std::vector<std::pair<int, int>> sizes{{1, 1}, {2, 2}};
  if (!quick) sizes.insert(sizes.end(), {{4, 4}, {8, 8}, {16, 16}, {79, 8}});
  std::vector<Point> points;
  for (const auto& [across, along] : sizes)
    for (const int n : threads) points.push_back(measure(bed, across, along, n));
  if (!page.empty()) repose::write_atomically(page, repose::report::to_html(page_of(points)));
  return 0;
}
