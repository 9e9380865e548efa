#pragma once
/// The few numbers that stand for what was observed of many grains. A packing is random grain by grain; only such numbers
/// repeat from one pour to the next, within their scatter.
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"

namespace repose::diagnosis {

/// One number of an observable.
struct BulkSummary {
  std::string name;        ///< "discharge_rate"
  std::string observable;  ///< "discharged_mass": name of the observation that it is made of
  std::string phase;       ///< "heap", "flow" or "spread": what the grains do there
  std::string unit;
};

/// The summaries that these observations allow, the most telling ones first; the order is fixed and knows nothing of values:
///
///   angle_of_repose          as measured [deg]
///   discharge_rate           slope of the mass through the outlet between 20 % and 80 % of it
///   heap_apex                mean height within the inner third of the profile, by area [m]
///   heap_volume              2 pi int r h dr [m^3]
///   heap_slope               of the line through 20 % to 80 % of the profile's reach, downwards [deg]; in front without an angle
///   heap_concavity           slope of the inner half of that stretch minus that of the outer half [deg]
///   discharge_delay          when a tenth of the mass is through [s]
///   poured_mass              through the outlet in the end
///   load_on_base             mean of the last tenth of `mass_on_base`
///   <series>_mean, <series>_sd   of surface_angle and the roller's loads: the scatter of a drum's angle is its avalanches
///   <surface>_sd, <surface>_mean roughness and height [m]
///
/// Other scalars stand for themselves. Trajectories and series of single bodies have none.
std::vector<BulkSummary> summaries_of(const std::vector<Observation>& observations);

/// At most three, chosen beforehand: the first of each observable, then those that follow.
std::vector<BulkSummary> three_of(const std::vector<BulkSummary>& all);

/// NaN if these observations do not hold it, or if it cannot be measured (no angle, nothing discharged).
double value_of(const BulkSummary& summary, const std::vector<Observation>& observations);

}  // namespace repose::diagnosis
