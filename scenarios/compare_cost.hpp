#pragma once
/// `repose compare --cost`: what a simulated second costs each backend, against the number of grains.
///
/// A bed: N spheres fall into a box as wide as cbrt(N) grains need, and settle (configs/compare_cost.yaml). One point is the
/// processor time of the whole scene over its simulated time, one thread, one run at a time: what else the machine does is not in it. A
/// point that reaches the cap is stopped there;
/// its figure is what has been simulated by then, and no larger one is tried on that backend.
#include <vector>

#include "scenarios/command_line.hpp"
#include "scenarios/compare_results.hpp"

namespace repose {

struct CostOptions {
  std::vector<std::size_t> grains{10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000};
  double cap_s = 60;  ///< of processor time, per point
};

/// Writes cost.json {points [{backend, grains, cpu_per_simulated_s, wall_per_simulated_s, ms_per_step (of processor time), simulated_s,
/// cpu_s, wall_s, contacts, converged_fraction, capped}], cap_s} and cost.html into options.out, and prints the points. The exit
/// status. Throws Error as the scene or a run does.
int compare_cost(const Options& options, const std::vector<Contender>& contenders, const CostOptions& costs);

}  // namespace repose
