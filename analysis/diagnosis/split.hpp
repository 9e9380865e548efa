#pragma once
/// Which runs are fitted, and which are kept for judging.
#include <string>
#include <vector>

#include "analysis/bundle/bundle.hpp"

namespace repose::diagnosis {

struct Split {
  std::vector<std::size_t> train, held;  ///< of the bundle's runs
};

/// As the bundle says; else a third of the runs (at least one of two) is held out, chosen by the seed. At most the given numbers of each,
/// evenly spread over the list. What was chosen and left out is added to `notes`. Throws Error if nothing is left to fit.
Split split_runs(const Bundle& bundle, int max_train, int max_held, std::uint64_t seed, std::vector<std::string>& notes);

}  // namespace repose::diagnosis
