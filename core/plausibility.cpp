#include "core/plausibility.hpp"

#include "core/plausibility_checks.hpp"

namespace repose {
namespace {

void check_scene(const Scene& scene, Findings& findings) {
  const std::vector<PopulationFigures> grains = population_figures(scene);
  check_densities(scene, findings);
  const bool sizes_are_sound = check_sizes(scene, grains, findings);
  check_pairs(scene, grains, findings);
  check_counts(grains, findings);
  check_gravity_and_speeds(scene, findings);
  check_step(scene, grains, findings);
  const std::vector<PopulationFigures> sound = sizes_are_sound ? grains : std::vector<PopulationFigures>{};
  check_funnels(scene, sound, findings);
  check_bases(scene, sound, findings);
  check_fills(scene, sound, findings);
  check_support(scene, findings);
  check_layer(scene, sound, findings);
  check_tool_overlaps(scene, findings);
  check_air(scene, grains, findings);
  check_cost(scene, grains, findings);
}

}  // namespace

void Findings::note(const std::string& place, const std::string& message) {
  list_.push_back({Finding::Level::note, place, message, ""});
}
void Findings::warn(const std::string& place, const std::string& message, const std::string& remedy) {
  list_.push_back({Finding::Level::warning, place, message, remedy});
}
void Findings::refuse(const std::string& place, const std::string& message, const std::string& remedy) {
  list_.push_back({Finding::Level::refusal, place, message, remedy});
}

std::vector<Finding> check_before_realising(const Scene& scene) {
  Findings findings;
  check_scene(scene, findings);
  return findings.take();
}

std::vector<Finding> check_plausibility(const Scene& scene, const Model* model) {
  Findings findings;
  check_scene(scene, findings);
  if (model != nullptr) check_start(scene, *model, findings);
  return findings.take();
}

}  // namespace repose
