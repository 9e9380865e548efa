#pragma once
/// Test support: the smallest scene that recordings can be of.
#include <string>

namespace repose {

inline const std::string dropped_ball_scene = R"(materials: {steel: {density: 7800}}
pairs: {steel-steel: {friction: 0.3}}
shapes: {ball: {type: sphere, radius: 0.02}, floor: {type: half_space}}
bodies:
  ball: {shape: ball, material: steel, position: [0, 0, 1], velocity: [0.3, 0, 0]}
  floor: {shape: floor, material: steel, fixed: true}
solver: {time_step: 1 ms, tolerance: 1.0e-6}
duration: 0.3
)";

}  // namespace repose
