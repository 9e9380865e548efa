#pragma once
/// What every primitive must fulfil before a shape is made of it.
#include <string>
#include <vector>

#include "core/shape.hpp"

namespace repose {

/// Throws Error naming the shape and the part: lengths positive and finite, unit quaternions, profiles counterclockwise
/// and without self-intersection, meshes closed and facing outward.
void validate_parts(const std::string& kind, const std::vector<Part>& parts);

}  // namespace repose
