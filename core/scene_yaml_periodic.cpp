#include <fmt/format.h>

#include "core/scene_yaml_blocks.hpp"

namespace repose {

void read_periodic(const YamlReader& block, Scene& scene) {
  if (block.node().kind == YamlNode::Kind::map && block.has("z"))
    block.at("z").fail("gravity acts along z: what falls out of the cell would fall for ever",
                       "only x and y can be periodic");
  block.only({"x", "y"});
  const char* names[] = {"x", "y"};
  for (int axis = 0; axis < 2; ++axis) {
    if (!block.has(names[axis])) continue;
    const YamlReader bounds = block.at(names[axis]);
    if (scene.periodic.along(axis)) bounds.fail("`layer.sides` makes this axis periodic already", "leave one of the two out");
    const std::vector<double> pair = bounds.numbers(any(dimension::length), 2);
    if (!(pair[0] < pair[1]))
      bounds.fail(fmt::format("the upper bound, {:.6g} m, is not above the lower, {:.6g} m", pair[1], pair[0]),
                  "write [lower, upper]");
    scene.periodic.lower[axis] = pair[0];
    scene.periodic.upper[axis] = pair[1];
  }
  if (!scene.periodic.any()) block.fail("it names no axis", "write e.g. periodic: {y: [0, 1 mm]}, or leave it out");
}

}  // namespace repose
