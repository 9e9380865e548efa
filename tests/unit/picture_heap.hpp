#pragma once
/// A heap to take pictures of: grains of the seven shapes dropped one by one, geometrically, into a cone on a base with
/// a trench. No physics: each grain comes down vertically and stays where its ball first touches another.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/grain_shape.hpp"
#include "core/tool.hpp"
#include "tests/support/model_builder.hpp"

namespace repose::test {

struct PictureHeap {
  std::size_t grains = 2000;
  double angle_deg = 33;
  double diameter = 58e-6;  ///< mean of the grains [m]
  bool funnel = false;
  bool base = true;
  std::uint32_t seed = 1;
};

inline Model picture_heap(const PictureHeap& heap) {
  std::mt19937 random(heap.seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const auto normal = [&] {
    return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(2 * std::numbers::pi * uniform());
  };
  const double d = heap.diameter, slope = std::tan(heap.angle_deg * std::numbers::pi / 180);
  // A cone of solid fraction about 0.45 that holds nine grains of ten; the rest lies in the trench.
  const double volume = 0.9 * static_cast<double>(heap.grains) * std::numbers::pi / 6 * d * d * d / 0.5;
  const double foot = std::cbrt(3 * volume / (std::numbers::pi * slope));

  ModelBuilder builder;
  builder.material("grain", 1020).material("wall", 2700).law("grain", "grain", {}).law("grain", "wall", {});
  const auto add_tool = [&](const Tool& tool) {
    for (const ToolBody& body : build_tool(tool)) builder.wall("wall", body.shape, body.pose).named(tool.name);
  };
  const double rim = d, width = 0.6 * foot + 2 * d, depth = 0.3 * foot;
  if (heap.base) add_tool({"base", "wall", Base{2 * foot, rim, d, width, depth, 1.5 * depth}, Vec3::Zero(), {}});
  if (heap.funnel)
    add_tool({"funnel",
              "wall",
              Funnel{0.5 * foot, 30, 1.3 * foot, 0.2 * foot, 2 * d, 0, 1e300},
              {0, 0, 1.5 * foot * slope},
              {}});

  const std::vector<std::string>& names = grain_shape_names();
  std::vector<Shape> shapes;
  for (const std::string& name : names) shapes.push_back(make_grain_shape(name));
  struct Ball {
    Vec3 centre;
    double radius;
  };
  std::map<std::pair<int, int>, std::vector<Ball>> columns;
  const double cell = 2 * d;
  const auto column = [&](double x) { return static_cast<int>(std::floor(x / cell)); };
  const auto landing = [&](const Vec2& place, double radius, double floor) {
    Vec3 centre(place.x(), place.y(), floor + radius);
    for (int x = column(place.x()) - 1; x <= column(place.x()) + 1; ++x)
      for (int y = column(place.y()) - 1; y <= column(place.y()) + 1; ++y)
        for (const Ball& b : columns[{x, y}]) {
          const double reach = b.radius + radius, across2 = (place - b.centre.head<2>()).squaredNorm();
          if (across2 < reach * reach)
            centre.z() = std::max(centre.z(), b.centre.z() + std::sqrt(reach * reach - across2));
        }
    return centre;
  };
  for (std::size_t i = 0; i < heap.grains; ++i) {
    const Shape& shape = shapes[i % shapes.size()];
    const double size = std::clamp(d * (1 + 0.26 * normal()), 0.52 * d, 1.72 * d);
    const double radius = 0.47 * size;  // the ball of equal volume, a little inside: neighbours look as if in contact
    bool spilled = heap.base && i % 10 == 9;
    Vec3 centre = Vec3::Zero();
    for (int attempt = 0;; ++attempt) {
      spilled = spilled || attempt == 50;
      const double a = 2 * std::numbers::pi * uniform();
      const double inner = foot + 1.4 * d + radius, outer = foot + d + width - radius;
      const double r = spilled ? std::sqrt(inner * inner + uniform() * (outer * outer - inner * inner))
                               : (foot - radius) * std::sqrt(uniform());
      // The lowest of a few landings nearby stands for the rolling into a hollow.
      centre = landing({r * std::cos(a), r * std::sin(a)}, radius, spilled ? -depth : 0);
      for (int k = 0; k < 20 && !spilled; ++k) {
        const Vec2 aside(centre.x() + 0.6 * d * normal(), centre.y() + 0.6 * d * normal());
        const Vec3 other = landing(aside, radius, 0);
        if (aside.norm() < foot - radius && other.z() < centre.z()) centre = other;
      }
      if (spilled || centre.z() <= radius || centre.z() + radius < (foot - centre.head<2>().norm()) * slope + d) break;
    }
    columns[{column(centre.x()), column(centre.y())}].push_back({centre, radius});
    const Quat q = Quat(normal(), normal(), normal(), normal()).normalized();
    builder.body("grain", shape, {.position = centre, .orientation = q}, size).as_grain();
  }
  return builder.build();
}

}  // namespace repose::test
