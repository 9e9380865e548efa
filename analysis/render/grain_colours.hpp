#pragma once
/// Which colour a body that moves has in a picture, and what the legend calls it.
#include <map>
#include <string>

#include "core/model.hpp"

namespace repose {

/// By the shape of a body; or, `by_population`, by the population that a grain is of, in the order of the scene, so that one sees
/// where the grains of a pile go on a bed of the same grains. Bodies that are no grains keep the colour of their shape.
class GrainColours {
 public:
  GrainColours(const Model& model, bool by_population);

  Vec3 colour(std::size_t body) const;
  std::string label(std::size_t body) const;
  /// Where it stands in a legend: the seven grain shapes first, or the populations in order.
  std::size_t rank(std::size_t body) const;

 private:
  bool has_population(std::size_t body) const;
  const Model& model_;
  std::map<int, std::size_t> population_;  ///< by name; empty: by shape
};

}  // namespace repose
