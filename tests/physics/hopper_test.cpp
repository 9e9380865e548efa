/// Discharge through a round hole in a flat floor: Beverloo's law, W = C rho_b sqrt(g) (D - k d)^(5/2).
#include <cmath>
#include <vector>

#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Hopper : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Hopper);

constexpr double d = 0.02, g = 9.81, radius = 5.5 * d;
constexpr int count = 1100, first_grain = 2;

/// Grains that have left, after each step since the hole opened.
std::vector<int> discharge(const std::string& backend, double outlet, double h, int stop_at) {
  const double thickness = 0.5 * d, opens = 0.7;
  ModelBuilder builder;
  const PairLaw law{.friction = 0.5, .rolling_friction = 0.02, .spinning_friction = 0.02};
  builder.material("ball", 1000).material("wall").law("ball", "ball", law).law("ball", "wall", law);
  builder.wall("wall", tube(radius, 0, 60 * d, thickness, outlet));
  builder
      .wall("wall", shape_of("shutter", Cylinder{outlet / 2 + d, d / 2}),
            {{0, 0, -thickness - d / 2}, Quat::Identity()})
      .active({{0, opens}}, 0);
  FillRegion region;
  region.kind = FillRegion::Kind::frustum;
  region.radius_bottom = region.radius_top = radius;
  region.height = 10 * d;
  rain(builder, "ball", region, count, d, 9);
  Simulation s(backend, builder.build(), usual(h, 3e-3));
  s.run(static_cast<int>(opens / h));
  std::vector<int> left;
  do {
    s.step();
    int n = 0;
    for (int i = 0; i < count; ++i) n += s.position(first_grain + i).z() < -thickness;
    left.push_back(n);
  } while (left.back() < stop_at && left.size() < 6000);
  return left;
}

/// Grains per second between the moments at which `from` and `to` have left.
double rate(const std::vector<int>& left, int from, int to, double h) {
  int first = 0, last = 0;
  for (const int n : left) {
    first += n < from;
    last += n < to;
  }
  return (to - from) / ((last - first) * h);
}

double beverloo(double outlet) {
  const double fraction = 0.58, grain_volume = M_PI / 6 * d * d * d;
  return 0.58 * fraction / grain_volume * std::sqrt(g) * std::pow(outlet - 1.4 * d, 2.5);
}

TEST_P(Hopper, FlowFollowsBeverlooAndNotTheFillHeight) {
  const double h = 1.2e-3;
  double measured[2];
  const double outlets[] = {4.5 * d, 6.5 * d};
  for (int k = 0; k < 2; ++k) {
    const std::vector<int> left = discharge(GetParam(), outlets[k], h, 650);
    ASSERT_GE(left.back(), 650) << "the hole is blocked";
    const double high = rate(left, 50, 350, h), low = rate(left, 350, 650, h);
    measured[k] = rate(left, 50, 650, h);
    const std::string name = "hopper, D = " + std::to_string(outlets[k] / d).substr(0, 3) + " d";
    expect_answer({name + ": grains per second", beverloo(outlets[k]), measured[k], 0.15}, GetParam());
    expect_answer({name + ": flow of grains 350-650 / of 50-350", 1, low / high, 0.12}, GetParam());
  }
  expect_answer(
      {"hopper: flow at 6.5 d / at 4.5 d", std::pow((6.5 - 1.4) / (4.5 - 1.4), 2.5), measured[1] / measured[0], 0.15},
      GetParam());
}

}  // namespace
}  // namespace repose::test
