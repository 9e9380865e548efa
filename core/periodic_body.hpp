#pragma once
/// How the bodies of a model live with its periodic cell. Knows shapes, no engine.
///
/// Let D be the diameter of the ball that encloses the largest moving body, plus the widest range of cohesion, and L the
/// period along an axis. Sound is:
///   - L >= 3 D: two moving bodies then meet through one pair of images, and none meets itself;
///   - moving bodies start in the cell (realise() takes them there; a world keeps them there);
///   - a fixed or prescribed body is either *endless* along the axis: it looks the same after any shift, at least from D below
///     the cell to D above it, for all times (a half-space, a box, cylinder, roller or drum that reaches that far); or
///     *repeated* like a grain: it starts in the cell, and reaches no farther than L/2 - D from its position along the
///     axis, so that a moving body meets one image of it alone. All else is refused: an edge that ends in the cell beside
///     its own image would be a gap or a step that nobody meant.
#include <cstddef>

#include "core/model.hpp"

namespace repose {

/// Least period in units of D.
inline constexpr double least_period = 3;

/// True if the fixed or prescribed body is endless along the periodic axis (0: x, 1: y). Moving bodies never are.
bool is_endless(const Model& model, std::size_t body, int axis);

/// Throws Error, with the remedy in numbers, unless all of the above holds. Free if the model is not periodic. All other
/// rules of the model must hold.
void check_periodic(const Model& model);

}  // namespace repose
