#include "analysis/height_grid.hpp"

#include <algorithm>

#include "core/error.hpp"

namespace repose {

HeightGrid empty_grid(const SurfaceRegion& region, double cell) {
  const Vec2 extent = region.upper - region.lower;
  if (!(cell > 0) || !(extent.minCoeff() >= cell) || !extent.allFinite())
    throw Error("layer.region", "the region holds not one cell", "make the region larger or the cell smaller");
  HeightGrid grid;
  grid.origin = region.lower;
  grid.plate = region.plate;
  grid.cell = cell;
  grid.nx = static_cast<int>(extent.x() / cell + 1e-9);
  grid.ny = static_cast<int>(extent.y() / cell + 1e-9);
  grid.height.assign(static_cast<std::size_t>(grid.nx) * static_cast<std::size_t>(grid.ny), HeightGrid::hole);
  return grid;
}

std::vector<GrainPart> grain_parts_over(const Model& model, const Snapshot& state, const SurfaceRegion& region) {
  if (state.size() != model.bodies.size())
    throw Error("layer", "the state has another number of bodies than the model", "read both from the same run");
  const PeriodicCell& cell = model.periodic;
  for (int axis = 0; axis < 2; ++axis)
    if (cell.along(axis) && !(region.lower[axis] >= cell.lower[axis] && region.upper[axis] <= cell.upper[axis]))
      throw Error("layer.region", "reaches out of the periodic cell: the same powder would count twice", "keep it within the cell");
  std::vector<GrainPart> result;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (body.role != BodyRole::grain) continue;
    const double reach = body.scale * model.shapes[static_cast<std::size_t>(body.shape)].bounding_radius;
    const Vec3& place = state.position[i];
    std::vector<GrainPart> parts;
    cell.each_image(place, reach, [&](const Vec3& image) {
      const Vec2 at = image.head<2>();
      if (!(at.array() + reach >= region.lower.array()).all() || !(at.array() - reach <= region.upper.array()).all()) return true;
      if (parts.empty()) parts = grain_parts(model, state, {static_cast<int>(i)});
      for (GrainPart part : parts) {
        part.centre += image - place;
        result.push_back(part);
      }
      return true;
    });
  }
  return result;
}

HeightGrid height_grid(const Model& model, const Snapshot& state, const SurfaceRegion& region, double cell) {
  HeightGrid grid = empty_grid(region, cell);
  for (const GrainPart& part : grain_parts_over(model, state, region)) {
    const double reach = part.reach();
    const Vec2 at = part.centre.head<2>() - grid.origin;
    const auto first = [&](double x, int n) { return std::clamp(static_cast<int>(std::floor((x - reach) / cell)), 0, n); };
    const auto last = [&](double x, int n) { return std::clamp(static_cast<int>(std::ceil((x + reach) / cell)), 0, n); };
    for (int j = first(at.y(), grid.ny); j < last(at.y(), grid.ny); ++j)
      for (int i = first(at.x(), grid.nx); i < last(at.x(), grid.nx); ++i) {
        const double top = top_over_point(part, grid.middle(i, j));
        if (!std::isfinite(top)) continue;
        float& height = grid.height[grid.index(i, j)];
        height = std::fmax(height, static_cast<float>(top - grid.plate));  // fmax: a number beats NaN
      }
  }
  return grid;
}

}  // namespace repose
