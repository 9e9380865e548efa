#pragma once
/// The one visible table of backends.
#include <span>
#include <string_view>

#include "core/world.hpp"

namespace repose {

std::span<const Backend> backends();

/// The named backend; an Error that lists the names if there is none.
const Backend& find_backend(std::string_view name);

}  // namespace repose
