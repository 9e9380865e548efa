#include "analysis/height_grid.hpp"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/ParticlesToLevelSet.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "analysis/bed_structure.hpp"
#include "core/error.hpp"
#include "tests/unit/synthetic_heap.hpp"

namespace repose {
namespace {

using synthetic::Heap;

const SurfaceRegion region{{0, 0}, {6, 4}, 0.25};

/// Balls of several sizes dropped anywhere in a box of 6 x 4 x 3: overlapping, with holes down to the plate.
Heap scattered(int count, std::uint64_t seed, const Vec3& lower = Vec3(0, 0, 0.5), const Vec3& upper = Vec3(6, 4, 3)) {
  Heap heap = synthetic::empty_heap(1);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < count; ++i) {
    const Vec3 share(uniform(random), uniform(random), uniform(random));
    synthetic::add_sphere(heap, lower + share.cwiseProduct(upper - lower), 0.2 + 0.3 * uniform(random));
  }
  return heap;
}

TEST(HeightGrid, IsTheHighestBallOverEachPoint) {
  const Heap heap = scattered(40, 3);
  const HeightGrid grid = height_grid(heap.model, heap.state, region, 0.1);
  ASSERT_EQ(grid.nx, 60);
  ASSERT_EQ(grid.ny, 40);
  int holes = 0;
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      double top = -1;
      for (std::size_t k = 0; k < heap.model.bodies.size(); ++k) {
        const double r = heap.model.bodies[k].radius;
        const double left = r * r - (heap.state.position[k].head<2>() - grid.middle(i, j)).squaredNorm();
        if (left >= 0) top = std::max(top, heap.state.position[k].z() + std::sqrt(left) - region.plate);
      }
      holes += top < 0;
      if (top < 0)
        EXPECT_TRUE(grid.is_hole(i, j));
      else
        EXPECT_NEAR(grid.at(i, j), top, 1e-6);
    }
  EXPECT_GT(holes, 10);  // else holes were not tested
}

TEST(HeightGrid, ImagesStandBeyondThePeriodicSides) {
  // In open space with the images put there by hand, and in the cell.
  Heap cell = scattered(60, 5);
  cell.model.periodic = {{0, 0, 0}, {6, 4, 0}};
  Heap open = synthetic::empty_heap(1);
  for (std::size_t k = 0; k < cell.model.bodies.size(); ++k)
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        synthetic::add_sphere(open, cell.state.position[k] + Vec3(6 * x, 4 * y, 0), cell.model.bodies[k].radius);
  const HeightGrid a = height_grid(cell.model, cell.state, region, 0.1), b = height_grid(open.model, open.state, region, 0.1);
  for (std::size_t k = 0; k < a.height.size(); ++k)
    if (std::isnan(b.height[k]))
      EXPECT_TRUE(std::isnan(a.height[k]));
    else
      EXPECT_NEAR(a.height[k], b.height[k], 1e-6);
  const Packing p = packing_of_bed(cell.model, cell.state, region, 0.05, 0.5, 1);
  const Packing q = packing_of_bed(open.model, open.state, region, 0.05, 0.5, 1);
  EXPECT_NEAR(p.solid_volume, q.solid_volume, 1e-5 * q.solid_volume);
  cell.model.periodic = {};
  EXPECT_LT(packing_of_bed(cell.model, cell.state, region, 0.05, 0.5, 1).solid_volume, 0.99 * q.solid_volume);
}

TEST(HeightGrid, RefusesARegionBeyondThePeriodicSides) {
  Heap heap = scattered(3, 1);
  heap.model.periodic = {{0, 0, 0}, {0, 4, 0}};
  EXPECT_NO_THROW(height_grid(heap.model, heap.state, {{-9, 0}, {9, 4}, 0}, 0.1));
  EXPECT_THROW(height_grid(heap.model, heap.state, {{0, -0.1}, {6, 4}, 0}, 0.1), Error);
  EXPECT_THROW(height_grid(heap.model, heap.state, {{0, 0}, {0.05, 4}, 0}, 0.1), Error);
}

