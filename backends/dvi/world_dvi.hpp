#pragma once
/// The DVI backend: velocity-level time stepping with the exact Coulomb law, rolling and spinning friction, cohesion.
#include <memory>
#include <string>
#include <vector>

#include "core/world.hpp"

namespace repose::dvi {

std::vector<std::string> unsupported(const Model& model);
std::unique_ptr<World> make_world(const Model& model, const SolverOptions& options);

}  // namespace repose::dvi
