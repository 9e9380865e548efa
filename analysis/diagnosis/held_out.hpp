#pragma once
/// Runs that no fit has seen: what a fitted hypothesis makes of them, physics frozen, start values free.
#include <functional>
#include <vector>

#include "analysis/diagnosis/fit.hpp"

namespace repose::diagnosis {

/// Fits of the start values of `runs` under each of the fitted hypotheses. An impact soon after the start can hold a fit far from its
/// optimum, and a hypothesis would fail for its optimiser: where another hypothesis fits a run better, its start values are tried, too.
/// Their degrees of freedom count no shared parameter: none was turned. `told`: after each hypothesis.
std::vector<Fit> held_out_fits(const Problem& problem, const std::vector<const Fit*>& hypotheses, const std::vector<std::size_t>& runs,
                               const FitOptions& options, const std::function<void(std::size_t done)>& told);

}  // namespace repose::diagnosis
