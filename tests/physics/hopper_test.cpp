/// Discharge through a round hole in a flat floor: Beverloo's law, W = C rho_b sqrt(g) (D - k d)^(5/2).
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/physics/answer.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Hopper : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Hopper);

constexpr double d = 0.02, g = 9.81, radius = 6.5 * d, grain_volume = M_PI / 6 * d * d * d;
constexpr int count = 1850, first_grain = 2;
// Grains that have left: when the flow is steady, half-way, and while the fill is still high.
constexpr int from = 100, half = 350, to = 600;

struct Discharge {
  double fraction = 0;    ///< of solid in the fill before the hole opens
  double height = 0;      ///< of the fill at the end of the measurement [m]
  std::vector<int> left;  ///< grains that have left, after each step since the hole opened
};

Discharge discharge(const std::string& backend, double outlet, double h, unsigned seed) {
  const double thickness = 0.5 * d, opens = 0.6;
  ModelBuilder builder;
  const PairLaw law{.friction = 0.5};
  builder.material("ball", 1000).material("wall").law("ball", "ball", law).law("ball", "wall", law);
  builder.wall("wall", tube(radius, 0, 80 * d, thickness, outlet));
  // A shut gate holds what overlaps it by less than its tolerance: grains sink into it by the solver's.
  builder
      .wall("wall", shape_of("shutter", Cylinder{outlet / 2 + d, d / 2}),
            {{0, 0, -thickness - d / 2}, Quat::Identity()})
      .active({{0, opens}}, d);
  FillRegion region;
  region.kind = FillRegion::Kind::frustum;
  region.radius_bottom = region.radius_top = radius;
  region.height = 10 * d;
  rain(builder, "ball", region, count, d, seed);
  Simulation s(backend, builder.build(), usual(h, 3e-3));
  s.run(static_cast<int>(opens / h));

  Discharge result;
  const double low = 2 * d, high = 8 * d;
  for (int i = 0; i < count; ++i) {
    const double z = s.position(first_grain + i).z();
    result.fraction += z > low && z < high ? grain_volume / (M_PI * radius * radius * (high - low)) : 0.0;
  }
  do {
    s.step();
    int n = 0;
    for (int i = 0; i < count; ++i) n += s.position(first_grain + i).z() < -thickness;
    result.left.push_back(n);
  } while (result.left.back() < to && result.left.size() < 3000);
  for (int i = 0; i < count; ++i)
    result.height += 2 * std::max(0.0, s.position(first_grain + i).z()) / (count - result.left.back());
  return result;
}

/// Grains per second between the moments at which `first` and `last` have left.
double rate(const std::vector<int>& left, int first, int last, double h) {
  int start = 0, end = 0;
  for (const int n : left) {
    start += n < first;
    end += n < last;
  }
  return (left[static_cast<std::size_t>(end)] - left[static_cast<std::size_t>(start)]) / ((end - start) * h);
}

/// Grains per second.
double beverloo(double outlet, double fraction) {
  return 0.58 * fraction / grain_volume * std::sqrt(g) * std::pow(outlet - 1.4 * d, 2.5);
}

TEST_P(Hopper, FlowFollowsBeverlooAndNotTheFillHeight) {
  // Grains leave one by one, through arches that form and break: the flow of a hundred grains in a row varies by 5 to 8
  // % (standard deviation), that of 250 by 3 to 5 %, and fillings differ by 3 to 4 %. On DVI eight are averaged: the mean stands
  // 11 to 12 % below the law, known to 1 %, which two fillings took past 15 % now and then. The others take longer.
  const std::vector<unsigned> fillings =
      GetParam() == "dvi" ? std::vector<unsigned>{1, 2, 3, 4, 5, 6, 7, 8} : std::vector<unsigned>{1, 9};
  const auto share = 1 / static_cast<double>(fillings.size());
  const double h = 2e-3;
  const double outlets[] = {5 * d, 6.5 * d};
  double measured[2] = {}, fraction[2] = {}, late[2] = {};
  for (int k = 0; k < 2; ++k) {
    const std::string name = "hopper, D = " + std::to_string(outlets[k] / d).substr(0, 3) + " d";
    for (const unsigned seed : fillings) {
      const Discharge flow = discharge(GetParam(), outlets[k], h, seed);
      ASSERT_GE(flow.left.back(), to) << "the hole is blocked";
      measured[k] += share * rate(flow.left, from, to, h);
      late[k] += share * rate(flow.left, half, to, h) / rate(flow.left, from, half, h);
      fraction[k] += share * flow.fraction;
      note(name + ", filling " + std::to_string(seed) + ": height of the fill at the end / D",
           flow.height / outlets[k]);
      EXPECT_GT(flow.height, 1.2 * outlets[k]);
    }
    note(name + ": volume fraction of the fill", fraction[k]);
    expect_answer({name + ": grains per second", beverloo(outlets[k], fraction[k]), measured[k], 0.15}, GetParam());
    expect_answer({name + ": flow of grains 350-600 / of 100-350", 1, late[k], 0.12}, GetParam());
  }
  expect_answer(
      {"hopper: flow at 6.5 d / at 5.0 d", std::pow((6.5 - 1.4) / (5 - 1.4), 2.5), measured[1] / measured[0], 0.1},
      GetParam());
}

}  // namespace
}  // namespace repose::test
