#include "analysis/render/height_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "analysis/render/annotate.hpp"
#include "analysis/render/text.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

constexpr double text_size = 20, margin = 24, title_height = 36, bar_width = 24;
const Vec3 ink(0.1, 0.1, 0.12), paper(1, 1, 1);

/// Eight stations of cividis, sRGB.
Vec3 colour(double share) {
  static const std::array<Vec3, 8> stations{Vec3(0.000, 0.135, 0.305), Vec3(0.155, 0.232, 0.424), Vec3(0.312, 0.334, 0.424),
                                            Vec3(0.431, 0.437, 0.446), Vec3(0.557, 0.542, 0.467), Vec3(0.700, 0.659, 0.440),
                                            Vec3(0.851, 0.783, 0.368), Vec3(0.996, 0.909, 0.218)};
  const double place = std::clamp(share, 0.0, 1.0) * (stations.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(place), stations.size() - 2);
  const double t = place - static_cast<double>(k);
  return (1 - t) * stations[k] + t * stations[k + 1];
}

void paint(Image& image, int x, int y, const Vec3& rgb) { blend(image, x, y, rgb, 1); }

/// Height at a point of the panel in cells, between the four cells around it; NaN beside a hole.
double height_at(const HeightPanel& p, double x, double y) {
  const int i = std::clamp(static_cast<int>(std::floor(x - 0.5)), 0, p.nx - 2);
  const int j = std::clamp(static_cast<int>(std::floor(y - 0.5)), 0, p.ny - 2);
  const double u = std::clamp(x - 0.5 - i, 0.0, 1.0), v = std::clamp(y - 0.5 - j, 0.0, 1.0);
  const auto at = [&](int a, int b) { return (*p.height)[static_cast<std::size_t>(b) * static_cast<std::size_t>(p.nx) + static_cast<std::size_t>(a)]; };
  return (1 - u) * ((1 - v) * at(i, j) + v * at(i, j + 1)) + u * ((1 - v) * at(i + 1, j) + v * at(i + 1, j + 1));
}

/// Light from the upper left, 45 degrees high: Lambert's law, a quarter of it ambient.
double light(double slope_x, double slope_y) {
  const Vec3 normal = Vec3(-slope_x, -slope_y, 1).normalized(), sun = Vec3(-0.5, 0.5, std::sqrt(0.5));
  return 0.25 + 0.75 * std::max(0.0, normal.dot(sun)) / sun.z();
}

void draw_panel(Image& image, const HeightPanel& p, int left, int top, int width, int height, double cell, double low, double high) {
  const double step = static_cast<double>(p.nx) / width;  // cells per pixel
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const double x = (column + 0.5) * step, y = p.ny - (row + 0.5) * step;
      const double z = height_at(p, x, y);
      Vec3 rgb = Vec3::Zero();
      if (!std::isnan(z)) {
        const double reach = std::max(0.5, 0.5 * step);
        double sx = (height_at(p, x + reach, y) - height_at(p, x - reach, y)) / (2 * reach * cell);
        double sy = (height_at(p, x, y + reach) - height_at(p, x, y - reach)) / (2 * reach * cell);
        if (std::isnan(sx)) sx = 0;
        if (std::isnan(sy)) sy = 0;
        rgb = (colour((z - low) / (high - low)) * std::min(1.25, light(sx, sy))).cwiseMin(1.0);
      }
      paint(image, left + column, top + row, rgb);
    }
}

void draw_colour_bar(Image& image, const Typesetter& type, int left, int top, int height, double low, double high, const std::string& quantity) {
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < bar_width; ++column) paint(image, left + column, top + row, colour(1 - (row + 0.5) / height));
  const double step = std::max(1e-12, round_length((high - low) / 4));
  for (double z = std::ceil(low / step) * step; z <= high * (1 + 1e-9); z += step) {
    const double y = top + height * (1 - (z - low) / (high - low));
    for (int column = 0; column < 6; ++column) paint(image, left + static_cast<int>(bar_width) + column, static_cast<int>(y), ink);
    type.draw(image, left + bar_width + 10, y + 0.35 * text_size, fmt::format("{:.0f} µm", std::round(z * 1e6) + 0.0), 0.85 * text_size, ink);
  }
  type.draw(image, left, top - 10, quantity, text_size, ink);
}

}  // namespace

Image height_picture(const std::vector<HeightPanel>& panels, double cell, double low, double high, const std::string& quantity) {
  if (panels.empty() || !(high > low) || !(cell > 0)) throw Error("surface", "there is nothing to draw", "give surfaces and a scale");
  for (const HeightPanel& p : panels)
    if (p.nx != panels[0].nx || p.ny != panels[0].ny || p.nx < 2 || p.ny < 2)
      throw Error("surface", "the surfaces differ in size or are too small", "draw surfaces of one region");
  const int nx = panels[0].nx, ny = panels[0].ny, count = static_cast<int>(panels.size());
  const bool stacked = nx >= ny;
  const double aspect = static_cast<double>(ny) / nx;
  const double free_width = stacked ? 1300 : 1300.0 / count - margin;
  const int width = static_cast<int>(std::min(free_width, 900 / aspect)), height = std::max(1, static_cast<int>(width * aspect));
  const int step_x = stacked ? 0 : width + static_cast<int>(margin), step_y = stacked ? height + static_cast<int>(title_height + margin) : 0;
  const int first_top = static_cast<int>(margin + title_height), body = stacked ? step_y * (count - 1) + height : height;
  const Typesetter type;
  const double bar_room = std::max(bar_width + 130, type.width(quantity, text_size) + margin);

  Image image;
  image.width = static_cast<int>(2 * margin + (stacked ? width : step_x * (count - 1) + width) + margin + bar_room);
  image.height = first_top + body + 70;
  image.rgb.assign(3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), 255);
  for (int k = 0; k < count; ++k) {
    const int left = static_cast<int>(margin) + k * step_x, top = first_top + k * step_y;
    const HeightPanel& panel = panels[static_cast<std::size_t>(k)];
    type.draw(image, left, top - 10, panel.title, text_size, ink);
    draw_panel(image, panel, left, top, width, height, cell, low, high);
  }
  draw_colour_bar(image, type, static_cast<int>(image.width - margin - bar_room), first_top, std::min(body, 500), low, high, quantity);
  draw_scale_bar(image, cell * nx / width);
  return image;
}

}  // namespace repose
