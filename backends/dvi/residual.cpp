#include "backends/dvi/residual.hpp"

#include <cmath>
#include <limits>

#include "backends/dvi/batch_kernels.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

template <class Real>
double residual(const PackedProblem<Real>& packed, ContactLaw law, int threads) {
  const auto batches = static_cast<std::ptrdiff_t>(packed.batches.size());
  // Partial sums per block of batches, added in order: the same bits at any thread count.
  constexpr std::ptrdiff_t block = 64;
  const std::ptrdiff_t blocks = (batches + block - 1) / block;
  std::vector<double> part(static_cast<std::size_t>(3 * blocks));
  with_rows(packed, [&](auto rotational) {
    constexpr bool rows = decltype(rotational)::value;
    on_team(threads, [&] {
#pragma omp for schedule(static)
      for (std::ptrdiff_t j = 0; j < blocks; ++j) {
        Lanes<Real> error{}, size{};
        double error_sum = 0, size_sum = 0, motion_sum = 0;
        for (std::ptrdiff_t i = j * block; i < std::min((j + 1) * block, batches); ++i) {
          const Batch<Real>& c = packed.batches[static_cast<std::size_t>(i)];
          constexpr int n = rows ? 6 : 3;
          Lanes<Real> va[3], wa[3], vb[3], wb[3], t2[3], u[6], g[6];
          gather_velocity<Real>(packed.velocity.data(), c.a, va, wa);
          gather_velocity<Real>(packed.velocity.data(), c.b, vb, wb);
          second_tangent<Real>(c, t2);
          relative_velocity<Real, rows>(c, t2, packed.across, va, wa, vb, wb, u);
          Lanes<Real> motion{};
          for (int k = 0; k < n; ++k) motion += u[k] * u[k];
          motion_sum += lane_sum<Real>(c.w[0] > Lanes<Real>{} ? motion / c.w[0] : Lanes<Real>{});
          u[0] += c.bias;
          add_compliance<Real>(packed, static_cast<std::size_t>(i), c.impulse[0], u[0]);
          if (law == ContactLaw::exact) u[0] += de_saxce<Real, rows>(c, u);
          const Lanes<Real> inverse = Real(1) / c.w[0];
          for (int k = 0; k < n; ++k) g[k] = c.impulse[k] - inverse * u[k];
          project<Real, rows>(c, g);
          error = size = Lanes<Real>{};
          for (int k = 0; k < n; ++k) {
            const Lanes<Real> r = c.impulse[k] - g[k];
            error += r * r;
            size += c.impulse[k] * c.impulse[k];
          }
          error_sum += lane_sum<Real>(c.w[0] * error);
          size_sum += lane_sum<Real>(c.w[0] * size);
        }
        part[static_cast<std::size_t>(3 * j)] = error_sum;
        part[static_cast<std::size_t>(3 * j + 1)] = size_sum;
        part[static_cast<std::size_t>(3 * j + 2)] = motion_sum;
      }
    });
  });
  double error = 0, size = 0, motion = 0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(blocks); ++j) {
    error += part[3 * j];
    size += part[3 * j + 1];
    motion += part[3 * j + 2];
  }
  if (error == 0) return 0;
  constexpr double rounding = 4 * static_cast<double>(std::numeric_limits<Real>::epsilon());
  // Contacts that slide without pressure leave the rounding of their slip, and next to nothing to compare it with.
  if (std::sqrt(error) <= rounding * std::sqrt(motion)) return 0;
  return std::sqrt(error) / std::max(std::sqrt(size), std::max(rounding * packed.kinetic_scale, std::numeric_limits<double>::min()));
}

template double residual(const PackedProblem<double>&, ContactLaw, int);
template double residual(const PackedProblem<float>&, ContactLaw, int);

}  // namespace repose::dvi
