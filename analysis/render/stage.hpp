#pragma once
/// From a model and a state to what a ray can meet.
#include "analysis/render/camera.hpp"
#include "analysis/render/render.hpp"
#include "analysis/render/shade.hpp"

namespace repose {

/// The stage, and how to get onto it: x_stage = scale * (x_world - camera.target).
struct ScaledStage {
  Stage stage;
  double scale = 1;
};

ScaledStage build_stage(const Model& model, const Snapshot& snapshot, const Camera& camera,
                        const RenderOptions& options);

/// One shape alone in this colour (linear RGB), half a unit in radius, turned to show its form: the picture in a legend.
Stage build_sample(const Shape& shape, const Vec3& colour);

/// True if the body is drawn at all.
bool is_drawn(const Model& model, std::size_t body, double time, const RenderOptions& options);

}  // namespace repose
