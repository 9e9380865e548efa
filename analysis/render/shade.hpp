#pragma once
/// Light: from a camera ray to a colour.
#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/render/camera.hpp"
#include "analysis/render/ray_scene.hpp"

namespace repose {

/// Everything a ray can meet, in lengths where a typical grain is about 1 and the camera's target is the origin.
struct Stage {
  RayScene solid;                ///< casts shadows
  RayScene glass;                ///< tools in the way
  std::vector<Vec3> colour;      ///< by RayHit::owner, linear RGB
  std::optional<double> ground;  ///< height of the plane that shows shadows only
};

/// Sun and sky stand relative to the camera, so that every view is lit from the upper left.
struct Light {
  Vec3 sun, fill;       ///< unit vectors towards the sun and the brighter side of the sky
  double open_sky = 1;  ///< mean sky radiance on a level plane that nothing shades
};
Light light_for(const CameraAxes& axes);

/// Premultiplied linear RGB, and how much of the backdrop is hidden. `backdrop_shade` multiplies what is left of it
/// (the shadow on the ground).
struct Radiance {
  Vec3 colour = Vec3::Zero();
  double cover = 0;
  double backdrop_shade = 1;
};

/// `noise`: a number of the pixel, `sample` of `samples` in it: together they choose the directions of the sky rays.
struct SampleIndex {
  std::uint32_t noise;
  int sample, samples, sky_rays;
};
Radiance trace(const Stage& stage, const Light& light, const Vec3& origin, const Vec3& direction, double ground_fade,
               const SampleIndex& index);

/// A well-mixed number for a pixel.
std::uint32_t pixel_noise(std::uint32_t x, std::uint32_t y);

/// Linear radiance to what a screen shows: bright parts are bent below 1 instead of cut.
Vec3 tone_mapped(const Vec3& linear);

}  // namespace repose
