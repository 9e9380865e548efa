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
  for (const GrainPart& part : grain_parts_over(model, state, region))
    for_each_cell_under(part, grid, [&](int i, int j, double top) {
      float& height = grid.height[grid.index(i, j)];
      height = std::fmax(height, static_cast<float>(top - grid.plate));  // fmax: a number beats NaN
    });
  return grid;
}

double coverage(const HeightGrid& grid) {
  const auto holes = std::count_if(grid.height.begin(), grid.height.end(), [](float height) { return std::isnan(height); });
  return 1 - static_cast<double>(holes) / static_cast<double>(grid.height.size());
}

HeightGrid on_plate(HeightGrid grid) {
  std::replace_if(grid.height.begin(), grid.height.end(), [](float height) { return std::isnan(height); }, 0.0f);
  return grid;
}

std::optional<Vec2> hole_beside_plate(const Model& model, const Snapshot& state, const HeightGrid& grid) {
  if (state.size() != model.bodies.size())
    throw Error("layer", "the state has another number of bodies than the model", "read both from the same run");
  std::vector<std::size_t> fixed;
  for (std::size_t k = 0; k < model.bodies.size(); ++k)
    if (!model.bodies[k].dynamic && model.bodies[k].exists_at(state.time)) fixed.push_back(k);
  const auto solid_at = [&](const Vec3& point) {
    return std::any_of(fixed.begin(), fixed.end(), [&](std::size_t k) {
      const Body& body = model.bodies[k];
      const Shape& shape = model.shapes[static_cast<std::size_t>(body.shape)];
      const double reach = shape.bounded() ? body.scale * shape.bounding_radius : 0;
      bool inside = false;
      model.periodic.each_image(state.position[k], reach, [&](const Vec3& image) {
        inside = inside || contains(shape, Pose{image, state.orientation[k]}.to_local(point) / body.scale);
        return !inside;
      });
      return inside;
    });
  };
  const Vec3 step(0, 0, 0.1 * grid.cell);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      if (!grid.is_hole(i, j)) continue;
      const Vec2 at = grid.middle(i, j);
      const Vec3 ground(at.x(), at.y(), grid.plate);
      if (!solid_at(ground - step) || solid_at(ground + step)) return at;
    }
  return std::nullopt;
}

}  // namespace repose
