#pragma once
/// compare.json: backends, observables with verdicts, where runs part, curves.
#include <nlohmann/json.hpp>

#include "scenarios/compare_results.hpp"

namespace repose {

/// {headline, backends {label: {...}}, observables [...] (compare_verdict.hpp), partings [...] (compare_where.hpp), seeds, grains, alpha}.
/// A backend: engine, runs, failed, grains, wall_s, steps, contacts_mean, solver {...}, max_penetration, unsupported: means over the seeds
/// (maxima where the name says so); curves {name: {x, mean, se}}: kinetic_energy and discharged_mass against time [s], heap_profile
/// [m] against radius [m].
nlohmann::json summarise_compare(const Comparison& comparison, const JobsReport& report);

}  // namespace repose
