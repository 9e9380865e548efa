#include "backends/dvi/touch.hpp"

#include <cmath>

namespace repose::dvi {

Touch touch_of(const Approach& a) {
  if (a.gap <= 0) return a.speed < 0 ? Touch{0, -a.speed} : Touch{};
  const double square = a.speed * a.speed - 2 * a.acceleration * a.gap;
  if (square <= 0) return {};
  const double root = std::sqrt(square), denominator = root - a.speed;
  if (!(denominator > 0) || (a.speed >= 0 && a.acceleration >= 0)) return {};
  return {2 * a.gap / denominator, root};
}

bool is_blow(const Approach& approach, const Touch& touch, double step) {
  return touch.speed > 2 * std::abs(approach.acceleration) * step;
}

}  // namespace repose::dvi
