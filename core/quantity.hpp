#pragma once
/// Quantities with units: "58 um", "1.02 g/cm3", "127 mm/s" to SI numbers.
#include <string>
#include <string_view>

namespace repose {

/// Exponents of metre, kilogram, second, kelvin; and of the radian, which keeps 1 rad/s apart from 1 Hz.
struct Dimension {
  int length = 0, mass = 0, time = 0, temperature = 0, angle = 0;
  bool operator==(const Dimension&) const = default;
};

namespace dimension {
inline constexpr Dimension none{}, length{1, 0, 0, 0}, time{0, 0, 1, 0}, mass{0, 1, 0, 0}, velocity{1, 0, -1, 0},
    acceleration{1, 0, -2, 0}, density{-3, 1, 0, 0}, force{1, 1, -2, 0}, frequency{0, 0, -1, 0}, viscosity{-1, 1, -1, 0},
    inertia{2, 1, 0, 0}, stiffness{0, 1, -2, 0}, damping{0, 1, -1, 0}, temperature{0, 0, 0, 1}, angle{0, 0, 0, 0, 1},
    angular_velocity{0, 0, -1, 0, 1};
}

/// "m/s" for a dimension: for messages.
std::string unit_of(const Dimension& dimension);

/// Reads a number with an optional unit (a bare number is SI, angles in radians). A unit is a product of symbols with
/// prefixes and powers: "um", "g/cm3", "kg/m^3", "mPa s", "N*s/m", "rpm", "deg/s", "%". Throws Error (no place: the caller adds it) for a malformed
/// number, NaN or infinity, an unknown unit (naming the nearest) or a wrong dimension.
double parse_quantity(std::string_view text, const Dimension& expected);

}  // namespace repose
