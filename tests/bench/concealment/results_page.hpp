#pragma once
/// The tables of a scored benchmark, as Markdown.
#include <string>
#include <vector>

#include "tests/bench/concealment/judged_case.hpp"

namespace repose::concealment {

/// `told`: lines about the conditions (commit, seeds), printed at the top.
std::string results_page(const std::vector<JudgedCase>& cases, const std::vector<std::string>& told);

}  // namespace repose::concealment
