#include "analysis/render/annotate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/render/palette.hpp"
#include "analysis/render/stage.hpp"
#include "analysis/render/text.hpp"

namespace repose {
namespace {

const Vec3 ink(0.96, 0.97, 0.98), faint_ink(0.76, 0.80, 0.84), panel(0.07, 0.09, 0.11);
constexpr double panel_cover = 0.42;

/// Sizes follow the picture, so that a small one stays readable and a large one is not overrun.
double em(const Image& image) {
  return std::max(10.0, std::min(image.width / 1.5, static_cast<double>(image.height)) / 42);
}

void draw_sample(Image& image, const Shape& shape, const Vec3& body_colour, int left, int top, int size) {
  Camera camera;
  camera.eye = Vec3(0, -4, 1.4);
  const CameraAxes axes = camera_axes(camera);
  const Light light = light_for(axes);
  const Stage stage = build_sample(shape, body_colour);
  constexpr int samples = 16;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      Vec3 colour = Vec3::Zero();
      double cover = 0;
      for (int s = 0; s < samples; ++s) {
        const double u = (x + (s % 4 + 0.5) / 4) / size - 0.5, v = 0.5 - (y + (s / 4 + 0.5) / 4) / size;
        const Radiance r =
            trace(stage, light, camera.eye + 1.04 * (u * axes.right + v * axes.up), axes.forward, 0,
                  {pixel_noise(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)), s, samples, 2});
        colour += r.colour;
        cover += r.cover;
      }
      if (cover == 0) continue;
      const Vec3 screen = tone_mapped(colour / cover).unaryExpr([](double c) { return srgb(c); });
      blend(image, left + x, top + y, screen, cover / samples);
    }
}

}  // namespace

double round_length(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  // The factor keeps 5e-4 / 1e-4 at 5 whatever the rounding.
  for (const double digit : {5.0, 2.0})
    if (digit * power <= length * (1 + 1e-9)) return digit * power;
  return power;
}

std::string length_label(double length) {
  struct Unit {
    double size;
    const char* name;
  };
  constexpr std::array<Unit, 6> units{{{1e3, "km"}, {1, "m"}, {1e-2, "cm"}, {1e-3, "mm"}, {1e-6, "µm"}, {1e-9, "nm"}}};
  for (const Unit& unit : units)
    if (length >= unit.size * (1 - 1e-9)) return fmt::format("{:.6g} {}", length / unit.size, unit.name);
  return fmt::format("{:.3g} m", length);
}

std::string grouped(std::size_t number) {
  std::string digits = std::to_string(number);
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(digits.size()) - 3; i > 0; i -= 3)
    digits.insert(static_cast<std::size_t>(i), 1, ',');
  return digits;
}

void draw_legend(Image& image, const std::vector<LegendEntry>& entries) {
  if (entries.empty()) return;
  const Typesetter type;
  const double size = em(image), row = 1.75 * size, icon = 1.5 * size, pad = 0.7 * size, border = 1.1 * size;
  const double icon_gap = 0.4 * size, count_gap = 0.45 * size, item_gap = 1.5 * size;
  struct Item {
    std::string name, count;
    const LegendEntry* entry;
    double width, x, y;
  };
  std::vector<Item> items;
  std::size_t total = 0;
  for (const LegendEntry& e : entries) {
    total += e.count;
    Item item{e.label, grouped(e.count), &e, 0, 0, 0};
    item.width = icon + icon_gap + type.width(item.name, size) + count_gap + type.width(item.count, size);
    items.push_back(std::move(item));
  }
  if (items.size() > 1) {
    const std::string name = entries.front().grains ? "grains" : "bodies";
    items.insert(items.begin(), {name, grouped(total), nullptr,
                                 type.width(name, size) + count_gap + type.width(grouped(total), size), 0, 0});
  }
  // The items flow like words, so that the legend takes a strip of any picture, however narrow.
  double x = 0, y = 0, widest = 0;
  for (Item& item : items) {
    if (x > 0 && x + item.width > image.width - 2 * (border + pad)) x = 0, y += row;
    item.x = x;
    item.y = y;
    widest = std::max(widest, x + item.width);
    x += item.width + item_gap;
  }
  fill_rounded(image, border, border, widest + 2 * pad, y + row + 0.6 * pad, 0.6 * size, panel, panel_cover);
  for (const Item& item : items) {
    double pen = border + pad + item.x;
    const double top = border + 0.3 * pad + item.y, base = top + 0.5 * row + 0.36 * size;
    if (item.entry) {
      draw_sample(image, *item.entry->shape, item.entry->colour, static_cast<int>(pen), static_cast<int>(top + 0.5 * (row - icon)),
                  static_cast<int>(icon));
      pen += icon + icon_gap;
    }
    type.draw(image, pen, base, item.entry ? item.name : item.count, size, ink);
    pen += type.width(item.entry ? item.name : item.count, size) + count_gap;
    type.draw(image, pen, base, item.entry ? item.count : item.name, size, item.entry ? faint_ink : ink);
  }
}

void draw_scale_bar(Image& image, double pixel) {
  const Typesetter type;
  const double size = em(image), length = round_length(0.2 * image.width * pixel), bar = length / pixel;
  const std::string label = length_label(length);
  const double thick = std::max(2.0, 0.22 * size), pad = 0.7 * size;
  const double width = std::max(bar, type.width(label, size)) + 2 * pad, height = 2.6 * size;
  const double left = image.width - 1.1 * size - width, top = image.height - 1.1 * size - height;
  fill_rounded(image, left, top, width, height, 0.6 * size, panel, panel_cover);
  type.draw(image, left + 0.5 * (width - type.width(label, size)), top + 1.35 * size, label, size, ink);
  const double x = left + 0.5 * (width - bar), y = top + 1.95 * size;
  fill_rounded(image, x, y - thick / 2, bar, thick, 0, ink, 1);
  for (const double end : {x, x + bar - thick})
    fill_rounded(image, end, y - 1.6 * thick, thick, 3.2 * thick, 0, ink, 1);
}

void draw_caption(Image& image, const std::string& text) {
  if (text.empty()) return;
  const Typesetter type;
  const double size = em(image), pad = 0.7 * size, height = 1.9 * size;
  const double left = 1.1 * size, top = image.height - 1.1 * size - height;
  fill_rounded(image, left, top, type.width(text, size) + 2 * pad, height, 0.6 * size, panel, panel_cover);
  type.draw(image, left + pad, top + 0.5 * height + 0.36 * size, text, size, ink);
}

}  // namespace repose
