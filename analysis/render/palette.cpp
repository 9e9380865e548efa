#include "analysis/render/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace repose {
namespace {

constexpr std::array<std::pair<std::string_view, unsigned>, 7> colours{{
    {"sphere", 0xf4f3ee},
    {"ellipsoid", 0x0fa37a},
    {"twin", 0xe69f00},
    {"uneven_twin", 0xf0e05a},
    {"sphere_cone", 0x2a7fc9},
    {"sphere_ellipsoid", 0xd55e1e},
    {"pierced_twin", 0xc77aa8},
}};

double linear_channel(unsigned value) {
  const double v = static_cast<double>(value & 0xffU) / 255;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

}  // namespace

Vec3 linear_rgb(unsigned hexadecimal) {
  return {linear_channel(hexadecimal >> 16U), linear_channel(hexadecimal >> 8U), linear_channel(hexadecimal)};
}

double srgb(double linear) {
  const double v = std::clamp(linear, 0.0, 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

Vec3 shape_colour(std::string_view kind) {
  for (const auto& [name, colour] : colours)
    if (name == kind) return linear_rgb(colour);
  return linear_rgb(0xb9a98c);
}

Vec3 population_colour(std::size_t number) {
  constexpr std::array<std::size_t, 7> order{0, 2, 4, 1, 6, 3, 5};  // far apart first
  return linear_rgb(colours[order[number % order.size()]].second);
}

Vec3 tool_colour() { return linear_rgb(0x9aa0a6); }

std::string shape_label(std::string_view kind) {
  std::string label(kind);
  std::replace(label.begin(), label.end(), '_', ' ');
  return label;
}

}  // namespace repose
