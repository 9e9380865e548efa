#include "analysis/height_grid.hpp"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/ParticlesToLevelSet.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <string>

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

// Programs tell files apart by the UUID in the header, which OpenVDB draws at random.
TEST(SurfaceFile, IsTheSameBytesForTheSameSurface) {
  const Heap heap = scattered(40, 7);
  HeightGrid grid = height_grid(heap.model, heap.state, region, 0.1);
  const std::filesystem::path folder = ::testing::TempDir();
  const auto bytes_of = [&](const char* name) {
    const std::filesystem::path file = folder / name;
    write_vdb(file, {{"before", grid}});
    EXPECT_EQ(read_vdb(file).size(), 1U);
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    in.close();
    std::filesystem::remove(file);
    return bytes;
  };
  const auto uuid_of = [](const std::string& bytes) {
    const std::regex form("[0-9a-f]{8}-[0-9a-f]{4}-8[0-9a-f]{3}-[89ab][0-9a-f]{3}-[0-9a-f]{12}");
    std::smatch found;
    EXPECT_TRUE(std::regex_search(bytes, found, form));
    return found.str();
  };
  const std::string one = bytes_of("surface_one.vdb"), two = bytes_of("surface_two.vdb");
  EXPECT_TRUE(one == two);
  for (float& z : grid.height)
    if (!std::isnan(z)) {
      z += 1e-3F;
      break;
    }
  const std::string other = bytes_of("surface_other.vdb");
  EXPECT_NE(uuid_of(one), uuid_of(other));
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

TEST(HeightGrid, HolesShowThePlate) {
  const Heap heap = scattered(40, 3);
  const HeightGrid holed = height_grid(heap.model, heap.state, region, 0.1), whole = on_plate(holed);
  std::size_t holes = 0;
  for (std::size_t k = 0; k < holed.height.size(); ++k) {
    holes += std::isnan(holed.height[k]);
    EXPECT_EQ(whole.height[k], std::isnan(holed.height[k]) ? 0 : holed.height[k]);
  }
  EXPECT_GT(holes, 10U);
  EXPECT_NEAR(coverage(holed), 1 - static_cast<double>(holes) / static_cast<double>(holed.height.size()), 1e-12);
  EXPECT_EQ(coverage(whole), 1);
}

// A hole is the plate only where the plate is: not beside it, not where a wall stands, not if the plate is at another height.
TEST(HeightGrid, AHoleIsThePlateOnlyWhereThePlateIs) {
  Heap heap = scattered(3, 3);
  const HeightGrid grid = height_grid(heap.model, heap.state, region, 0.1);
  const auto with_box = [&](const Vec3& centre, const Vec3& half) {
    Heap h = heap;
    Shape box;
    box.kind = "box";
    box.parts = {Part{Box{half}, {}}};
    box.bounding_radius = half.norm();
    h.model.shapes.push_back(box);
    Body body;
    body.shape = static_cast<int>(h.model.shapes.size()) - 1;
    body.dynamic = false;
    body.role = BodyRole::tool;
    h.model.bodies.push_back(body);
    h.state.position.push_back(centre);
    h.state.orientation.push_back(Quat::Identity());
    h.state.velocity.push_back(Vec3::Zero());
    h.state.angular_velocity.push_back(Vec3::Zero());
    return h;
  };
  const auto beside = [&](const Heap& h) { return hole_beside_plate(h.model, h.state, grid); };
  EXPECT_TRUE(beside(heap)) << "no plate at all";
  const Heap plate = with_box({3, 2, region.plate - 1}, {4, 3, 1});
  EXPECT_FALSE(beside(plate));
  EXPECT_TRUE(beside(with_box({3, 2, region.plate - 1.02}, {4, 3, 1}))) << "below, by two tenths of a cell";
  EXPECT_TRUE(beside(with_box({3, 2, region.plate - 0.9}, {4, 3, 1}))) << "above";
  const std::optional<Vec2> edge = beside(with_box({3, 2, region.plate - 1}, {2, 3, 1}));
  ASSERT_TRUE(edge);
  EXPECT_LT(std::abs(edge->x() - 3), 3.01);
  EXPECT_GT(std::abs(edge->x() - 3), 2);
  // On the plate a wall in the middle; its images hold the plate together in a periodic cell.
  heap = plate;
  EXPECT_TRUE(beside(with_box({3, 2, region.plate + 0.5}, {0.5, 0.5, 0.5})));
  heap = scattered(3, 3);
  Heap repeated = with_box({0, 2, region.plate - 1}, {3, 3, 1});
  EXPECT_TRUE(beside(repeated));
  repeated.model.periodic = {{0, 0, 0}, {6, 0, 0}};
  EXPECT_FALSE(beside(repeated));
}

TEST(HeightGrid, TellsNoPlaceWhereGrainsHideEverything) {
  Heap heap = synthetic::empty_heap(1);
  synthetic::add_sphere(heap, Vec3(3, 2, 0), 9);
  EXPECT_FALSE(hole_beside_plate(heap.model, heap.state, height_grid(heap.model, heap.state, region, 0.1)));
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

TEST(PackingOfBed, OfABarePlateIsNotDefined) {
  Heap heap = synthetic::empty_heap(1);
  synthetic::add_sphere(heap, Vec3(50, 50, 1), 0.5);
  const Packing p = packing_of_bed(heap.model, heap.state, region, 0.1, 0.5, 0.5);
  EXPECT_FALSE(p.fraction);
  EXPECT_FALSE(p.se);
  EXPECT_EQ(p.solid_volume, 0);
  EXPECT_EQ(p.pores, 0U);
  EXPECT_NEAR(p.area, 24, 1e-9);
}

// Large balls below, small ones on top, at the far end one of another shape.
TEST(Segregation, TellsSizesAndShapesByHeightAndAlongTheTravel) {
  Heap heap = synthetic::empty_heap(1);
  Shape other = synthetic::unit_sphere();
  other.kind = "other";
  heap.model.shapes.push_back(other);
  const auto add = [&](double x, double z, double radius) { synthetic::add_sphere(heap, Vec3(x, 1, z), radius); };
  for (int k = 0; k < 4; ++k) add(0.5 + k, 0.75, k % 2 == 0 ? 0.4 : 0.5);  // heights 0.5 above the plate
  for (int k = 0; k < 3; ++k) add(0.5 + k, 1.75, 0.2);                     // 1.5
  add(5.7, 1.75, 0.2);
  heap.model.bodies.back().shape = 1;
  add(7, 0.75, 9);     // outside the region
  add(0.5, 0.1, 9);    // below the plate
  EXPECT_NEAR(mean_diameter(heap.model), (2 * 0.8 + 2 * 1.0 + 4 * 0.4 + 2 * 18) / 10, 1e-12);
  const Segregation s = segregation(heap.model, heap.state, region, 1);
  EXPECT_EQ(s.kinds, (std::vector<std::string>{"other", "sphere"}));
  ASSERT_EQ(s.by_height.size(), 2U);
  const SegregationBin &low = s.by_height[0], &high = s.by_height[1];
  EXPECT_EQ(low.from, 0);
  EXPECT_EQ(high.to, 2);
  EXPECT_EQ(low.grains, 4U);
  EXPECT_NEAR(low.size, 0.9, 1e-12);
  EXPECT_NEAR(low.size_se, std::sqrt(4 * 0.01 / 3) / 2, 1e-12);
  EXPECT_EQ(low.share, (std::vector<double>{0, 1}));
  EXPECT_EQ(high.grains, 4U);
  EXPECT_NEAR(high.size, 0.4, 1e-12);
  EXPECT_NEAR(high.share[0], 0.25, 1e-12);
  EXPECT_NEAR(high.share_se[0], std::sqrt(0.25 * 0.75 / 4), 1e-12);
  // Ten bins of 0.6 along x; those without a grain are left out.
  ASSERT_EQ(s.by_x.size(), 5U);
  EXPECT_NEAR(s.by_x.front().from, 0, 1e-12);
  EXPECT_EQ(s.by_x.front().grains, 2U);
  EXPECT_NEAR(s.by_x.front().size, (0.8 + 0.4) / 2, 1e-12);
  EXPECT_NEAR(s.by_x.back().to, 6, 1e-12);
  EXPECT_EQ(s.by_x.back().share, (std::vector<double>{1, 0}));
  EXPECT_THROW(segregation(heap.model, heap.state, region, 0), Error);
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
