#include "analysis/motion_field.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/heap_profile.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr int most_rings = 6, most_layers = 8;

template <class Visit>
void for_each_grain(const Model& model, Visit visit) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].role == BodyRole::grain) visit(i);
}

int slot(double at, double width, int count) {
  return static_cast<int>(std::clamp(std::floor(at / width), 0.0, static_cast<double>(count - 1)));
}

}  // namespace

std::size_t FieldGrid::cell(const Vec3& place) const {
  const Vec3 d = place - origin;
  return static_cast<std::size_t>(slot(d.z(), layer, layers)) * static_cast<std::size_t>(rings) +
         static_cast<std::size_t>(slot(std::hypot(d.x(), d.y()), ring, rings));
}

FieldGrid::Bounds FieldGrid::bounds(std::size_t cell) const {
  const double r = static_cast<double>(cell % static_cast<std::size_t>(rings)), z = static_cast<double>(cell / static_cast<std::size_t>(rings));
  return {r * ring, (r + 1) * ring, z * layer, (z + 1) * layer};
}

double mean_grain_diameter(const Model& model) {
  double sum = 0, count = 0;
  for_each_grain(model, [&](std::size_t i) {
    sum += 2 * model.bodies[i].radius;
    ++count;
  });
  return count > 0 ? sum / count : 0;
}

FieldGrid field_grid(const Scene& scene, const Model& model) {
  const double d = mean_grain_diameter(model);
  if (!(d > 0)) throw Error("motion field", "the model has no grains", "compare its bodies instead");
  Vec3 centre = Vec3::Zero();
  double count = 0, low = 1e300, high = -1e300, reach = 0;
  for_each_grain(model, [&](std::size_t i) {
    const Vec3& x = model.initial.position[i];
    centre += x;
    ++count;
    low = std::min(low, x.z());
    high = std::max(high, x.z());
  });
  centre /= count;
  if (const auto site = heap_site(scene)) {
    centre = site->centre;
    reach = site->radius * most_rings / (most_rings - 1);  // the outermost ring is what has left the plate
    low = site->centre.z();
  } else {
    for_each_grain(model, [&](std::size_t i) {
      const Vec3 x = model.initial.position[i] - centre;
      reach = std::max(reach, 1.5 * std::hypot(x.x(), x.y()));
    });
    low -= d;
  }
  FieldGrid grid;
  grid.origin = {centre.x(), centre.y(), low};
  const auto divide = [&](double extent, int most, double& width, int& number) {
    extent = std::max(extent, d);
    number = std::clamp(static_cast<int>(extent / d), 1, most);
    width = extent / number;
  };
  divide(reach, most_rings, grid.ring, grid.rings);
  divide(high + d / 2 - low, most_layers, grid.layer, grid.layers);
  return grid;
}

std::vector<double> motion_field(const FieldGrid& grid, const Model& model, const Snapshot& state) {
  std::vector<double> field(2 * grid.cells(), 0);
  double total = 0;
  for_each_grain(model, [&](std::size_t i) {
    const double mass = model.bodies[i].mass;
    const std::size_t c = grid.cell(state.position[i]);
    field[c] += mass;
    field[grid.cells() + c] += 0.5 * mass * state.velocity[i].squaredNorm();
    total += mass;
  });
  for (std::size_t c = 0; c < grid.cells() && total > 0; ++c) field[c] /= total;
  return field;
}

std::vector<int> motion_field_kinds(const FieldGrid& grid) {
  std::vector<int> kind(2 * grid.cells(), 0);
  std::fill(kind.begin() + static_cast<std::ptrdiff_t>(grid.cells()), kind.end(), 1);
  return kind;
}

}  // namespace repose
