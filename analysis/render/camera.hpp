#pragma once
/// Where a picture is taken from.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/model.hpp"

namespace repose {

/// A pinhole or an orthographic camera. In either, a length L [m] at the depth of `target`, across the line of sight,
/// takes L / view_height of the picture's height.
struct Camera {
  Vec3 eye{0, -1, 0};          ///< [m]
  Vec3 target = Vec3::Zero();  ///< shown in the middle of the picture [m]
  Vec3 up = Vec3::UnitZ();     ///< not parallel to the line of sight
  double view_height = 1;      ///< height of the picture at the depth of `target` [m], > 0
  bool orthographic = false;
};

enum class View {
  iso,   ///< three-quarter view from 27 degrees above, 30 degrees off the y axis, in perspective
  side,  ///< along +y, orthographic: flanks keep their angle
  top,   ///< along -z, orthographic, +x to the right
};

/// "iso", "side" or "top"; throws Error otherwise.
View view_named(std::string_view name);

struct FrameOptions {
  View view = View::iso;
  double aspect = 1.6;            ///< width / height of the picture, > 0
  double azimuth_deg = 0;         ///< turns the eye about z from the view's own place, -y towards +x (iso and side)
  double margin = 0.085;          ///< free border, as a fraction of the picture
  std::vector<std::string> hide;  ///< names of bodies and tools that are not drawn
};

/// A camera that shows the bodies that can move and the tools that stand under and around them. The few grains that
/// flew off or fell below every tool do not count: the frame holds the middle 99 % of the bodies and what lies within a
/// sixth of their extent of these. With several snapshots (a film) it holds them all. Throws Error if there is nothing
/// to show.
Camera frame_scene(const Model& model, std::span<const Snapshot> snapshots, const FrameOptions& options = {});
Camera frame_scene(const Model& model, const Snapshot& snapshot, const FrameOptions& options = {});

/// The width over height of a picture that these snapshots fill well, between 0.8 and 1.6.
double fitting_aspect(const Model& model, std::span<const Snapshot> snapshots, const FrameOptions& options = {});

/// Unit vectors of the picture: to the right, up, and along the line of sight. Throws Error if the camera is
/// degenerate.
struct CameraAxes {
  Vec3 right, up, forward;
};
CameraAxes camera_axes(const Camera& camera);

}  // namespace repose
