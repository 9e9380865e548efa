#pragma once
/// A heap of known angle, for tests: a random packing cut to a cone.
///
/// The packing is a periodic cube of spheres from random points whose overlaps were pushed apart; its volume fraction is
/// about 0.58. The cone keeps every sphere whose centre is below z = apex - tan(angle) r: so it is rough on the scale of
/// a grain, as a poured heap is, and its mean slope is exact.
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "analysis/heap_profile.hpp"
#include "analysis/neighbour_grid.hpp"

namespace repose::synthetic {

struct Packing {
  double side = 0;               ///< of the periodic cube, in mean diameters
  std::vector<Vec3> centre;      ///< in [0, side)^3
  std::vector<double> radius;
};

/// `spread`: relative standard deviation of the diameter, truncated at two of them.
inline Packing make_packing(std::uint64_t seed, std::size_t count = 1500, double spread = 0.25) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, 1);
  Packing p;
  double volume = 0, largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    double x = normal(random);
    while (std::abs(x) > 2) x = normal(random);
    p.radius.push_back(0.5 * (1 + spread * x));
    volume += 4 * std::numbers::pi / 3 * std::pow(p.radius.back(), 3);
    largest = std::max(largest, p.radius.back());
  }
  p.side = std::cbrt(volume / 0.58);
  for (std::size_t i = 0; i < count; ++i) p.centre.push_back(p.side * Vec3(uniform(random), uniform(random), uniform(random)));
  const int cells = static_cast<int>(p.side / (2 * largest));
  const double cell = p.side / cells;
  std::vector<std::vector<int>> members(static_cast<std::size_t>(cells * cells * cells));
  const auto wrap = [&](int c) { return (c + cells) % cells; };
  for (int sweep = 0; sweep < 60; ++sweep) {
    for (auto& m : members) m.clear();
    const auto cell_of = [&](const Vec3& x) {
      return Eigen::Vector3i(std::min(cells - 1, static_cast<int>(x.x() / cell)), std::min(cells - 1, static_cast<int>(x.y() / cell)),
                             std::min(cells - 1, static_cast<int>(x.z() / cell)));
    };
    for (std::size_t i = 0; i < count; ++i) {
      const auto c = cell_of(p.centre[i]);
      members[static_cast<std::size_t>((c.z() * cells + c.y()) * cells + c.x())].push_back(static_cast<int>(i));
    }
    std::vector<Vec3> push(count, Vec3::Zero());
    for (std::size_t i = 0; i < count; ++i) {
      const auto c = cell_of(p.centre[i]);
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x)
            for (int m : members[static_cast<std::size_t>((wrap(c.z() + z) * cells + wrap(c.y() + y)) * cells + wrap(c.x() + x))]) {
              const std::size_t j = static_cast<std::size_t>(m);
              if (j == i) continue;
              Vec3 gap = p.centre[i] - p.centre[j];
              for (int k = 0; k < 3; ++k) gap[k] -= p.side * std::round(gap[k] / p.side);
              const double distance = gap.norm(), overlap = p.radius[i] + p.radius[j] - distance;
              if (overlap > 0 && distance > 0) push[i] += 0.4 * overlap / distance * gap;
            }
    }
    for (std::size_t i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) {
        double& x = p.centre[i][k];
        x += push[i][k];
        x -= p.side * std::floor(x / p.side);
        if (x >= p.side) x = 0;
      }
  }
  return p;
}

struct Heap {
  Model model;
  Snapshot state;
  HeapSite site;
};

inline Shape unit_sphere() {
  Shape s;
  s.kind = "sphere";
  s.parts = {Part{Sphere{1}, {}}};
  s.mass.volume = 4 * std::numbers::pi / 3;
  s.bounding_radius = 1;
  return s;
}

inline void add_sphere(Heap& heap, const Vec3& centre, double radius) {
  Body b;
  b.scale = b.radius = radius;
  b.volume = 4 * std::numbers::pi / 3 * std::pow(radius, 3);
  b.mass = 1000 * b.volume;
  b.inertia = Vec3::Constant(0.4 * b.mass * radius * radius);
  b.role = BodyRole::grain;
  heap.model.bodies.push_back(b);
  heap.state.position.push_back(centre);
  heap.state.orientation.push_back(Quat::Identity());
  heap.state.velocity.push_back(Vec3::Zero());
  heap.state.angular_velocity.push_back(Vec3::Zero());
}

inline Heap empty_heap(double radius) {
  Heap heap;
  heap.site = {Vec3::Zero(), radius, 0};
  heap.model.materials = {{"powder", 1000}};
  heap.model.laws = {PairLaw{}};
  heap.model.shapes = {unit_sphere()};
  heap.model.names = {"powder"};
  return heap;
}

/// A heap cut out of the packing, shifted at random by `seed`. `radius` of the plate in mean diameters, mean diameter
/// `diameter` [m]; the cone meets the plate at share `foot` of it. `tilt` adds a slope along x: the flank towards +x is
/// steeper by it. `apex_at` in mean diameters.
inline Heap make_cone(const Packing& packing, double angle_deg, double radius, std::uint64_t seed, double diameter = 1,
                      double foot = 1, double tilt = 0, const Vec2& apex_at = Vec2::Zero()) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vec3 shift = packing.side * Vec3(uniform(random), uniform(random), uniform(random));
  const double slope = std::tan(angle_deg * std::numbers::pi / 180), apex = slope * radius * foot;
  Heap heap = empty_heap(radius * diameter);
  const int wide = static_cast<int>(radius / packing.side) + 2, tall = static_cast<int>(apex / packing.side) + 2;
  for (int i = -wide; i <= wide; ++i)
    for (int j = -wide; j <= wide; ++j)
      for (int k = -1; k <= tall; ++k)
        for (std::size_t n = 0; n < packing.centre.size(); ++n) {
          const Vec3 c = packing.centre[n] + shift + packing.side * Vec3(i, j, k);
          const double r = (c.head<2>() - apex_at).norm();
          if (c.head<2>().norm() > radius || c.z() < packing.radius[n] || c.z() > apex - slope * r - tilt * c.x()) continue;
          add_sphere(heap, diameter * c, diameter * packing.radius[n]);
        }
  return heap;
}

}  // namespace repose::synthetic
