/// Boxes, cylinders, cones and meshes: how many contact points, where, and named how.
#include <set>

#include "tests/unit/narrow_phase_samples.hpp"

namespace repose::dvi {
namespace {

PlacedPrimitive at(const Primitive& p, const Vec3& position, const Mat3& rotation = Mat3::Identity(),
                   double scale = 1) {
  return {&p, scale, position, rotation};
}

const Mat3 lying = Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitX()).toRotationMatrix();  // z axis along -y

TEST(NarrowPhaseSolid, BoxOnBoxHasFourCorners) {
  const Primitive table = Box{Vec3(2, 2, 0.5)}, box = Box{Vec3(0.5, 0.4, 0.3)};
  for (const double gap : {-0.01, 0.0, 1e-9, 0.05}) {
    const auto found = contacts(at(table, Vec3::Zero()), at(box, Vec3(0.3, -0.2, 0.8 + gap)), 0.1);
    ASSERT_EQ(found.size(), 4u) << gap;
    Vec3 middle = Vec3::Zero();
    for (const ContactPoint& c : found) {
      EXPECT_NEAR(c.gap, gap, 1e-12);
      EXPECT_LT((c.normal - Vec3::UnitZ()).norm(), 1e-9);
      middle += 0.25 * c.point;
    }
    EXPECT_LT((middle - Vec3(0.3, -0.2, 0.5 + 0.5 * gap)).norm(), 1e-9);
  }
}

TEST(NarrowPhaseSolid, BoxOverhangingAnEdgeIsClipped) {
  const Primitive table = Box{Vec3(1, 1, 0.5)}, box = Box{Vec3(0.5, 0.5, 0.5)};
  const auto found = contacts(at(table, Vec3::Zero()), at(box, Vec3(1, 0, 1)), 0.1);
  ASSERT_EQ(found.size(), 4u);
  for (const ContactPoint& c : found) EXPECT_LE(c.point.x(), 1 + 1e-12);
}

TEST(NarrowPhaseSolid, RockingBoxKeepsItsFeatures) {
  const Primitive table = Box{Vec3(2, 2, 0.5)}, box = Box{Vec3(0.5, 0.4, 0.3)};
  Samples samples(2);
  std::set<std::uint32_t> features;
  for (int k = 0; k < 50; ++k) {
    const Mat3 wobble = Eigen::AngleAxisd(1e-3, samples.direction()).toRotationMatrix();
    const auto found =
        contacts(at(table, Vec3::Zero()), at(box, Vec3(0.1, 0.1, 0.8 + samples.between(-1e-3, 1e-3)), wobble), 0.1);
    std::set<std::uint32_t> now;
    for (const ContactPoint& c : found) now.insert(c.feature);
    if (k > 0) {
      EXPECT_EQ(now, features);
    }
    features = now;
  }
  EXPECT_EQ(features.size(), 4u);
}

TEST(NarrowPhaseSolid, EdgeAcrossEdgeIsOnePoint) {
  const Primitive box = Box{Vec3(1, 1, 1)};
  const double root = std::sqrt(2);
  const Mat3 ridge_x = Eigen::AngleAxisd(0.78539816339744831, Vec3::UnitX()).toRotationMatrix();
  const Mat3 ridge_y = Eigen::AngleAxisd(0.78539816339744831, Vec3::UnitY()).toRotationMatrix();
  const auto found = contacts(at(box, Vec3::Zero(), ridge_x), at(box, Vec3(0, 0, 2 * root + 0.1), ridge_y), 0.2);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, 0.1, 1e-12);
  EXPECT_LT((found[0].point - Vec3(0, 0, root + 0.05)).norm(), 1e-9);
}

