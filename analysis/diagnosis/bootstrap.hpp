#pragma once
/// Parametric bootstrap: recordings that the nominal model would give, diagnosed like the real ones.
#include <cstdint>
#include <functional>

#include "analysis/diagnosis/search.hpp"

namespace repose::diagnosis {

/// The bundle's runs of the fit, as the nominal fit predicts them and with new noise of the recorded size and correlation: for
/// replica `number`. What was not observed, or lies beyond a run's horizon, is missing in it.
Bundle replica_of(const Problem& problem, const Fit& nominal, std::uint64_t seed, std::uint64_t number);

/// Largest deviates (LackOfFit::deviate) of `replicas` such recordings, each with its own noise estimate, start values,
/// calibration, screening and location. Fewer after an interruption. `coarser_step`: as the problem was made with.
NullDistribution bootstrap(const Problem& problem, const Fit& nominal, const Simulate& simulate, int replicas, const SearchOptions& options,
                           bool coarser_step);

}  // namespace repose::diagnosis
