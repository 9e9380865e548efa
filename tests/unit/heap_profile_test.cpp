#include "analysis/heap_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "tests/unit/synthetic_heap.hpp"

namespace repose {
namespace {

TEST(FindHeap, SortsGrainsByWhereTheyAre) {
  synthetic::Heap heap = synthetic::empty_heap(10);
  heap.site.rim_height = 1;
  synthetic::add_sphere(heap, Vec3(0, 0, 0.5), 0.5);      // on the plate
  synthetic::add_sphere(heap, Vec3(0, 0, 1.5), 0.5);      // on that one
  synthetic::add_sphere(heap, Vec3(0, 0, 8), 0.5);        // in the air
  synthetic::add_sphere(heap, Vec3(3, 0, 0.5), 0.5);      // passing through: too fast to be at rest
  synthetic::add_sphere(heap, Vec3(10.5, 0, 1.5), 0.5);   // on the rim
  synthetic::add_sphere(heap, Vec3(14, 0, -4), 0.5);      // in the trench
  heap.state.velocity[3] = Vec3(0, 0, -10);
  const HeapGrains g = find_heap(heap.model, heap.state, heap.site);
  EXPECT_EQ(g.heap, (std::vector<int>{0, 1}));
  EXPECT_EQ(g.loose, (std::vector<int>{2, 3}));
  EXPECT_EQ(g.rim, (std::vector<int>{4}));
  EXPECT_EQ(g.trench, (std::vector<int>{5}));
  EXPECT_DOUBLE_EQ(g.diameter, 1);
  EXPECT_DOUBLE_EQ(g.heap_mass, 2 * heap.model.bodies[0].mass);
  EXPECT_DOUBLE_EQ(g.trench_mass, heap.model.bodies[0].mass);
}

TEST(FindHeap, ChecksItsInput) {
  synthetic::Heap heap = synthetic::empty_heap(10);
  EXPECT_TRUE(find_heap(heap.model, heap.state, heap.site).heap.empty());
  synthetic::add_sphere(heap, Vec3(0, 0, 0.5), 0.5);
  heap.state.position.clear();
  EXPECT_THROW(find_heap(heap.model, heap.state, heap.site), Error);
}

TEST(HeightMap, OneSphere) {
  synthetic::Heap heap = synthetic::empty_heap(4);
  heap.site.centre = Vec3(1, 2, 3);
  synthetic::add_sphere(heap, Vec3(1, 2, 3.5), 0.5);
  const HeapGrains grains = find_heap(heap.model, heap.state, heap.site);
  const HeightMap map = height_map(heap.model, heap.state, grains, heap.site, 8);
  EXPECT_EQ(map.size, 64);
  double highest = 0, volume = 0;
  for (int j = 0; j < map.size; ++j)
    for (int i = 0; i < map.size; ++i) {
      const double r = (map.column(i, j) - Vec2(1, 2)).norm();
      EXPECT_NEAR(map.at(i, j), r < 0.5 ? 0.5 + std::sqrt(0.25 - r * r) : 0, 1e-12);
      highest = std::max(highest, map.at(i, j));
      volume += map.at(i, j) * map.pixel * map.pixel;
    }
  EXPECT_NEAR(highest, 1, 0.01);
  EXPECT_NEAR(volume, std::numbers::pi * (0.125 + 0.25 / 3), 0.03);
  EXPECT_THROW(height_map(heap.model, heap.state, grains, heap.site, 0), Error);
}

TEST(RadialProfile, LayerOfOneHeight) {
  // Spheres so close that their common top is nearly flat.
  synthetic::Heap heap = synthetic::empty_heap(6);
  for (double x = -6; x <= 6; x += 0.25)
    for (double y = -6; y <= 6; y += 0.25) synthetic::add_sphere(heap, Vec3(x, y, 0.5), 0.5);
  const HeapGrains grains = find_heap(heap.model, heap.state, heap.site);
  const RadialProfile p = radial_profile(height_map(heap.model, heap.state, grains, heap.site), heap.site, grains.diameter);
  ASSERT_EQ(p.radius.size(), 6u);
  for (std::size_t i = 0; i + 1 < p.radius.size(); ++i) {
    EXPECT_NEAR(p.radius[i], static_cast<double>(i) + 0.5, 0.2);
    EXPECT_NEAR(p.height[i], 1, 0.05);
  }
  EXPECT_TRUE(p.covers_base);
  EXPECT_NEAR(p.coverage, 1, 0.02);
  EXPECT_DOUBLE_EQ(p.foot, 6);
}

TEST(RadialProfile, ConeHasItsSlope) {
  const auto heap = synthetic::make_cone(synthetic::make_packing(3), 30, 20, 1, 2.0, 0.8);
  const HeapGrains grains = find_heap(heap.model, heap.state, heap.site);
  const RadialProfile p = radial_profile(height_map(heap.model, heap.state, grains, heap.site), heap.site, grains.diameter);
  EXPECT_NEAR(p.foot / 2, 16, 2);
  EXPECT_FALSE(p.covers_base);
  EXPECT_NEAR((p.height[3] - p.height[11]) / (p.radius[11] - p.radius[3]), std::tan(std::numbers::pi / 6), 0.05);
}

TEST(HeapSite, ComesFromTheBaseTool) {
  Scene scene;
  EXPECT_FALSE(heap_site(scene));
  Tool tool;
  tool.name = "base";
  Base base;
  base.diameter = 3;
  base.rim_height = 0.1;
  tool.kind = base;
  tool.position = Vec3(1, 2, 3);
  scene.tools = {tool};
  const auto site = heap_site(scene);
  ASSERT_TRUE(site);
  EXPECT_EQ(site->centre, Vec3(1, 2, 3));
  EXPECT_EQ(site->radius, 1.5);
  EXPECT_EQ(site->rim_height, 0.1);
}

}  // namespace
}  // namespace repose
