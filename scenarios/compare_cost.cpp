#include "scenarios/compare_cost.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "analysis/report/report.hpp"
#include "core/run.hpp"
#include "scenarios/installation.hpp"
#include "scenarios/interrupt.hpp"
#include "scenarios/progress.hpp"
#include "scenarios/simulate.hpp"
#include "scenarios/thread_clock.hpp"
#include "scenarios/version.hpp"

namespace repose {
namespace {

using nlohmann::json;

constexpr double grain_room = 75e-6;  // edge of the cube that a grain of the bed is given [m]

Scene bed(std::size_t grains, const Options& options) {
  const double width = std::cbrt(static_cast<double>(grains)) * grain_room, half = width / 2;
  std::vector<Override> set = {{"grains.powder.count", std::to_string(grains)},
                               {"tools.box.inner_size", fmt::format("[{0}, {0}, {1}]", width, 6 * width)},
                               {"grains.powder.fill", fmt::format("{{box: {{lower: [{0}, {0}, 0], upper: [{1}, {1}, {2}]}}}}", -half, half, width)}};
  set.insert(set.end(), options.overrides.begin(), options.overrides.end());
  return load_scene(config_file("compare_cost.yaml"), set);
}

json measured(const Backend& backend, const Scene& scene, const Options& options, double cap_s) {
  Scene own = scene;
  own.solver.threads = 1;
  const Model model = realise(own, options.seed);
  const std::unique_ptr<World> world = backend.make(model, own.solver);
  RunHooks hooks;
  const double start = thread_cpu_s();
  hooks.interrupted = [&] { return interrupted() || thread_cpu_s() - start > cap_s; };
  const RunReport r = run(*world, model, {own.solver.time_step, own.duration, own.frame_interval, 1e9}, nullptr, hooks);
  const double cpu_s = thread_cpu_s() - start;
  const double simulated = r.final_state.time, steps = static_cast<double>(r.steps);
  if (r.steps == 0) return nullptr;
  return {{"backend", backend.name}, {"grains", model.grain_count()}, {"simulated_s", simulated}, {"wall_s", r.wall_s},
          {"cpu_s", cpu_s}, {"cpu_per_simulated_s", cpu_s / simulated},
          {"wall_per_simulated_s", r.wall_s / simulated}, {"ms_per_step", 1e3 * cpu_s / steps}, {"contacts", r.contacts_mean},
          {"converged_fraction", r.converged_fraction}, {"capped", r.end == RunReport::End::interrupted}};
}

report::Report cost_report(const json& cost) {
  using namespace report;
  Report page;
  page.title = "Cost of each backend";
  page.subtitle = fmt::format("Spheres that fall into a box and settle; at most {} s per point", cost["cap_s"].get<double>());
  Chart chart;
  chart.title = "Processor time per simulated second against grains";
  chart.caption = "One thread. A series ends where a point reaches its cap; that point is the mean over what was simulated by then.";
  chart.x = {"grains", "", true};
  chart.y = {"processor time per simulated second", "s/s", true};
  Table table;
  table.header = {"backend", "grains", "processor s per simulated s", "ms per step", "contacts", "simulated [s]", "capped"};
  std::map<std::string, Series> series;
  for (const json& p : cost["points"]) {
    Series& s = series.try_emplace(p["backend"], Series{p["backend"], {}, {}, {}, Series::Style::line_and_points, false}).first->second;
    s.x.push_back(p["grains"].get<double>());
    s.y.push_back(p["cpu_per_simulated_s"].get<double>());
    table.rows.push_back({p["backend"].get<std::string>(), std::to_string(p["grains"].get<std::size_t>()), fmt::format("{:.3g}", p["cpu_per_simulated_s"].get<double>()),
                          fmt::format("{:.3g}", p["ms_per_step"].get<double>()), fmt::format("{:.0f}", p["contacts"].get<double>()),
                          fmt::format("{:.3g}", p["simulated_s"].get<double>()), p["capped"].get<bool>() ? "yes" : ""});
  }
  for (auto& [name, s] : series) chart.series.push_back(std::move(s));
  page.sections.push_back({"", {std::move(chart), std::move(table)}});
  return page;
}

}  // namespace

int compare_cost(const Options& options, const std::vector<Contender>& contenders, const CostOptions& costs) {
  json cost = {{"scenario", "compare_cost"}, {"cap_s", costs.cap_s}, {"seed", options.seed}, {"version", version()}, {"commit", commit()}, {"points", json::array()}};
  fmt::print("{:<10} {:>8} {:>16} {:>12} {:>10}\n", "backend", "grains", "s per simulated s", "ms per step", "contacts");
  std::set<std::string> done;
  for (const std::size_t n : costs.grains) {
    const Scene scene = bed(n, options);
    for (const Contender& c : contenders) {
      if (interrupted() || done.contains(c.label)) continue;
      const json point = measured(*c.backend, scene, options, costs.cap_s);
      if (interrupted()) break;
      if (point.is_null() || point["capped"].get<bool>()) done.insert(c.label);
      if (point.is_null()) continue;
      cost["points"].push_back(point);
      fmt::print("{:<10} {:>8} {:>16.4g} {:>12.4g} {:>10.0f}{}\n", c.label, n, point["cpu_per_simulated_s"].get<double>(), point["ms_per_step"].get<double>(),
                 point["contacts"].get<double>(), point["capped"].get<bool>() ? "  (stopped at the cap)" : "");
      std::fflush(stdout);
    }
  }
  std::filesystem::create_directories(options.out);
  write_atomically(options.out / "cost.html", report::to_html(cost_report(cost)));
  if (interrupted()) return exit_status::interrupted;
  write_result(options.out / "cost.json", cost.dump(2));
  return exit_status::done;
}

}  // namespace repose
