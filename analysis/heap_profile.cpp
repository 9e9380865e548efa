#include "analysis/heap_profile.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/neighbour_grid.hpp"
#include "analysis/silhouette.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr double neighbour_slack = 0.05;  // of the mean diameter

double bounding(const Model& model, int body) {
  const Body& b = model.bodies[static_cast<std::size_t>(body)];
  return b.scale * model.shapes[static_cast<std::size_t>(b.shape)].bounding_radius;
}

void require(const HeapSite& site) {
  if (!(site.radius > 0) || !(site.rim_height >= 0) || !site.centre.allFinite())
    throw Error("heap", "the base needs a positive radius", "give the scene a base tool");
}

// The members of `candidates` that are linked to the plate.
std::vector<char> linked(const Model& model, const Snapshot& state, const HeapSite& site, double diameter,
                         const std::vector<int>& candidates) {
  const double slack = neighbour_slack * diameter;
  const double falling = std::sqrt(model.gravity.norm() * diameter);
  std::vector<Vec3> centres;
  double largest = 0;
  for (int body : candidates) {
    centres.push_back(state.position[static_cast<std::size_t>(body)]);
    largest = std::max(largest, bounding(model, body));
  }
  const NeighbourGrid grid(centres, 2 * largest + slack);
  std::vector<char> in_heap(candidates.size(), 0);
  std::vector<int> front;
  const auto admit = [&](int i) {
    const std::size_t k = static_cast<std::size_t>(i);
    if (in_heap[k] || state.velocity[static_cast<std::size_t>(candidates[k])].norm() > falling) return;
    in_heap[k] = 1;
    front.push_back(i);
  };
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (centres[i].z() - site.centre.z() < bounding(model, candidates[i]) + slack) admit(static_cast<int>(i));
  while (!front.empty()) {
    const std::size_t i = static_cast<std::size_t>(front.back());
    front.pop_back();
    const double reach = bounding(model, candidates[i]) + slack;
    grid.near(centres[i], [&](int j) {
      const std::size_t k = static_cast<std::size_t>(j);
      if ((centres[k] - centres[i]).norm() < reach + bounding(model, candidates[k])) admit(j);
      return true;
    });
  }
  return in_heap;
}

}  // namespace

std::optional<HeapSite> heap_site(const Scene& scene) {
  for (const Tool& tool : scene.tools)
    if (const auto* base = std::get_if<Base>(&tool.kind))
      return HeapSite{tool.position, base->diameter / 2, base->rim_height};
  return std::nullopt;
}

HeapGrains find_heap(const Model& model, const Snapshot& state, const HeapSite& site) {
  require(site);
  if (state.size() != model.bodies.size())
    throw Error("heap", "the state has another number of bodies than the model", "read both from the same run");
  HeapGrains result;
  std::vector<int> candidates;
  std::size_t grains = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (body.role != BodyRole::grain) continue;
    ++grains;
    result.diameter += 2 * body.radius;
    const Vec3 offset = state.position[i] - site.centre;
    const bool beyond = offset.head<2>().norm() > site.radius;
    const int index = static_cast<int>(i);
    if (!beyond && offset.z() >= 0) {
      candidates.push_back(index);
    } else if (offset.z() < 0) {
      result.trench.push_back(index);
      result.trench_mass += body.mass;
    } else {
      result.rim.push_back(index);
    }
  }
  if (grains == 0) return result;
  result.diameter /= static_cast<double>(grains);
  if (candidates.empty()) return result;
  const std::vector<char> in_heap = linked(model, state, site, result.diameter, candidates);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!in_heap[i]) {
      result.loose.push_back(candidates[i]);
      continue;
    }
    result.heap.push_back(candidates[i]);
    result.heap_mass += model.bodies[static_cast<std::size_t>(candidates[i])].mass;
  }
  return result;
}

HeightMap height_map(const Model& model, const Snapshot& state, const HeapGrains& grains, const HeapSite& site,
                     double columns_per_diameter) {
  require(site);
  if (!(columns_per_diameter > 0) || !(grains.diameter > 0))
    throw Error("heap", "a height map needs grains and a positive resolution", "");
  HeightMap map;
  const double wanted = 2 * site.radius / grains.diameter * columns_per_diameter;
  map.size = std::max(1, static_cast<int>(std::ceil(std::min(wanted, 8192.0))));
  map.pixel = 2 * site.radius / map.size;
  map.origin = site.centre.head<2>() - Vec2::Constant(site.radius);
  map.height.assign(static_cast<std::size_t>(map.size) * static_cast<std::size_t>(map.size), 0);
  for (const GrainPart& part : grain_parts(model, state, grains.heap)) {
    const double reach = part.reach();
    const auto first = [&](double at) { return std::clamp(static_cast<int>((at - reach) / map.pixel), 0, map.size - 1); };
    const auto last = [&](double at) { return std::clamp(static_cast<int>((at + reach) / map.pixel), 0, map.size - 1); };
    const Vec2 at = part.centre.head<2>() - map.origin;
    for (int j = first(at.y()); j <= last(at.y()); ++j)
      for (int i = first(at.x()); i <= last(at.x()); ++i) {
        double& height = map.height[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.size) + static_cast<std::size_t>(i)];
        height = std::max(height, top_over_point(part, map.column(i, j)) - site.centre.z());
      }
  }
  return map;
}

RadialProfile radial_profile(const HeightMap& map, const HeapSite& site, double diameter, double ring_in_diameters) {
  require(site);
  if (!(diameter > 0) || !(ring_in_diameters > 0)) throw Error("heap", "rings need a positive width", "");
  const int rings = std::max(1, static_cast<int>(std::round(site.radius / (diameter * ring_in_diameters))));
  RadialProfile profile;
  profile.ring = site.radius / rings;
  const std::size_t n = static_cast<std::size_t>(rings);
  std::vector<double> count(n, 0), covered(n, 0), sum_r(n, 0), sum(n, 0), squares(n, 0);
  for (int j = 0; j < map.size; ++j)
    for (int i = 0; i < map.size; ++i) {
      const double r = (map.column(i, j) - site.centre.head<2>()).norm();
      const std::size_t k = static_cast<std::size_t>(r / profile.ring);
      if (k >= n) continue;
      const double h = map.at(i, j);
      count[k] += 1;
      covered[k] += h > 0;
      sum_r[k] += r;
      sum[k] += h;
      squares[k] += h * h;
    }
  double all = 0, all_covered = 0;
  profile.foot = site.radius;
  bool found_foot = false;
  double outer_cover = 0;
  for (std::size_t k = 0; k < n; ++k) {
    if (count[k] == 0) continue;
    const double mean = sum[k] / count[k];
    profile.radius.push_back(sum_r[k] / count[k]);
    profile.height.push_back(mean);
    profile.sd.push_back(std::sqrt(std::max(0.0, squares[k] / count[k] - mean * mean)));
    all += count[k];
    all_covered += covered[k];
    outer_cover = covered[k] / count[k];
    if (!found_foot && mean < 0.5 * diameter) {
      found_foot = true;
      profile.foot = static_cast<double>(k) * profile.ring;
    }
  }
  profile.coverage = all > 0 ? all_covered / all : 0;
  profile.covers_base = outer_cover >= 0.9 && !found_foot;
  return profile;
}

}  // namespace repose