TEST(NarrowPhaseSolid, CylinderOnItsSideTouchesABoxTwice) {
  const Primitive table = Box{Vec3(2, 2, 0.5)}, can = Cylinder{0.4, 0.7};
  const auto found = contacts(at(table, Vec3::Zero()), at(can, Vec3(0, 0, 0.95), lying), 0.1);
  ASSERT_EQ(found.size(), 2u);
  for (const ContactPoint& c : found) EXPECT_NEAR(c.gap, 0.05, 1e-9);
  EXPECT_NEAR((found[0].point - found[1].point).norm(), 1.4, 1e-6);
}

TEST(NarrowPhaseSolid, CylinderOnAPlane) {
  const Primitive can = Cylinder{0.4, 0.7}, floor = HalfSpace{Vec3::UnitZ()};
  EXPECT_EQ(contacts(at(can, Vec3(0, 0, 0.7)), at(floor, Vec3::Zero()), 0.1).size(), 4u);
  const auto side = contacts(at(can, Vec3(0, 0, 0.45), lying), at(floor, Vec3::Zero()), 0.1);
  ASSERT_EQ(side.size(), 2u);
  for (const ContactPoint& c : side) EXPECT_NEAR(c.gap, 0.05, 1e-12);
}

TEST(NarrowPhaseSolid, ConeOnAPlane) {
  const Primitive cone = Cone{0.5, 1.2}, floor = HalfSpace{Vec3::UnitZ()};
  EXPECT_EQ(contacts(at(cone, Vec3::Zero()), at(floor, Vec3::Zero()), 0.1).size(), 4u);
  const double lean = 1.5707963267948966 + std::atan2(0.5, 1.2);
  const Mat3 side = Eigen::AngleAxisd(lean, Vec3::UnitY()).toRotationMatrix();
  const double height = 0.5 * std::sin(lean);
  const auto found = contacts(at(cone, Vec3(0, 0, height), side), at(floor, Vec3::Zero()), 1e-6);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR((found[0].point - found[1].point).norm(), 1.3, 1e-6);
}

TEST(NarrowPhaseSolid, BallAgainstFaceEdgeAndCornerOfABox) {
  const Primitive box = Box{Vec3(1, 2, 3)}, ball = Sphere{0.5};
  const auto face = contacts(at(ball, Vec3(1.6, 0.5, 0)), at(box, Vec3::Zero()), 1);
  ASSERT_EQ(face.size(), 1u);
  EXPECT_NEAR(face[0].gap, 0.1, 1e-15);
  const auto corner = contacts(at(ball, Vec3(2, 3, 4)), at(box, Vec3::Zero()), 2);
  ASSERT_EQ(corner.size(), 1u);
  EXPECT_NEAR(corner[0].gap, std::sqrt(3) - 0.5, 1e-14);
  const auto inside = contacts(at(ball, Vec3(0.8, 0, 0)), at(box, Vec3::Zero()), 0);
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_NEAR(inside[0].gap, -0.7, 1e-15);
  EXPECT_EQ(inside[0].normal, Vec3(-Vec3::UnitX()));
}

TEST(NarrowPhaseSolid, BallOnAMeshIsBallOnABox) {
  Samples samples(4);
  const Vec3 half(1, 0.7, 0.5);
  const Primitive box = Box{half}, mesh = Samples::block(half), ball = Sphere{0.4};
  for (int k = 0; k < 300; ++k) {
    const Vec3 p(samples.between(-1.6, 1.6), samples.between(-1.3, 1.3), samples.between(-1.1, 1.1));
    const auto on_box = contacts(at(ball, p), at(box, Vec3::Zero()), 0.2),
               on_mesh = contacts(at(ball, p), at(mesh, Vec3::Zero()), 0.2);
    ASSERT_EQ(on_box.size(), on_mesh.size()) << "at " << k;
    if (on_box.empty()) continue;
    EXPECT_NEAR(on_box[0].gap, on_mesh[0].gap, 1e-12);
    EXPECT_LT((on_box[0].normal - on_mesh[0].normal).norm(), 1e-9);
  }
}

