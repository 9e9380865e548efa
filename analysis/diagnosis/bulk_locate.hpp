#pragma once
/// Where bulk observables differ: each curve in three parts, each part tested alone and corrected for all the others.
#include <optional>
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"

namespace repose::diagnosis {

struct BulkLocated {
  std::string observable, phase;      ///< phase: heap, flow or spread
  std::string quantity;               ///< "roughness": standard deviation of a surface's heights; empty: the mean
  std::optional<double> t_start, t_end;            ///< part of a series [s]
  std::optional<double> radius_from, radius_to;    ///< part of a profile [m]
  std::size_t run = 0;                ///< of the recorded ones, that which lies furthest from the simulated mean
  double difference = 0;              ///< recorded minus simulated, mean over the part, in the observable's unit
  double in_scatter = 0;              ///< the same in standard deviations of one run
  double p = 1;                       ///< of the test, corrected for all parts (Holm)
};

/// `recorded`, `simulated`: observations of replicates, sampled alike (bulk_sampling.hpp). The last profile is parted by radius, both flanks together, series by the time between 2 % and 98 % of the rise of
/// the simulated mean (the whole time if it does not rise); scalars stand whole, and so do surfaces, by mean height and roughness. Sorted by p. Tested by
/// Welch's t; a single recorded run by Student's t of one value more of the simulated sample, (x - mean) / (sd sqrt(1 + 1/n)) with n - 1 degrees of
/// freedom. Without a recorded run, or with fewer than two simulated ones, a part is left out.
std::vector<BulkLocated> locate_bulk(const std::vector<std::vector<Observation>>& recorded, const std::vector<std::vector<Observation>>& simulated);

}  // namespace repose::diagnosis
