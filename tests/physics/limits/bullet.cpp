#include <array>

#include "tests/physics/engine_limits.hpp"

namespace repose::test {

namespace {

constexpr std::string_view slow_sweeps =
    "it sweeps over single rows: a stack under a thousandfold weight, or of cubes, is not solved to 1e-6 in 10000 sweeps";

constexpr std::string_view driven =
    "grains that a third drives together within one step overlap by a share of what they move in it, here d / 4";

constexpr std::array<EngineLimit, 10> limits{{
    {"drum, Froude number 0.003: surface angle [deg], standard error", 0, 3,
     "slow avalanches, of which the four quarters of the run see few: 0.8 and 1.7 in two builds; the angle is that of DVI"},
    {"ten spheres, top 1000 x, Barzilai-Borwein to 1e-6: residual", 2e-6, 1e-4, slow_sweeps},
    {"ten spheres, top 1000 x, Barzilai-Borwein to 1e-6: mean base load / weight", 1.1e-3, 1e-2, slow_sweeps},
    {"ten cubes, top 1 x, Barzilai-Borwein to 1e-6: residual", 2e-6, 1e-4, slow_sweeps},
    {"ten cubes, top 10 x, Barzilai-Borwein to 1e-6: residual", 2e-6, 1e-4, slow_sweeps},
    {"ten cubes, top 100 x, Barzilai-Borwein to 1e-6: residual", 2e-6, 1e-4, slow_sweeps},
    {"ten cubes, top 1000 x, Barzilai-Borwein to 1e-6: residual", 2e-6, 1e-4, slow_sweeps},
    {"ten cubes, top 1000 x, Barzilai-Borwein to 1e-6: mean base load / weight", 1.1e-3, 1e-2, slow_sweeps},
    {"frictionless spheres: deepest overlap while poured / d", 1e-2, 0.1, driven},
    {"spheres, mu = 0.5: deepest overlap while poured / d", 1e-2, 0.1, driven},
}};

}  // namespace

std::span<const EngineLimit> bullet_limits() { return limits; }

}  // namespace repose::test
