#pragma once
/// Independent tasks on some threads.
#include <cstddef>
#include <functional>

namespace repose {

/// Calls task(i) for all i < count; the first exception is thrown again.
void side_by_side(std::size_t count, int threads, const std::function<void(std::size_t)>& task);

}  // namespace repose
