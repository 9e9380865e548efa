#include <cmath>

#include "backends/dvi/units.hpp"

namespace repose::dvi {

Units units_of(const Model& model) {
  double radius = 0, mass = 0;
  int count = 0;
  for (const Body& body : model.bodies) {
    if (!body.dynamic) continue;
    radius += body.radius;
    mass += body.mass;
    ++count;
  }
  Units units;
  if (count == 0) return units;
  int length = 0, mass_exponent = 0;
  std::frexp(radius / count, &length);
  std::frexp(mass / count, &mass_exponent);
  units.length = std::ldexp(1.0, length);
  units.mass = std::ldexp(1.0, mass_exponent);
  // sqrt(length / g) with g near 8 m/s^2; floor keeps the exponent in step with an even change of the length's.
  const int time = static_cast<int>(std::floor(length / 2.0)) - 1;
  units.time = std::ldexp(1.0, time);
  return units;
}

}  // namespace repose::dvi
