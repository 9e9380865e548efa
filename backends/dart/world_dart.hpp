#pragma once
/// DART as a reference: its collision detector (FCL) and its solver of complementarity problems behind Repose's interface.
#include <memory>
#include <string>
#include <vector>

#include "core/world.hpp"

namespace repose::dart {

std::vector<std::string> unsupported(const Model& model);

/// Of the options, `time_step`, `tolerance` and `max_iterations` have a meaning here: the residual to reach, and the most
/// passes of pivoting (boxed_lcp.hpp). DART runs on one thread and starts every step cold.
std::unique_ptr<World> make_world(const Model& model, const SolverOptions& options);

}  // namespace repose::dart
