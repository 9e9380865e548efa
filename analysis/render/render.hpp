#pragma once
/// Pictures of a state: a ray caster with a sun, a sky, exact surfaces, a legend and a scale bar.
#include <string>
#include <vector>

#include "analysis/render/camera.hpp"
#include "analysis/render/image.hpp"
#include "core/model.hpp"

namespace repose {

struct RenderOptions {
  int width = 1600, height = 1000;  ///< [pixels], 16 to 16384
  int samples = 6;                  ///< camera rays per pixel, >= 1
  int sky_rays = 3;                 ///< for the sky light, per camera ray, >= 0; 0: the sky casts no shade
  int threads = 0;                  ///< 0: all; never changes a byte
  std::vector<std::string> hide;    ///< names of bodies and tools that are not drawn
  std::string only;                 ///< if not empty: of the bodies that move, only those of this shape kind
  bool by_population = false;       ///< grains coloured by the population that they are of (grain_colours.hpp), not by shape
  bool legend = true;               ///< colours and how many bodies have them, along the top
  bool scale_bar = true;            ///< at the depth of the camera's target, bottom right
  std::string caption;              ///< a line at the bottom left, UTF-8; "t = 0.8 s"
};

/// The bodies of the model as they stand in `snapshot`.
///
/// Grains are coloured by shape or population (palette.hpp), tools are grey. A tool that hides much of what moves, or hangs clear
/// above all of it (a funnel), is drawn as glass and casts no shadow. The ground is the half-space that faces up, else
/// a plane under the lowest tool; it shows shadows only. The same arguments give the same bytes at any thread count.
/// Throws Error if model and snapshot do not belong together, a size is out of range, or `only` names no shape of the
/// model.
Image render(const Model& model, const Snapshot& snapshot, const Camera& camera, const RenderOptions& options = {});

}  // namespace repose
