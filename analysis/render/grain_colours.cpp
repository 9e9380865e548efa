#include "analysis/render/grain_colours.hpp"

#include <algorithm>

#include "analysis/render/palette.hpp"
#include "core/grain_shape.hpp"

namespace repose {

GrainColours::GrainColours(const Model& model, bool by_population) : model_(model) {
  if (!by_population) return;
  for (const Body& body : model.bodies)
    if (body.role == BodyRole::grain && body.name >= 0) population_.try_emplace(body.name, 0);
  std::size_t number = 0;
  for (auto& [name, at] : population_) at = number++;
}

bool GrainColours::has_population(std::size_t body) const { return population_.contains(model_.bodies[body].name); }

Vec3 GrainColours::colour(std::size_t body) const {
  if (has_population(body)) return population_colour(population_.at(model_.bodies[body].name));
  return shape_colour(model_.shapes[static_cast<std::size_t>(model_.bodies[body].shape)].kind);
}

std::string GrainColours::label(std::size_t body) const {
  if (has_population(body)) return model_.names[static_cast<std::size_t>(model_.bodies[body].name)];
  return shape_label(model_.shapes[static_cast<std::size_t>(model_.bodies[body].shape)].kind);
}

std::size_t GrainColours::rank(std::size_t body) const {
  if (has_population(body)) return population_.at(model_.bodies[body].name);
  const auto& names = grain_shape_names();
  const std::string& kind = model_.shapes[static_cast<std::size_t>(model_.bodies[body].shape)].kind;
  return population_.size() + static_cast<std::size_t>(std::find(names.begin(), names.end(), kind) - names.begin());
}

}  // namespace repose