TEST(SurfaceFile, ReadsBackBitForBitAndHolesAreInactive) {
  const Heap heap = scattered(40, 7);
  const HeightGrid fine = height_grid(heap.model, heap.state, region, 0.1);
  HeightGrid small = height_grid(heap.model, heap.state, region, 0.25);
  small.cell *= 5e-6;  // the size of a real one
  small.origin *= 5e-6;
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "height_grid_test.vdb";
  write_vdb(file, {{"before", fine}, {"after", small}});
  const std::vector<NamedGrid> back = read_vdb(file);
  ASSERT_EQ(back.size(), 2U);
  EXPECT_NE(back[0].name, back[1].name);
  for (std::size_t k = 0; k < 2; ++k) {
    ASSERT_TRUE(back[k].name == "before" || back[k].name == "after");
    const HeightGrid &put = back[k].name == "before" ? fine : small, &got = back[k].grid;
    EXPECT_EQ(got.origin, put.origin);
    EXPECT_EQ(got.plate, put.plate);
    EXPECT_EQ(got.cell, put.cell);
    ASSERT_EQ(got.nx, put.nx);
    ASSERT_EQ(got.ny, put.ny);
    for (std::size_t c = 0; c < put.height.size(); ++c)
      EXPECT_TRUE(got.height[c] == put.height[c] || (std::isnan(got.height[c]) && std::isnan(put.height[c])));
  }
  // As any other program would see it.
  openvdb::io::File in(file.string());
  in.open();
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(in.readGrid("before"));
  std::size_t covered = 0;
  for (float z : fine.height) covered += !std::isnan(z);
  EXPECT_EQ(grid->activeVoxelCount(), covered);
  EXPECT_LT(covered, fine.height.size());
  const openvdb::Vec3d at = grid->indexToWorld(openvdb::Vec3d(3, 5, 0));
  EXPECT_NEAR(at.x() * 1e-6, fine.middle(3, 5).x(), 1e-9);
  EXPECT_NEAR(at.y() * 1e-6, fine.middle(3, 5).y(), 1e-9);
  in.close();
  std::filesystem::remove(file);
}

TEST(SurfaceFile, RefusesWhatIsNoSurface) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "height_grid_test_broken.vdb";
  EXPECT_THROW(read_vdb(file), Error);
  std::ofstream(file) << "not a surface";
  EXPECT_THROW(read_vdb(file), Error);
  std::filesystem::remove(file);
}

/// What ParticlesToLevelSet asks of a list of particles.
struct Particles {
  using PosType = openvdb::Vec3R;
  const Heap& heap;
  std::size_t size() const { return heap.model.bodies.size(); }
  void getPos(std::size_t n, openvdb::Vec3R& p) const {
    const Vec3& x = heap.state.position[n];
    p = {x.x(), x.y(), x.z()};
  }
  void getPosRad(std::size_t n, openvdb::Vec3R& p, openvdb::Real& r) const {
    getPos(n, p);
    r = heap.model.bodies[n].radius;
  }
};

