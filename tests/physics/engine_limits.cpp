#include "tests/physics/engine_limits.hpp"

namespace repose::test {

const EngineLimit* find_limit(std::string_view backend, std::string_view answer) {
  std::span<const EngineLimit> table;
  if (backend == "bullet") table = bullet_limits();
  if (backend == "dart") table = dart_limits();
  const EngineLimit* found = nullptr;
  for (const EngineLimit& row : table)
    if (answer.starts_with(row.answer) && (!found || row.answer.size() > found->answer.size())) found = &row;
  return found;
}

}  // namespace repose::test
