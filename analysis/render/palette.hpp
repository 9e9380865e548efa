#pragma once
/// Colours of things in pictures, and their names in legends.
#include <string>
#include <string_view>

#include "core/math.hpp"

namespace repose {

/// The colour of a body of this shape kind, linear RGB in [0, 1]. White spheres, green ellipsoids, blue cones as in the
/// source study; the other four from the palette of Okabe & Ito (2008), which colour-blind people can tell apart.
Vec3 shape_colour(std::string_view kind);

/// The colour of the grains of the number-th population, linear RGB: white, orange, blue, and so on in the palette above.
Vec3 population_colour(std::size_t number);

/// The neutral grey of tools, linear RGB.
Vec3 tool_colour();

/// What a legend calls the kind: "uneven_twin" is "uneven twin".
std::string shape_label(std::string_view kind);

/// From sRGB in hexadecimal (0xRRGGBB) to linear RGB.
Vec3 linear_rgb(unsigned hexadecimal);

/// From linear to sRGB, one channel, both in [0, 1].
double srgb(double linear);

}  // namespace repose
