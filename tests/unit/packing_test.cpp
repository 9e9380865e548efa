#include "analysis/packing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "tests/unit/synthetic_heap.hpp"

namespace repose {
namespace {

// Simple cubic lattice of touching unit spheres: volume fraction pi / 6.
synthetic::Heap lattice(double spacing) {
  synthetic::Heap heap = synthetic::empty_heap(6);
  for (double x = -7; x <= 7; x += spacing)
    for (double y = -7; y <= 7; y += spacing)
      for (double z = 0.5; z < 11; z += spacing) synthetic::add_sphere(heap, Vec3(x, y, z), 0.5);
  return heap;
}

std::vector<int> all(const synthetic::Heap& heap) {
  std::vector<int> bodies(heap.model.bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i] = static_cast<int>(i);
  return bodies;
}

TEST(Packing, CubicLattice) {
  const auto heap = lattice(1);
  const SolidFraction f = solid_fraction_in_cylinder(heap.model, heap.state, all(heap), Vec3(0, 0, 1), 5, 8, 40000);
  EXPECT_NEAR(f.value, std::numbers::pi / 6, 0.004);
  EXPECT_NEAR(f.volume, std::numbers::pi * 25 * 8, 1e-9);
  EXPECT_LT(f.se, 0.01);
}

TEST(Packing, OverlapCountsOnce) {
  synthetic::Heap heap = synthetic::empty_heap(2);
  synthetic::add_sphere(heap, Vec3(0, 0, 1), 1);
  synthetic::add_sphere(heap, Vec3(0, 0, 1), 1);
  const SolidFraction f = solid_fraction_in_cylinder(heap.model, heap.state, all(heap), Vec3(0, 0, 0), 1, 2, 40000);
  EXPECT_NEAR(f.value, 2.0 / 3, 0.004);  // Archimedes
}

TEST(Packing, ImagesCountInAPeriodicCell) {
  // One layer of the lattice in a cell that cuts through its balls, sampled across the seam.
  synthetic::Heap heap = synthetic::empty_heap(6);
  heap.model.periodic = {{0, 0, 0}, {4, 3, 0}};
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 6; ++z) synthetic::add_sphere(heap, Vec3(x, y, z + 0.5), 0.5);
  for (const Vec3& base : {Vec3(0, 0, 1), Vec3(2, 1.5, 1), Vec3(-9, 7, 1)}) {
    const SolidFraction f = solid_fraction_in_cylinder(heap.model, heap.state, all(heap), base, 10, 4, 40000);
    EXPECT_NEAR(f.value, std::numbers::pi / 6, 0.005);
  }
  heap.model.periodic = {};
  EXPECT_LT(solid_fraction_in_cylinder(heap.model, heap.state, all(heap), Vec3(2, 1.5, 1), 10, 4, 40000).value, 0.03);
}

TEST(Packing, NothingThere) {
  const auto heap = lattice(1);
  EXPECT_EQ(solid_fraction_in_cylinder(heap.model, heap.state, all(heap), Vec3(0, 0, 100), 1, 1, 100).value, 0);
  EXPECT_EQ(solid_fraction_in_cylinder(heap.model, heap.state, {}, Vec3(0, 0, 0), 1, 1, 100).value, 0);
  EXPECT_THROW(solid_fraction_in_cylinder(heap.model, heap.state, {}, Vec3::Zero(), 0, 1), Error);
}

TEST(Packing, HeapInteriorIsThatOfItsPacking) {
  const auto packing = synthetic::make_packing(3);
  double overlap_free = 0;
  for (double r : packing.radius) overlap_free += 4 * std::numbers::pi / 3 * r * r * r;
  overlap_free /= std::pow(packing.side, 3);
  EXPECT_NEAR(overlap_free, 0.58, 1e-9);
  const auto heap = synthetic::make_cone(packing, 32, 20, 1, 58e-6);
  const HeapGrains grains = find_heap(heap.model, heap.state, heap.site);
  const HeightMap map = height_map(heap.model, heap.state, grains, heap.site);
  const auto f = heap_solid_fraction(heap.model, heap.state, grains, heap.site, map);
  ASSERT_TRUE(f);
  // What overlaps the push left makes the union a little less than the sum.
  EXPECT_NEAR(f->value, 0.58, 0.012);
  EXPECT_GT(f->se, 0);
  EXPECT_LT(f->se, 0.01);
  // The mean top of the columns is within half a diameter of the cut.
  const double plate = std::numbers::pi * std::pow(20 * 58e-6, 2);
  EXPECT_NEAR(heap_volume(map) / plate / 58e-6, 20 * std::tan(32 * std::numbers::pi / 180) / 3, 0.5);
}

TEST(Packing, NoInteriorNoAnswer) {
  auto heap = synthetic::empty_heap(10);
  for (int i = -9; i < 9; ++i) synthetic::add_sphere(heap, Vec3(i, 0, 0.5), 0.5);
  const HeapGrains grains = find_heap(heap.model, heap.state, heap.site);
  const HeightMap map = height_map(heap.model, heap.state, grains, heap.site);
  EXPECT_FALSE(heap_solid_fraction(heap.model, heap.state, grains, heap.site, map));
}

}  // namespace
}  // namespace repose