TEST(NarrowPhaseSolid, BallOverTheDiagonalOfAFaceTouchesOnce) {
  const Primitive mesh = Samples::block(Vec3(1, 1, 1)), ball = Sphere{0.4};
  const auto found = contacts(at(ball, Vec3(0, 0, 1.4)), at(mesh, Vec3::Zero()), 0.1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, 0, 1e-14);
  EXPECT_LT((found[0].normal + Vec3::UnitZ()).norm(), 1e-12);
}

TEST(NarrowPhaseSolid, BallInAnInnerCornerOfAMeshTouchesEachWall) {
  // A slab along y with a step: floor z = 0, wall x = 1.
  TriMesh mesh;
  const std::vector<Vec2> section{Vec2(-2, -1), Vec2(2, -1), Vec2(2, 1), Vec2(1, 1), Vec2(1, 0), Vec2(-2, 0)};
  for (const double y : {-3.0, 3.0})
    for (const Vec2& p : section) mesh.vertices.emplace_back(p.x(), y, p.y());
  for (int k = 0; k < 6; ++k) {
    const int next = (k + 1) % 6;
    mesh.triangles.push_back({k, next, next + 6});
    mesh.triangles.push_back({k, next + 6, k + 6});
  }
  for (const auto& t : std::vector<std::array<int, 3>>{{0, 1, 4}, {0, 4, 5}, {1, 2, 3}, {1, 3, 4}}) {
    mesh.triangles.push_back({t[2], t[1], t[0]});
    mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  // Turn the triangles outward: then the volume is positive.
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const auto v = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    volume += v(0).dot(v(1).cross(v(2)));
  }
  if (volume < 0)
    for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  const Primitive notch = mesh, ball = Sphere{0.4};
  const auto found = contacts(at(ball, Vec3(0.58, 0.1, 0.41)), at(notch, Vec3::Zero()), 0.05);
  ASSERT_EQ(found.size(), 2u);
  std::vector<double> gaps{found[0].gap, found[1].gap};
  std::sort(gaps.begin(), gaps.end());
  EXPECT_NEAR(gaps[0], 0.01, 1e-12);
  EXPECT_NEAR(gaps[1], 0.02, 1e-12);
}

TEST(NarrowPhaseSolid, BoxOnAMeshHasItsFourCorners) {
  const Primitive mesh = Samples::block(Vec3(2, 2, 0.5)), box = Box{Vec3(0.5, 0.4, 0.3)};
  const auto found = contacts(at(box, Vec3(0.9, -0.9, 0.85)), at(mesh, Vec3::Zero()), 0.1);
  ASSERT_GE(found.size(), 4u);
  for (const ContactPoint& c : found) {
    EXPECT_NEAR(c.gap, 0.05, 1e-9);
    EXPECT_LT((c.normal + Vec3::UnitZ()).norm(), 1e-9);
  }
}

TEST(NarrowPhaseSolid, RoundConeLyingOnAMeshTouchesWithBothEnds) {
  const Primitive mesh = Samples::block(Vec3(4, 2, 0.5)), rod = RoundCone{0.3, 0.3, 2};
  const auto found = contacts(at(rod, Vec3(-0.8, 0.3, 0.85)), at(mesh, Vec3::Zero()), 0.1);
  ASSERT_GE(found.size(), 2u);
  double low = 10, high = -10;
  for (const ContactPoint& c : found) {
    EXPECT_NEAR(c.gap, 0.05, 1e-12);
    low = std::min(low, c.point.x());
    high = std::max(high, c.point.x());
  }
  EXPECT_NEAR(low, -0.8, 1e-9);
  EXPECT_NEAR(high, 1.2, 1e-9);
}

TEST(NarrowPhaseSolid, MeshOnAPlaneTouchesWithItsVertices) {
  const Primitive mesh = Samples::block(Vec3(1, 1, 0.5)), floor = HalfSpace{Vec3::UnitZ()};
  EXPECT_EQ(contacts(at(mesh, Vec3(0, 0, 0.5)), at(floor, Vec3::Zero()), 0.1).size(), 4u);
}

}  // namespace
}  // namespace repose::dvi
