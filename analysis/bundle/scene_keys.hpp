#pragma once
/// Keys of a scene as bundles name them, "effects.linear_drag.viscosity".
#include <string>

namespace repose {

/// Do both set the same number, or does one hold the other?
inline bool overlap(const std::string& a, const std::string& b) { return a == b || a.starts_with(b + ".") || b.starts_with(a + "."); }

}  // namespace repose
