#pragma once
/// What is written into a picture: legend, scale bar, caption.
#include <string>
#include <vector>

#include "analysis/render/image.hpp"
#include "core/shape.hpp"

namespace repose {

struct LegendEntry {
  std::string label;
  const Shape* shape = nullptr;
  Vec3 colour = Vec3::Zero();  ///< linear RGB
  std::size_t count = 0;
  bool grains = false;  ///< else bodies of other kinds
};

/// Along the top: how many grains in all; then a small picture of each kind, its name, how many there are.
void draw_legend(Image& image, const std::vector<LegendEntry>& entries);

/// Bottom right: a bar of a round length, with its label. `pixel` is the size of a pixel [m].
void draw_scale_bar(Image& image, double pixel);

/// Bottom left.
void draw_caption(Image& image, const std::string& text);

/// The largest of 1, 2, 5 times a power of ten that is not longer than `length` [m], > 0.
double round_length(double length);

/// "500 µm", "2 mm", "1 m".
std::string length_label(double length);

/// 12345 as "12,345".
std::string grouped(std::size_t number);

}  // namespace repose
