#pragma once
/// How closely each engine is held to the answers, and what the engines that others wrote are known not to reach: one
/// visible table of limits per engine, each row with its reason.
///
/// A row replaces the tolerance of the answers it names, and is itself a claim: the error must lie between `least` and
/// `most`. An engine that gets better than its row fails the test as well, so that the table never goes stale. DVI has no
/// table.
#include <span>
#include <string>
#include <string_view>

namespace repose::test {

struct EngineLimit {
  std::string_view answer;  ///< the beginning of Answer::what; the longest row that fits counts
  double least = 0;         ///< of the error, relative as in Answer
  double most = 0;
  std::string_view why;     ///< one sentence: what the engine does instead
};

struct EngineRule {
  bool discrete = false;  ///< it steps by symplectic Euler: held to Answer::discrete where that is known
  double tolerance = 0;   ///< it may be off by this, or by the answer's own tolerance if that is wider
};

/// Of DVI and Bullet: the answer's own tolerance. Of an engine that nothing is said about: 3 % of the closed form.
EngineRule rule_of(std::string_view backend);

/// The row for an answer of a backend; nullptr: none, the usual tolerance holds.
const EngineLimit* find_limit(std::string_view backend, std::string_view answer);

// The tables: limits/<engine>.cpp.
std::span<const EngineLimit> bullet_limits();
std::span<const EngineLimit> dart_limits();

}  // namespace repose::test
