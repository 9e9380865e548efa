#pragma once
/// The recorded side of a bulk diagnosis: runs of equal settings together, some of them held out.
#include "analysis/diagnosis/bulk_posterior.hpp"

namespace repose::diagnosis {

/// Summaries that every run has and that are not 0 in all of them, runs grouped by their settings. If no run says whether it is held out, a third of the runs of each setting with
/// three or more is, chosen by the seed. A stated error of a scalar counts where fewer than three runs show the scatter themselves.
/// `notes`: what was left out, and the split. Throws Error if no summary is left.
BulkData bulk_data(const Bundle& bundle, std::uint64_t seed, std::vector<std::string>& notes);

/// The bundle with every series cut where the shortest one of its setting ends (its last value): a mass in the end, or a load, is that of the end,
/// and runs of one setting are compared with the same simulations. Profiles of heaps likewise: all are read at the places of the one that ends first, and none
/// beyond the plate, where simulations end. `notes`: series and profiles that are longer by more than 5 %; profiles that leave out much of the plate.
Bundle of_equal_length(Bundle bundle, std::vector<std::string>& notes);

}  // namespace repose::diagnosis
