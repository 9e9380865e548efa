#pragma once
/// The groups of checks behind plausibility.hpp. Internal.
///
/// A refusal is what no experiment can mean (a likely slip of unit or sign); a warning is what may be meant but often
/// goes wrong; a note is what one should know. The bounds stand as named constants beside each check.
#include <string>
#include <vector>

#include "core/plausibility.hpp"

namespace repose {

/// What the checks know of a population: sizes [m], mean mass of a grain [kg], number of grains.
struct PopulationFigures {
  const GrainPopulation* population = nullptr;
  double smallest = 0, typical = 0, largest = 0;  ///< typical: of the grain of mean volume
  double grain_mass = 0;
  double count = 0;
};

class Findings {
 public:
  void note(const std::string& place, const std::string& message);
  void warn(const std::string& place, const std::string& message, const std::string& remedy);
  void refuse(const std::string& place, const std::string& message, const std::string& remedy);
  std::vector<Finding> take() { return std::move(list_); }

 private:
  std::vector<Finding> list_;
};

std::vector<PopulationFigures> population_figures(const Scene& scene);

/// "58 um", "0.2 m", "30 nm".
std::string length_text(double metres);

void check_densities(const Scene& scene, Findings& findings);
/// False if a grain's size is absurd: then comparing it with tools only repeats the finding.
bool check_sizes(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);
void check_pairs(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);
void check_counts(const std::vector<PopulationFigures>& grains, Findings& findings);

void check_gravity_and_speeds(const Scene& scene, Findings& findings);
/// Step against sqrt(R/g), against R/speed and against the duration; frames; inertial number.
void check_step(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);
void check_cost(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);
/// Where air would matter but no effect brings it.
void check_air(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);

void check_funnels(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);
void check_bases(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);
void check_fills(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);
void check_support(const Scene& scene, Findings& findings);
/// A spreader that does not pass over the whole region that is measured, or so low that the largest grain does not fit under it.
void check_layer(const Scene& scene, const std::vector<PopulationFigures>& grains, Findings& findings);

/// Tools that cut into each other at time 0.
void check_tool_overlaps(const Scene& scene, Findings& findings);
/// Grains inside tools or above their funnel, bodies inside each other.
void check_start(const Scene& scene, const Model& model, Findings& findings);

}  // namespace repose
