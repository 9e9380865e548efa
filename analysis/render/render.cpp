#include "analysis/render/render.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/render/annotate.hpp"
#include "analysis/render/grain_colours.hpp"
#include "analysis/render/palette.hpp"
#include "analysis/render/stage.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

void check(const Model& model, const Snapshot& snapshot, const RenderOptions& options) {
  const auto fail = [](const std::string& problem, const std::string& remedy) {
    throw Error("picture", problem, remedy);
  };
  const auto in_range = [](int pixels) { return pixels >= 16 && pixels <= 16384; };
  if (!in_range(options.width) || !in_range(options.height))
    fail("its size is " + std::to_string(options.width) + " x " + std::to_string(options.height) + " pixels",
         "choose width and height from 16 to 16384");
  if (options.samples < 1 || options.samples > 1024 || options.sky_rays < 0 || options.sky_rays > 1024)
    fail("samples must be 1 to 1024, sky rays 0 to 1024", "4 and 4 are good for most pictures");
  if (snapshot.size() != model.bodies.size() || snapshot.orientation.size() != model.bodies.size())
    fail("the snapshot holds " + std::to_string(snapshot.size()) + " bodies, the model " +
             std::to_string(model.bodies.size()),
         "use a frame of the same run");
  for (std::size_t i = 0; i < snapshot.size(); ++i)
    if (!snapshot.position[i].allFinite() || !snapshot.orientation[i].coeffs().allFinite())
      fail("the pose of body " + std::to_string(i) + " is not finite",
           "the run diverged before this frame: choose an earlier one");
  if (options.only.empty()) return;
  std::string kinds;
  for (const Body& body : model.bodies) {
    const std::string& kind = model.shapes[static_cast<std::size_t>(body.shape)].kind;
    if (!body.dynamic) continue;
    if (kind == options.only) return;
    if (kinds.find(kind) == std::string::npos) kinds += (kinds.empty() ? "" : ", ") + kind;
  }
  fail("nothing that moves has the shape '" + options.only + "'", "choose one of: " + kinds);
}

/// In the order of the grain shapes or of the populations, then the rest by name.
std::vector<LegendEntry> legend_entries(const Model& model, double time, const RenderOptions& options) {
  const GrainColours colours(model, options.by_population);
  std::map<std::pair<std::size_t, std::string>, LegendEntry> found;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (!model.bodies[i].dynamic || !is_drawn(model, i, time, options)) continue;
    LegendEntry& entry = found[{colours.rank(i), colours.label(i)}];
    if (!entry.shape) {
      entry.label = colours.label(i);
      entry.shape = &model.shapes[static_cast<std::size_t>(model.bodies[i].shape)];
      entry.colour = colours.colour(i);
    }
    entry.grains = model.bodies[i].role == BodyRole::grain;
    ++entry.count;
  }
  std::vector<LegendEntry> entries;
  for (const auto& [place, entry] : found) entries.push_back(entry);
  return entries;
}

/// The backdrop: a slate wall, brighter behind the heap.
Vec3 backdrop(double x, double y) {
  const Vec3 bright = linear_rgb(0x8595a3), dark = linear_rgb(0x3c4854);
  const double r = std::hypot(x * 0.85, y * 0.95 + 0.05);
  const double w = std::exp(-1.6 * r * r);
  return w * bright + (1 - w) * dark;
}

double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

struct Lens {
  CameraAxes axes;
  Vec3 eye;            ///< on the stage
  double half_height;  ///< of the picture at the target's depth, on the stage
  bool orthographic;

  /// Ray through the picture at x, y in [-aspect, aspect] x [-1, 1].
  std::pair<Vec3, Vec3> ray(double x, double y) const {
    const Vec3 across = half_height * (x * axes.right + y * axes.up);
    if (orthographic) return {eye + across, axes.forward};
    return {eye, (across + eye.norm() * axes.forward).normalized()};
  }
};

}  // namespace

Image render(const Model& model, const Snapshot& snapshot, const Camera& camera, const RenderOptions& options) {
  check(model, snapshot, options);
  const CameraAxes axes = camera_axes(camera);
  const Light light = light_for(axes);
  const ScaledStage scaled_stage = build_stage(model, snapshot, camera, options);
  const Stage& stage = scaled_stage.stage;
  const Lens lens{axes, scaled_stage.scale * (camera.eye - camera.target),
                  0.5 * scaled_stage.scale * camera.view_height, camera.orthographic};

  Image image{options.width, options.height, {}};
  image.rgb.resize(3 * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
  const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic, 4) num_threads(threads)
  for (int row = 0; row < options.height; ++row) {
    for (int column = 0; column < options.width; ++column) {
      const std::uint32_t noise = pixel_noise(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row));
      Vec3 sum = Vec3::Zero();
      for (int s = 0; s < options.samples; ++s) {
        // A rank-1 lattice spreads any number of samples evenly over the pixel.
        const double u = (s + 0.5) / options.samples, v = std::fmod(0.618033988749895 * s + 0.5 / options.samples, 1.0);
        const double x = (2 * (column + u) - options.width) / options.height, y = 1 - 2 * (row + v) / options.height;
        const auto [origin, direction] = lens.ray(x, y);
        double fade = 0;
        if (stage.ground && direction.z() < 0) {
          const Vec3 point = origin + (*stage.ground - origin.z()) / direction.z() * direction;
          fade = 1 - smooth_step(1.6, 4.0, point.norm() / lens.half_height);
        }
        const Radiance r = trace(stage, light, origin, direction, fade, {noise, s, options.samples, options.sky_rays});
        sum +=
            tone_mapped(r.colour + (1 - r.cover) * r.backdrop_shade * backdrop(x * options.height / options.width, y));
      }
      std::uint8_t* pixel = &image.rgb[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(options.width) +
                                            static_cast<std::size_t>(column))];
      for (int i = 0; i < 3; ++i)
        pixel[i] = static_cast<std::uint8_t>(std::lround(255 * srgb(sum[i] / options.samples)));
    }
  }
  if (options.legend) draw_legend(image, legend_entries(model, snapshot.time, options));
  if (options.scale_bar) draw_scale_bar(image, camera.view_height / options.height);
  draw_caption(image, options.caption);
  return image;
}

}  // namespace repose
