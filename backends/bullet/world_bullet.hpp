#pragma once
/// The Bullet backend: Bullet 3.24's broad phase, GJK and sequential impulses, stepped as Repose steps. See README.md.
#include <memory>
#include <string>
#include <vector>

#include "core/world.hpp"

namespace repose::bullet {

std::vector<std::string> unsupported(const Model& model);

/// Throws Error for the relaxed law, which only DVI has. Not used: `threads` (Bullet's sweeps run on one) and `kind`.
std::unique_ptr<World> make_world(const Model& model, const SolverOptions& options);

}  // namespace repose::bullet
