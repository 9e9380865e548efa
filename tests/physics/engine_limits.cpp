#include "tests/physics/engine_limits.hpp"

namespace repose::test {

EngineRule rule_of(std::string_view backend) {
  if (backend == "dvi") return {true, 0};
  if (backend == "bullet") return {true, 0};
  if (backend == "dart") return {true, 1e-8};  // a share of 1e-9 of each approach is left
  return {false, 0.03};
}

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
