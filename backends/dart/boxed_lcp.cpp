#include "backends/dart/boxed_lcp.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <dart/constraint/DantzigBoxedLcpSolver.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>

namespace repose::dart {

namespace {

namespace engine = ::dart;

constexpr int most_rows_to_pivot = 600;  // beyond, sweeps are ten times cheaper
constexpr int sweeps_at_once = 20;       // of Gauss-Seidel

/// DART's solvers overwrite what they are given.
struct Scratch {
  std::vector<double> a, b, lo, hi;
  std::vector<int> parent;

  explicit Scratch(const BoxedLcp& p)
      : a(p.a.begin(), p.a.end()),
        b(p.b.begin(), p.b.end()),
        lo(p.lo.begin(), p.lo.end()),
        hi(p.hi.begin(), p.hi.end()),
        parent(p.parent.begin(), p.parent.end()) {}
};

struct Bounds {
  double lo, hi;
};

Bounds bounds_of(const BoxedLcp& p, std::span<const double> x, std::size_t i) {
  const int k = p.parent[i];
  const double scale = k < 0 ? 1.0 : std::max(x[static_cast<std::size_t>(k)], 0.0);
  return {k < 0 ? p.lo[i] : p.lo[i] * scale, k < 0 ? p.hi[i] : p.hi[i] * scale};
}

bool finite(std::span<const double> x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}

/// One pass of pivoting: with DART's own bounds, or with those of the normal impulses `normal`. `nudge` times the
/// largest of them is added to the entries of b, a little more to each than to the last.
bool pivot(const BoxedLcp& p, std::span<const double> normal, double nudge, std::span<double> x) {
  Scratch s(p);
  if (!normal.empty())
    for (std::size_t i = 0; i < s.lo.size(); ++i) {
      if (p.parent[i] < 0) continue;
      const Bounds bounds = bounds_of(p, normal, i);
      s.lo[i] = bounds.lo;
      s.hi[i] = bounds.hi;
      s.parent[i] = -1;
    }
  double largest = 0;
  for (const double b : p.b) largest = std::max(largest, std::abs(b));
  for (std::size_t i = 0; i < s.b.size(); ++i)
    s.b[i] += nudge * largest * (1 + static_cast<double>(i) / static_cast<double>(s.b.size()));
  std::fill(x.begin(), x.end(), 0.0);
  engine::constraint::DantzigBoxedLcpSolver dantzig;
  const bool done =
      dantzig.solve(p.rows, s.a.data(), x.data(), s.b.data(), 0, s.lo.data(), s.hi.data(), s.parent.data(), true);
  return done && finite(x);
}

/// DART's pivoting gives up where two choices are equally good: blocks that all just touch and fall alike. Then the tie
/// is broken.
bool pivot(const BoxedLcp& p, std::span<const double> normal, std::span<double> x) {
  for (const double nudge : {0.0, 1e-12, 1e-10, 1e-8})
    if (pivot(p, normal, nudge, x)) return true;
  return false;
}

void sweep(const BoxedLcp& p, std::span<double> x) {
  Scratch s(p);
  engine::constraint::PgsBoxedLcpSolver gauss_seidel;
  gauss_seidel.setOption({sweeps_at_once, 0.0, 0.0, 0.0, false});
  gauss_seidel.solve(p.rows, s.a.data(), x.data(), s.b.data(), 0, s.lo.data(), s.hi.data(), s.parent.data(), false);
}

/// The best point so far.
struct Best {
  std::vector<double> x;
  double residual = HUGE_VAL;

  bool offer(const BoxedLcp& p, std::span<const double> point) {
    const double r = repose::dart::residual(p, point);
    if (!(r < residual)) return false;
    residual = r;
    x.assign(point.begin(), point.end());
    return true;
  }
};

}  // namespace

double residual(const BoxedLcp& p, std::span<const double> x) {
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double* row = p.a.data() + i * static_cast<std::size_t>(p.stride);
    double w = -p.b[i];
    for (std::size_t j = 0; j < x.size(); ++j) w += row[j] * x[j];
    const Bounds bounds = bounds_of(p, x, i);
    worst = std::max(worst, row[i] * std::abs(x[i] - std::clamp(x[i] - w / row[i], bounds.lo, bounds.hi)));
    largest = std::max(largest, row[i] * std::abs(x[i]));
  }
  return worst > 0 ? worst / std::max(largest, worst) : 0.0;
}

LcpReport solve(const BoxedLcp& p, double tolerance, int max_passes, std::span<double> x) {
  LcpReport report;
  Best best;
  std::vector<double> normal;  // impulses whose bounds the next pass takes; none: DART's own
  for (; report.passes < max_passes && best.residual > tolerance; ++report.passes) {
    if (p.rows <= most_rows_to_pivot && pivot(p, normal, x)) {
      best.offer(p, x);
    } else {
      report.swept = true;
      if (best.x.empty())
        std::fill(x.begin(), x.end(), 0.0);
      else
        std::copy(best.x.begin(), best.x.end(), x.begin());
    }
    // As many sweeps as cost about what pivoting did.
    for (int done = 0; done < std::max(sweeps_at_once, p.rows / 8) && best.residual > tolerance;
         done += sweeps_at_once) {
      sweep(p, x);
      if (!finite(x)) break;
      best.offer(p, x);
    }
    normal.assign(x.begin(), x.end());
  }
  if (best.x.empty()) best.x.assign(x.size(), 0.0), best.residual = residual(p, best.x);
  std::copy(best.x.begin(), best.x.end(), x.begin());
  report.residual = best.residual;
  report.converged = best.residual <= tolerance;
  return report;
}

}  // namespace repose::dart
