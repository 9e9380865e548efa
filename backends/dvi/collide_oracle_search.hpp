#pragma once
/// Slow, derivative-free searches for the oracle: dense samples, then a compass search from the best of them.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/math.hpp"

namespace repose::dvi::oracle {

/// Least value of f over the unit sphere.
template <class F>
double minimum_over_directions(const F& f, int samples = 1500, int starts = 6) {
  std::vector<std::pair<double, Vec3>> ring;
  ring.reserve(static_cast<std::size_t>(samples));
  for (int k = 0; k < samples; ++k) {  // a Fibonacci sphere
    const double z = 1 - (2.0 * k + 1) / samples, r = std::sqrt(1 - z * z), angle = 2.39996322972865332 * k;
    const Vec3 n(r * std::cos(angle), r * std::sin(angle), z);
    ring.emplace_back(f(n), n);
  }
  const auto by_value = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::partial_sort(ring.begin(), ring.begin() + starts, ring.end(), by_value);
  double best = ring.front().first;
  for (int k = 0; k < starts; ++k) {
    auto [value, n] = ring[static_cast<std::size_t>(k)];
    double step = 0.1;
    Vec3 last = Vec3::Zero();  // the last successful move: it points along the ridge
    for (int round = 0; round < 600 && step > 1e-9; ++round) {
      const Vec3 u = n.cross(std::abs(n.z()) < 0.8 ? Vec3::UnitZ() : Vec3::UnitX()).normalized(), v = n.cross(u);
      bool better = false;
      for (int spoke = -1; spoke < 24 && !better; ++spoke) {
        // The spokes turn from round to round, to find the narrow way along a ridge.
        const double angle = 0.261799387799149437 * (spoke + 0.618033988749895 * round);
        const Vec3 move = spoke < 0 ? Vec3(1.5 * last) : Vec3(step * (std::cos(angle) * u + std::sin(angle) * v));
        const Vec3 trial = (n + move).normalized();
        const double there = f(trial);
        if (there < value) {
          value = there;
          last = trial - n;
          n = trial;
          better = true;
        }
      }
      if (!better) last *= 0.3;
      step = better ? std::min(0.2, 1.5 * step) : 0.6 * step;
    }
    best = std::min(best, value);
  }
  return best;
}

/// Least value of f over the unit cube [0, 1]^N.
template <int N, class F>
double minimum_over_cube(const F& f, int per_side, int starts = 8) {
  using Point = std::array<double, N>;
  std::vector<std::pair<double, Point>> grid;
  int total = 1;
  for (int i = 0; i < N; ++i) total *= per_side;
  for (int k = 0; k < total; ++k) {
    Point p;
    int rest = k;
    for (double& x : p) {
      x = static_cast<double>(rest % per_side) / (per_side - 1);
      rest /= per_side;
    }
    grid.emplace_back(f(p), p);
  }
  starts = std::min(starts, total);
  const auto by_value = [](const auto& a, const auto& b) { return a.first < b.first; };
  std::partial_sort(grid.begin(), grid.begin() + starts, grid.end(), by_value);
  double best = grid.front().first;
  for (int k = 0; k < starts; ++k) {
    auto [value, p] = grid[static_cast<std::size_t>(k)];
    double step = 1.0 / (per_side - 1);
    for (int round = 0; round < 600 && step > 1e-9; ++round) {
      bool better = false;
      for (int spoke = 0; spoke < 6 * N && !better; ++spoke) {
        Point trial = p;
        // Axes first, then a fixed quasi-random set of directions.
        if (spoke < 2 * N) {
          double& x = trial[static_cast<std::size_t>(spoke / 2)];
          x = std::clamp(x + (spoke % 2 == 0 ? step : -step), 0.0, 1.0);
        } else {
          double seed = 0.5 + 0.754877666246693 * (spoke + 37.0 * round);
          for (double& x : trial) {
            seed = (seed + 0.569840290998053) * 1.324717957244746;
            x = std::clamp(x + step * (2 * (seed - std::floor(seed)) - 1), 0.0, 1.0);
          }
        }
        const double there = f(trial);
        if (there < value) {
          value = there;
          p = trial;
          better = true;
        }
      }
      step = better ? std::min(0.2, 1.5 * step) : 0.6 * step;
    }
    best = std::min(best, value);
  }
  return best;
}

}  // namespace repose::dvi::oracle
