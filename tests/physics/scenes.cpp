#include "tests/physics/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/random.hpp"

namespace repose::test {

Model pile(const Pile& pile) {
  ModelBuilder builder;
  builder.material("grain", 1000).material("wall");
  builder.law("grain", "grain", pile.law).law("grain", "wall", pile.wall_law);

  std::map<std::string, Shape> shapes;
  double reach = 0;
  for (const std::string& kind : pile.kinds) {
    shapes[kind] = make_grain_shape(kind);
    reach = std::max(reach, shapes[kind].bounding_radius);
  }
  const double cell = 2.04 * reach * pile.diameter * (1 + pile.spread), half = 0.5 * cell * pile.across;
  builder.floor("wall");
  for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
    builder.floor("wall", normal, -half * normal);

  Random random(pile.seed, 0);
  for (int i = 0; i < pile.count; ++i) {
    const int x = i % pile.across, y = i / pile.across % pile.across, z = i / (pile.across * pile.across);
    const double scale = pile.diameter * (1 + pile.spread * random.uniform(-1, 1));
    const Vec3 jitter(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    Start start;
    start.position = Vec3((x + 0.5) * cell - half, (y + 0.5) * cell - half, (z + 0.5) * cell) + 0.01 * cell * jitter;
    start.velocity = {0.1 * pile.fall * random.uniform(-1, 1), 0.1 * pile.fall * random.uniform(-1, 1), -pile.fall};
    start.orientation = random.rotation();
    builder.body("grain", shapes[pile.kinds[static_cast<std::size_t>(i) % pile.kinds.size()]], start, scale).as_grain();
  }
  return builder.build();
}

Model lattice(int across, int layers, double diameter, const PairLaw& law) {
  ModelBuilder builder;
  builder.material("grain", 1000).law("grain", "grain", law).floor("grain");
  for (int i = 0; i < across * across * layers; ++i) {
    const int x = i % across, y = i / across % across, z = i / (across * across);
    builder.sphere("grain", diameter / 2, {.position = diameter * Vec3(x, y, z + 0.5)});
  }
  return builder.build();
}

void rain(ModelBuilder& builder, const std::string& material, const FillRegion& region, int count, double diameter,
          unsigned seed) {
  const std::vector<double> radii(static_cast<std::size_t>(count), 0.5 * diameter);
  const Shape ball = make_grain_shape("sphere");
  for (const Placement& place : place_balls(region, radii, seed))
    builder.body(material, ball, {.position = place.position}, diameter).as_grain();
}

Shape tube(double inner_radius, double bottom, double top, double thickness, double outlet) {
  const double outer = inner_radius + thickness, hole = outlet / 2;
  Revolved solid;
  if (outlet > 0) {
    solid.profile = {{hole, bottom - thickness}, {outer, bottom - thickness}, {outer, top},
                     {inner_radius, top},        {inner_radius, bottom},      {hole, bottom}};
  } else {
    solid.profile = {{inner_radius, bottom}, {outer, bottom}, {outer, top}, {inner_radius, top}};
  }
  return shape_of("tube", solid);
}

}  // namespace repose::test
