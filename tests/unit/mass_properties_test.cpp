#include "core/mass_properties.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "core/random.hpp"
#include "core/union_integrals.hpp"
#include "tests/unit/lattice_mass.hpp"

namespace repose {
namespace {

constexpr double pi = std::numbers::pi;

Part at(Primitive primitive, const Vec3& position, const Quat& orientation = Quat::Identity()) {
  return {std::move(primitive), {position, orientation}};
}

// `tolerance`: relative to the body's volume, size and largest moment.
void expect_same(const MassProperties& m, const MassProperties& expected, double tolerance) {
  const double size = std::cbrt(expected.volume);
  EXPECT_NEAR(m.volume, expected.volume, tolerance * expected.volume);
  EXPECT_LE((m.centre - expected.centre).norm(), tolerance * size)
      << m.centre.transpose() << " against " << expected.centre.transpose();
  EXPECT_LE((m.inertia - expected.inertia).cwiseAbs().maxCoeff(), tolerance * expected.inertia.cwiseAbs().maxCoeff())
      << m.inertia << "\nagainst\n"
      << expected.inertia;
}

TriMesh box_mesh(const Vec3& lower, const Vec3& upper) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(i & 1 ? upper.x() : lower.x(), i & 2 ? upper.y() : lower.y(),
                               i & 4 ? upper.z() : lower.z());
  for (const auto& q : {std::array{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

TEST(MassProperties, PrimitivesAgainstCounting) {
  const std::vector<Primitive> primitives{Sphere{0.7},
                                          Ellipsoid{{0.5, 0.9, 0.4}},
                                          RoundCone{0.6, 0.3, 0.8},
                                          Cone{0.5, 1.1},
                                          Box{{0.3, 0.4, 0.8}},
                                          Cylinder{0.6, 0.5},
                                          RoundCone{0.3, 0.6, 0.8},
                                          RoundCone{0.5, 0, 1.2},
                                          Revolved{{{0.2, 0}, {0.9, 0.1}, {0.7, 0.8}, {0.4, 0.5}}}};
  for (const Primitive& primitive : primitives) {
    SCOPED_TRACE(primitive.index());
    const auto inside = [&](const Vec3& p) { return contains(primitive, p); };
    const Part part{primitive, {}};
    Vec3 lower, upper;
    for (int i = 0; i < 3; ++i) upper[i] = support(part, Vec3::Unit(i)), lower[i] = -support(part, -Vec3::Unit(i));
    expect_same(mass_properties(primitive),
                test::lattice_mass(inside, (lower + upper) / 2, (upper - lower) / 2, 400'000), 1e-3);
  }
}

TEST(MassProperties, SphereConeByHand) {
  // Sphere of radius 1, apex at 2: the cone touches at x = 1/2, its base has radius sqrt(3)/2.
  const MassProperties m = mass_properties(RoundCone{1, 0, 2});
  const double cone = pi / 3 * 0.75 * 1.5, sphere = pi * (0.5 + 1 - (0.125 + 1) / 3);
  EXPECT_NEAR(m.volume, cone + sphere, 1e-14);
  const double sphere_moment = pi * ((0.25 - 1) / 2 - (1.0 / 16 - 1) / 4);
  EXPECT_NEAR(m.centre.x(), (cone * (0.5 + 1.5 / 4) + sphere_moment) / (cone + sphere), 1e-14);
}

TEST(MassProperties, MeshesAndRevolvedSolidsAreExact) {
  const Vec3 shift(5, -3, 2), half(0.3, 0.4, 0.8);
  MassProperties box = mass_properties(Box{half});
  box.centre = shift;
  expect_same(mass_properties(box_mesh(shift - half, shift + half)), box, 1e-13);
  expect_same(mass_properties(Revolved{{{0, -2}, {1, -2}, {1, 2}, {0, 2}}}), mass_properties(Cylinder{1, 2}), 1e-14);
  expect_same(mass_properties(Revolved{{{0, 0}, {1, 0}, {0, 3}}}), mass_properties(Cone{1, 3}), 1e-14);
  EXPECT_THROW(mass_properties(HalfSpace{}), Error);
}

TEST(MassProperties, TwoSpheresOverlapInALens) {
  const double r = 1, d = 1.2;
  const MassProperties m = union_mass_properties(std::vector{at(Sphere{r}, {1, 1, 1}), at(Sphere{r}, {1, 1 + d, 1})});
  EXPECT_NEAR(m.volume, 8 * pi / 3 * r * r * r - pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12, 1e-14);
  EXPECT_LT((m.centre - Vec3(1, 1 + d / 2, 1)).norm(), 1e-14);
  // Two half-spheres-and-more: J_axis = pi/2 int (1 - x^2)^2 dx from -d/2 to 1, twice.
  const auto antiderivative = [](double x) { return x - 2 * x * x * x / 3 + x * x * x * x * x / 5; };
  EXPECT_NEAR(m.inertia(1, 1), pi * (antiderivative(1) - antiderivative(-d / 2)), 1e-14);
  EXPECT_NEAR(m.inertia(0, 0), m.inertia(2, 2), 1e-14);
}

TEST(MassProperties, PartsInsideOthersCountNothing) {
  const MassProperties outer = mass_properties(Cylinder{1, 1});
  expect_same(union_mass_properties(std::vector{at(Cylinder{1, 1}, {0, 0, 0}), at(Sphere{0.5}, {0, 0, 0.3}),
                                                at(Cylinder{1, 1}, {0, 0, 0}), at(Cone{0.4, 0.5}, {0, 0, -0.5})}),
              outer, 1e-14);
  expect_same(union_mass_properties(std::vector{at(Box{{1, 2, 3}}, {0, 0, 0}), at(Box{{0.5, 1, 1}}, {0.2, 0.3, 0.1})}),
              mass_properties(Box{{1, 2, 3}}), 1e-4);
}

TEST(MassProperties, DisjointPartsAddUpExactly) {
  // Two halves of a box, side by side, one turned half round about x; and a ball far away on either side.
  const Quat half_turn(0, 1, 0, 0);
  expect_same(union_mass_properties(
                  std::vector{at(Box{{1, 2, 1.5}}, {0, 0, 1.5}), at(Box{{1, 2, 1.5}}, {0, 0, -1.5}, half_turn)}),
              mass_properties(Box{{1, 2, 3}}), 1e-14);
  const MassProperties dumbbell =
      union_mass_properties(std::vector{at(Box{{1, 1, 1}}, {0, 5, 0}), at(Sphere{1}, {0, -5, 0})});
  const double ball = 4 * pi / 3, y = (8 * 5 - ball * 5) / (8 + ball);
  EXPECT_NEAR(dumbbell.centre.y(), y, 1e-14);
  EXPECT_NEAR(dumbbell.inertia(0, 0), 8 * 2.0 / 3 + 0.4 * ball + 8 * (5 - y) * (5 - y) + ball * (5 + y) * (5 + y),
              1e-12);
}

TEST(MassProperties, CoaxialUnionIsExactInAnyFrame) {
  const std::vector<Part> parts{at(RoundCone{1, 0.4, 1.5}, {0, 0, 0}), at(Ellipsoid{{0.5, 1.3, 1.3}}, {0.4, 0, 0}),
                                at(Sphere{0.6}, {1.9, 0, 0}),
                                at(Cone{0.9, 1.5}, {-0.5, 0, 0}, Quat(std::sqrt(0.5), 0, -std::sqrt(0.5), 0)),
                                at(Cylinder{0.3, 2}, {0.3, 0, 0}, Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0))};
  ASSERT_TRUE(coaxial_union(parts));
  const MassProperties exact = union_mass_properties(parts);
  expect_same(exact, ray_union(parts), 1e-4);
  const auto inside = [&](const Vec3& p) {
    return std::any_of(parts.begin(), parts.end(),
                       [&](const Part& q) { return contains(q.primitive, q.pose.to_local(p)); });
  };
  expect_same(exact, test::lattice_mass(inside, {0.3, 0, 0}, {2.5, 1.4, 1.4}, 250'000), 1e-3);

  const Pose elsewhere{{20, -10, 30}, Quat(0.3, -0.5, 0.7, 0.2).normalized()};
  std::vector<Part> moved = parts;
  for (Part& part : moved) part.pose = elsewhere.compose(part.pose);
  const Mat3 turn = elsewhere.orientation.toRotationMatrix();
  expect_same(union_mass_properties(moved),
              {exact.volume, elsewhere.to_world(exact.centre), turn * exact.inertia * turn.transpose()}, 1e-12);
}

TEST(MassProperties, RaysAreGoodToOneInTenThousand) {
  // A cross of two boxes, of which the overlap is a box: exact by inclusion and exclusion.
  const std::vector<Part> cross{at(Box{{1, 0.2, 0.3}}, {0, 0, 0}), at(Box{{0.25, 1, 0.3}}, {0, 0, 0})};
  MassProperties expected;
  for (const auto& [half, sign] :
       {std::pair{Vec3(1, 0.2, 0.3), 1}, {Vec3(0.25, 1, 0.3), 1}, {Vec3(0.25, 0.2, 0.3), -1}}) {
    const MassProperties m = mass_properties(Box{half});
    expected.volume += sign * m.volume;
    expected.inertia += sign * m.inertia;
  }
  EXPECT_FALSE(coaxial_union(cross));
  expect_same(union_mass_properties(cross), expected, 1e-4);
  const std::vector<Part> meshes{at(box_mesh({-1, -0.2, -0.3}, {1, 0.2, 0.3}), {0, 0, 0}),
                                 at(box_mesh({-0.25, -1, -0.3}, {0.25, 1, 0.3}), {0, 0, 0})};
  expect_same(union_mass_properties(meshes), expected, 1e-4);
  for (const Primitive& p : {Primitive(Cylinder{0.6, 0.5}), Primitive(Cone{0.5, 1.1}),
                             Primitive(RoundCone{0.3, 0.6, 0.8}), Primitive(Ellipsoid{{0.5, 0.9, 0.4}})}) {
    SCOPED_TRACE(p.index());
    expect_same(ray_union(std::vector{at(p, {0, 0, 0})}), mass_properties(p), 1e-4);
  }
}

TEST(MassProperties, PowersOfTwoScaleBitForBit) {
  const std::vector<Part> parts{at(RoundCone{1, 0.4, 1.5}, {0, 0, 0}), at(Sphere{0.6}, {1.9, 0, 0})};
  std::vector<Part> small;
  for (const Part& part : parts) small.push_back(scaled(part, 0x1p-14));
  const MassProperties big = union_mass_properties(parts), tiny = union_mass_properties(small);
  EXPECT_EQ(tiny.volume, big.volume * 0x1p-42);
  EXPECT_EQ(tiny.centre, Vec3(big.centre * 0x1p-14));
  EXPECT_EQ(tiny.inertia, Mat3(big.inertia * 0x1p-70));
}

TEST(PrincipalAxes, AreFoundInAnyFrame) {
  Random random(1, 0);
  for (int i = 0; i < 100; ++i) {
    const Mat3 turn = random.rotation().toRotationMatrix();
    const Vec3 moments(1, 1.5, 2.2);
    const Principal p = principal_axes(turn * moments.asDiagonal() * turn.transpose());
    EXPECT_LT((p.moments - moments).norm(), 1e-13);
    const Mat3 axes = p.orientation.toRotationMatrix();
    EXPECT_LT((axes * moments.asDiagonal() * axes.transpose() - turn * moments.asDiagonal() * turn.transpose()).norm(),
              1e-13);
  }
}

TEST(PrincipalAxes, EqualMomentsKeepTheGivenAxes) {
  EXPECT_EQ(principal_axes(Mat3::Identity()).orientation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(principal_axes(Vec3(1, 2, 2).asDiagonal()).orientation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(principal_axes(Vec3(1, 1, 2).asDiagonal()).orientation.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(principal_axes(Vec3(1, 2, 3).asDiagonal()).orientation.coeffs(), Quat::Identity().coeffs());
  // The single axis is y: it comes first, and z and x follow.
  const Mat3 axes = principal_axes(Vec3(2, 1, 2).asDiagonal()).orientation.toRotationMatrix();
  EXPECT_LT((axes.col(0) - Vec3::UnitY()).norm() + (axes.col(1) - Vec3::UnitZ()).norm(), 1e-15);
}

}  // namespace
}  // namespace repose
