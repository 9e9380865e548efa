#include "scenarios/layer_observations.hpp"

namespace repose {
std::string unit_of_load(const std::string& series) { return series == "roller_torque" ? "N m" : "N"; }

Observation surface_of(const SpreadLayer& layer, const std::string& name, std::size_t most) {
  const HeightGrid& grid = (name == "layer_before" ? layer.measured.before : layer.measured.after).surface;
  int stride = 1;
  const auto places = [&] {
    return static_cast<std::size_t>((grid.nx + stride - 1) / stride) * static_cast<std::size_t>((grid.ny + stride - 1) / stride);
  };
  while (places() > most) ++stride;
  Observation o;
  o.kind = ObservableKind::surface;
  o.name = name;
  for (int j = 0; j < grid.ny; j += stride)
    for (int i = 0; i < grid.nx; i += stride) {
      o.at.push_back(grid.middle(i, 0).x());
      o.at_y.push_back(grid.middle(0, j).y());
      o.value.push_back(static_cast<double>(grid.at(i, j)));
    }
  return o;
}

History loads_on_spreader(const SpreadLayer& layer) {
  History history;
  std::vector<double>&along = history.series["roller_force_x"], &up = history.series["roller_force_z"], &torque = history.series["roller_torque"];
  for (const StepRecord& step : layer.steps) {
    history.time.push_back(step.time);
    along.push_back(step.tool_force.x());
    up.push_back(step.tool_force.z());
    torque.push_back(step.tool_torque.y());
  }
  history.converged = layer.report.converged_fraction >= least_converged;
  return history;
}

}  // namespace repose