// The slow oracle, OpenVDB's signed distances: nothing of the powder lies above the surface, and the surface is where the
// distance is zero.
TEST(HeightGrid, AgreesWithOpenVdbsLevelSet) {
  openvdb::initialize();
  const Heap heap = scattered(60, 11);
  constexpr double voxel = 0.02;
  const openvdb::FloatGrid::Ptr distance = openvdb::createLevelSet<openvdb::FloatGrid>(voxel, 3);
  openvdb::tools::ParticlesToLevelSet<openvdb::FloatGrid> raster(*distance);
  const Particles particles{heap};
  raster.rasterizeSpheres(particles);
  raster.finalize();

  // Cell middles on the columns of the level set.
  SurfaceRegion shifted = region;
  shifted.lower.array() -= 0.5 * voxel;
  shifted.upper.array() -= 0.5 * voxel;
  const HeightGrid grid = height_grid(heap.model, heap.state, shifted, voxel);
  const auto values = distance->getConstAccessor();
  int compared = 0, holes = 0;
  double sum = 0;
  for (int j = 0; j < grid.ny; j += 3)
    for (int i = 0; i < grid.nx; i += 3) {
      const Vec2 at = grid.middle(i, j);
      const int x = static_cast<int>(std::lround(at.x() / voxel)), y = static_cast<int>(std::lround(at.y() / voxel));
      const bool hole = grid.is_hole(i, j);
      const double top = hole ? 0 : (grid.at(i, j) + region.plate) / voxel;  // in voxels
      const int below = static_cast<int>(std::floor(top));
      for (int z = below + 1; z < 4 / voxel; ++z) ASSERT_GT(values.getValue({x, y, z}), 0) << x << " " << y << " " << z;
      holes += hole;
      if (hole) continue;
      // A distance changes by no more than the way: the line between two voxels is off by half of one at most.
      const double share = top - below;
      const double here = (1 - share) * values.getValue({x, y, below}) + share * values.getValue({x, y, below + 1});
      EXPECT_LE(std::abs(here), 0.5 * voxel);
      sum += std::abs(here);
      ++compared;
    }
  EXPECT_GT(compared, 3000);
  EXPECT_GT(holes, 100);
  EXPECT_LT(sum / compared, 0.02 * voxel);
}

TEST(HighestGrains, OfEachSquareByCentreAndByTop) {
  Heap heap = synthetic::empty_heap(1);
  synthetic::add_sphere(heap, Vec3(0.5, 0.5, 1), 0.4);  // small, its centre the highest of the square
  synthetic::add_sphere(heap, Vec3(0.6, 0.5, 0.9), 0.6);  // large, its top is
  synthetic::add_sphere(heap, Vec3(2.5, 0.5, 2), 0.3);
  const HighestGrains h = highest_grains(heap.model, heap.state, {{0, 0}, {3, 1}, 0.25}, 1);
  ASSERT_EQ(h.centre.size(), 3U);
  EXPECT_DOUBLE_EQ(h.centre[0], 0.75);
  EXPECT_DOUBLE_EQ(h.top[0], 1.25);
  EXPECT_TRUE(std::isnan(h.centre[1]));
  EXPECT_DOUBLE_EQ(h.top[2], 2.05);
}

TEST(PackingOfBed, CubicLatticeWithItsPores) {
  // Touching unit balls: pi/6 of the volume; upright chords through the gaps between balls above one another.
  Heap heap = synthetic::empty_heap(1);
  heap.model.periodic = {{0, 0, 0}, {4, 4, 0}};
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 5; ++z) synthetic::add_sphere(heap, Vec3(x + 0.5, y + 0.5, z + 0.5), 0.5);
  const Packing p = packing_of_bed(heap.model, heap.state, {{0, 0}, {1, 1}, 0}, 0.005, 1, 0.2);
  ASSERT_EQ(p.solid.size(), 5U);
  for (double solid : p.solid) EXPECT_NEAR(solid, std::numbers::pi / 6, 1e-3);
  EXPECT_NEAR(p.solid_volume, 5 * std::numbers::pi / 6, 2e-3);
  // A line that meets a ball runs through 2/3 of its diameter in the mean: pores of 1/3 between two balls, of 1/6 at the plate.
  EXPECT_NEAR(p.pore_mean, (4.0 / 3 + 1.0 / 6) / 5, 1e-3);
  EXPECT_TRUE(p.se.has_value());
  EXPECT_FALSE(packing_of_bed(heap.model, heap.state, {{0, 0}, {1, 1}, 0}, 0.05, 1, 0.5).se) << "four blocks";
}

}  // namespace
}  // namespace repose
