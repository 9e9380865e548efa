#include "backends/dvi/slip_law.hpp"

#include <algorithm>
#include <cmath>

#include "backends/dvi/batch_kernels.hpp"
#include "backends/dvi/team.hpp"
#include "core/contact_effects.hpp"

namespace repose::dvi {

namespace {

constexpr int halvings = 100;
constexpr double root_width = 1e-15;

/// The root of mu = law(max(0, slip + response (held - mu pressure))), by bisection.
double consistent_friction(const SlipLaw& law, double friction, double slip, double response, double held,
                           double pressure) {
  const auto at = [&](double s) { return rate_dependent_friction(law.slope, friction, s / law.speed); };
  if (!(pressure > 0)) return at(slip);
  double low = at(0), high = at(slip + response * held);
  for (int i = 0; i < halvings && high - low > root_width * high; ++i) {
    const double mu = 0.5 * (low + high);
    (mu < at(std::max(0.0, slip + response * (held - mu * pressure))) ? low : high) = mu;
  }
  return 0.5 * (low + high);
}

}  // namespace

template <class Real>
void renew_friction(PackedProblem<Real>& packed, const ConeProblem& problem, int threads) {
  const SlipLaw& law = problem.slip_law;
  if (law.slope == 0) return;
  const auto batches = static_cast<std::ptrdiff_t>(packed.batches.size());
  on_team(threads, [&] {
#pragma omp for schedule(static)
    for (std::ptrdiff_t i = 0; i < batches; ++i) {
      Batch<Real>& c = packed.batches[static_cast<std::size_t>(i)];
      Lanes<Real> va[3], wa[3], vb[3], wb[3], t2[3], u[6];
      gather_velocity<Real>(packed.velocity.data(), c.a, va, wa);
      gather_velocity<Real>(packed.velocity.data(), c.b, vb, wb);
      second_tangent<Real>(c, t2);
      relative_velocity<Real, false>(c, t2, packed.across, va, wa, vb, wb, u);
      for (int l = 0; l < PackedProblem<Real>::lanes; ++l) {
        const std::int32_t index = packed.contact[static_cast<std::size_t>(i * PackedProblem<Real>::lanes + l)];
        if (index < 0) continue;
        // Slip and friction in space: row 2 is scaled.
        const double across = static_cast<double>(packed.across);
        const double slip = std::hypot(static_cast<double>(u[1][l]), static_cast<double>(u[2][l]) / across);
        const double held = std::hypot(static_cast<double>(c.impulse[1][l]), static_cast<double>(c.impulse[2][l]));
        c.friction[l] = static_cast<Real>(consistent_friction(law, law.friction[static_cast<std::size_t>(index)], slip,
                                                              static_cast<double>(c.w[block_index(1, 1)][l]), held,
                                                              static_cast<double>(c.impulse[0][l] + c.cohesion[l])));
      }
    }
  });
}

template void renew_friction(PackedProblem<double>&, const ConeProblem&, int);
template void renew_friction(PackedProblem<float>&, const ConeProblem&, int);

}  // namespace repose::dvi
