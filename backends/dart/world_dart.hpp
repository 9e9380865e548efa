#pragma once
/// DART as a reference: its collision detector (FCL) and its solver of complementarity problems behind Repose's
/// interface.
#include <memory>
#include <string>
#include <vector>

#include "core/world.hpp"

namespace repose::dart {

std::vector<std::string> unsupported(const Model& model);

/// Of the options, `tolerance` is the residual to reach (boxed_lcp.hpp), `max_iterations` the most passes (at most 60 are
/// made) and `search_margin` that of pairs that FCL is not asked about. DART runs on one thread and starts every step cold;
/// the choice of a method is DVI's. Throws Error if the relaxed law is asked for, and in a step of more than 10,000 rows.
std::unique_ptr<World> make_world(const Model& model, const SolverOptions& options);

}  // namespace repose::dart
