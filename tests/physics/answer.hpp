#pragma once
/// A measured number beside the one known in closed form: checked, printed as a row of a table, and kept in the test's
/// report.
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/physics/engine_limits.hpp"

namespace repose::test {

struct Answer {
  std::string what;        ///< with its unit
  double closed_form = 0;  ///< of continuous time
  double measured = 0;
  double tolerance = 1e-9;  ///< relative, of DVI; other engines may be off by more: rule_of() in engine_limits.hpp
  /// What symplectic Euler with this step must give; NaN: the closed form itself.
  double discrete = std::numeric_limits<double>::quiet_NaN();
  double scale = 0;  ///< what errors are relative to; 0: the answer itself
};

inline void print_row(const std::string& what, double closed_form, double measured, double error, double tolerance) {
  char closed[32], value[32], off[32], allowed[32];
  std::snprintf(closed, sizeof closed, "%.9g", closed_form);
  std::snprintf(value, sizeof value, "%.9g", measured);
  std::snprintf(off, sizeof off, "%.1e", error);
  std::snprintf(allowed, sizeof allowed, "%.2g", tolerance);
  std::printf("| %s | %s | %s | %s | %s |\n", what.c_str(), closed, value, off, allowed);
  testing::Test::RecordProperty(what, std::string(value) + " (closed form " + closed + ", relative error " + off + ")");
}

/// Checks an error against the tolerance, or against the engine's row in its table of limits (engine_limits.hpp).
inline void expect_error(const std::string& what, double closed_form, double measured, double error, double tolerance,
                         const std::string& backend) {
  const EngineLimit* limit = find_limit(backend, what);
  print_row(what, closed_form, measured, error, limit ? limit->most : tolerance);
  if (!limit) {
    EXPECT_LE(error, tolerance) << what << ": measured " << measured << ", closed form " << closed_form;
    return;
  }
  EXPECT_LE(error, limit->most) << what << ": beyond the stated limit of " << backend << ": " << limit->why;
  EXPECT_GE(error, limit->least) << what << ": " << backend << " does better than its stated limit: correct the table";
}

inline void expect_answer(const Answer& answer, const std::string& backend = "dvi") {
  const EngineRule rule = rule_of(backend);
  const double wanted = rule.discrete && !std::isnan(answer.discrete) ? answer.discrete : answer.closed_form;
  const double scale = answer.scale > 0 ? answer.scale : std::abs(wanted);
  expect_error(answer.what, answer.closed_form, answer.measured, std::abs(answer.measured - wanted) / scale,
               std::max(answer.tolerance, rule.tolerance), backend);
}

/// A statement without a number, which a limit of the engine may deny (its error is then 1: a row with least = most = 1).
inline void expect_that(const std::string& what, bool holds, const std::string& backend) {
  const EngineLimit* limit = find_limit(backend, what);
  if (limit) {
    expect_error(what, 1, holds ? 1 : 0, holds ? 0 : 1, 0, backend);
  } else {
    EXPECT_TRUE(holds) << what;
  }
}

/// A measured number without a closed form, for the table.
inline void note(const std::string& what, double measured) {
  char value[32];
  std::snprintf(value, sizeof value, "%.6g", measured);
  std::printf("| %s | - | %s | - | - |\n", what.c_str(), value);
  testing::Test::RecordProperty(what, value);
}

}  // namespace repose::test
