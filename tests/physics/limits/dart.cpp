#include "tests/physics/engine_limits.hpp"

namespace repose::test {

std::span<const EngineLimit> dart_limits() { return {}; }

}  // namespace repose::test
