/// Spheres, ellipsoids and round cones against each other and on planes: closed forms.
#include "tests/unit/narrow_phase_samples.hpp"

namespace repose::dvi {
namespace {

PlacedPrimitive at(const Primitive& p, const Vec3& position, const Mat3& rotation = Mat3::Identity(),
                   double scale = 1) {
  return {&p, scale, position, rotation};
}

/// Turns the x axis into `axis`.
Mat3 x_to(const Vec3& axis) { return Quat::FromTwoVectors(Vec3::UnitX(), axis).toRotationMatrix(); }

void expect_one(const std::vector<ContactPoint>& found, double gap, const Vec3& normal, const Vec3& point,
                double tolerance) {
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, gap, tolerance);
  EXPECT_LT((found[0].normal - normal).norm(), tolerance);
  EXPECT_LT((found[0].point - point).norm(), tolerance);
}

TEST(NarrowPhaseRound, TwoSpheres) {
  const Primitive big = Sphere{2}, small = Sphere{0.5};
  expect_one(contacts(at(big, Vec3(1, 0, 0)), at(small, Vec3(1, 0, 3)), 1), 0.5, Vec3::UnitZ(), Vec3(1, 0, 2.25),
             1e-15);
  expect_one(contacts(at(big, Vec3::Zero(), Mat3::Identity(), 0.5), at(small, Vec3(0, 1.25, 0)), 0), -0.25,
             Vec3::UnitY(), Vec3(0, 0.875, 0), 1e-15);
  EXPECT_TRUE(contacts(at(big, Vec3::Zero()), at(small, Vec3(0, 0, 3)), 0.49).empty());
}

TEST(NarrowPhaseRound, EllipsoidsAlongTheirAxes) {
  const Primitive e = Ellipsoid{Vec3(3, 2, 1)};
  for (int axis = 0; axis < 3; ++axis)
    for (const double gap : {-0.2, 0.0, 0.5}) {
      const double half = std::get<Ellipsoid>(e).semi_axes[axis];
      const Vec3 n = Vec3::Unit(axis);
      expect_one(contacts(at(e, Vec3::Zero()), at(e, (2 * half + gap) * n), 1), gap, n, (half + 0.5 * gap) * n, 1e-12);
    }
}

/// Two ellipsoids that touch by construction: each holds the same point with opposite normals, then they are drawn
/// apart.
TEST(NarrowPhaseRound, EllipsoidsBuiltFromACommonNormal) {
  Samples samples(5);
  for (int k = 0; k < 2000; ++k) {
    const Primitive first = samples.make("ellipsoid"),
                    second = samples.make("ellipsoid", std::pow(10, samples.between(-1, 0)));
    const Vec3 &ea = std::get<Ellipsoid>(first).semi_axes, &eb = std::get<Ellipsoid>(second).semi_axes;
    const Mat3 ra = samples.rotation(), rb = samples.rotation();
    const Vec3 n = samples.direction();
    const auto support = [](const Vec3& e, const Mat3& r, const Vec3& d) {
      const Vec3 m = r.transpose() * d;
      return Vec3(r * e.cwiseProduct(e.cwiseProduct(m)) / e.cwiseProduct(m).norm());
    };
    const double size = std::cbrt(eb.prod());
    const double gap = samples.between(0, 2) * size;
    const Vec3 on_a = support(ea, ra, n), on_b = support(eb, rb, -n);
    const auto found = contacts(at(first, Vec3::Zero(), ra), at(second, on_a + gap * n - on_b, rb), 2.1 * size);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].gap, gap, 1e-11) << "at " << k;
    EXPECT_LT((found[0].normal - n).norm(), 1e-5) << "at " << k;  // 0.05 degrees are 9e-4
    EXPECT_LT((found[0].point - (on_a + 0.5 * gap * n)).norm(), 1e-4) << "at " << k;
  }
}

TEST(NarrowPhaseRound, ShallowEllipsoidOverlapKeepsTheCommonNormal) {
  Samples samples(6);
  for (int k = 0; k < 500; ++k) {
    const Primitive first = Ellipsoid{Vec3(1.5, 1, 1)}, second = Ellipsoid{Vec3(0.8, 1, 1.3)};
    const Mat3 ra = samples.rotation(), rb = samples.rotation();
    const Vec3 n = samples.direction();
    const auto support = [](const Vec3& e, const Mat3& r, const Vec3& d) {
      const Vec3 m = r.transpose() * d;
      return Vec3(r * e.cwiseProduct(e.cwiseProduct(m)) / e.cwiseProduct(m).norm());
    };
    const double gap = samples.between(-0.2, 0);
    const Vec3 on_a = support(Vec3(1.5, 1, 1), ra, n), on_b = support(Vec3(0.8, 1, 1.3), rb, -n);
    const auto found = contacts(at(first, Vec3::Zero(), ra), at(second, on_a + gap * n - on_b, rb), 0);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].gap, gap, 1e-12) << "at " << k;
    EXPECT_LT((found[0].normal - n).norm(), 1e-6) << "at " << k;
  }
}

TEST(NarrowPhaseRound, PointOnEllipsoidAxesAndInside) {
  const Primitive e = Ellipsoid{Vec3(3, 2, 1)}, dot = Sphere{0.25};
  expect_one(contacts(at(dot, Vec3(4, 0, 0)), at(e, Vec3::Zero()), 1), 0.75, -Vec3::UnitX(), Vec3(3.375, 0, 0), 1e-12);
  // From within: the nearest wall is that of the shortest axis.
  const auto inside = contacts(at(dot, Vec3::Zero()), at(e, Vec3::Zero()), 1);
  ASSERT_EQ(inside.size(), 1u);
  EXPECT_NEAR(inside[0].gap, -1.25, 1e-12);
  EXPECT_NEAR(std::abs(inside[0].normal.z()), 1, 1e-12);
}

TEST(NarrowPhaseRound, SphereOnTheSideAndTheApexOfACone) {
  // Ball of radius 1 at the origin, apex at x = 2: the half angle is 30 degrees.
  const Primitive cone = RoundCone{1, 0, 2}, ball = Sphere{0.5};
  const Vec3 side(0.5, std::sqrt(0.75), 0);  // normal of the side
  const Vec3 foot = side + 0.7 * Vec3(std::sqrt(0.75), -0.5, 0);
  expect_one(contacts(at(ball, foot + 0.6 * side), at(cone, Vec3::Zero()), 1), 0.1, -side, foot + 0.05 * side, 1e-12);
  expect_one(contacts(at(ball, Vec3(3, 0, 0)), at(cone, Vec3::Zero()), 1), 0.5, -Vec3::UnitX(), Vec3(2.25, 0, 0),
             1e-12);
  expect_one(contacts(at(ball, Vec3(-1.75, 0, 0)), at(cone, Vec3::Zero()), 1), 0.25, Vec3::UnitX(), Vec3(-1.125, 0, 0),
             1e-12);
}

TEST(NarrowPhaseRound, CrossedRoundConesTouchOnce) {
  const Primitive rod = RoundCone{0.3, 0.3, 4};
  const auto found = contacts(at(rod, Vec3(-2, 0, 0)), at(rod, Vec3(0, -2, 1), x_to(Vec3::UnitY())), 0.5);
  expect_one(found, 0.4, Vec3::UnitZ(), Vec3(0, 0, 0.5), 1e-12);
}

TEST(NarrowPhaseRound, ParallelRoundConesTouchTwice) {
  const Primitive rod = RoundCone{0.3, 0.3, 4};
  const auto found = contacts(at(rod, Vec3::Zero()), at(rod, Vec3(1, 0, 0.7)), 0.5);
  ASSERT_EQ(found.size(), 2u);
  for (const ContactPoint& c : found) {
    EXPECT_NEAR(c.gap, 0.1, 1e-12);
    EXPECT_LT((c.normal - Vec3::UnitZ()).norm(), 1e-12);
  }
  EXPECT_NEAR(std::abs(found[0].point.x() - found[1].point.x()), 3, 1e-12);
}

TEST(NarrowPhaseRound, SideOfAConeOnAPlaneTouchesTwice) {
  const Primitive cone = RoundCone{1, 0, 2}, floor = HalfSpace{Vec3::UnitZ()};
  // Tilted by the half angle the side lies flat: ball and apex touch, at a distance of sqrt(3).
  const Mat3 tilt = Eigen::AngleAxisd(std::asin(0.5), Vec3::UnitY()).toRotationMatrix();
  const auto found = contacts(at(cone, Vec3(0, 0, 1), tilt), at(floor, Vec3::Zero()), 1e-6);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[0].feature, found[1].feature);
  for (const ContactPoint& c : found) {
    EXPECT_NEAR(c.gap, 0, 1e-12);
    EXPECT_EQ(c.normal, Vec3(-Vec3::UnitZ()));
  }
  EXPECT_NEAR((found[0].point - found[1].point).norm(), std::sqrt(3), 1e-12);
}

TEST(NarrowPhaseRound, EllipsoidOnATiltedPlane) {
  Samples samples(9);
  for (int k = 0; k < 200; ++k) {
    const Primitive e = samples.make("ellipsoid"), plane = HalfSpace{samples.direction()};
    const Vec3 n = std::get<HalfSpace>(plane).normal;
    const Mat3 r = samples.rotation();
    const double h = std::get<Ellipsoid>(e).semi_axes.cwiseProduct(r.transpose() * n).norm();
    const auto found = contacts(at(e, (h + 0.1) * n + 3 * n.unitOrthogonal(), r), at(plane, Vec3::Zero()), 0.2);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].gap, 0.1, 1e-12);
    EXPECT_NEAR(n.dot(found[0].point), 0.05, 1e-12);
  }
}

TEST(NarrowPhaseRound, SmallMotionsKeepTheFeatures) {
  Samples samples(10);
  for (const char* kind : {"sphere", "ellipsoid", "round_cone"}) {
    Primitive shape = samples.make(kind), floor = HalfSpace{Vec3::UnitZ()};
    if (kind == std::string("round_cone")) shape = RoundCone{0.5, 0.5, 2};
    std::vector<std::uint32_t> features;
    for (int k = 0; k < 20; ++k) {
      const Mat3 wobble = Eigen::AngleAxisd(1e-4 * k, samples.direction()).toRotationMatrix();
      const auto found = contacts(at(shape, Vec3(0.01 * k, 0, 0.5), wobble), at(floor, Vec3::Zero()), 0.3);
      std::vector<std::uint32_t> now;
      for (const ContactPoint& c : found) now.push_back(c.feature);
      if (k > 0) {
        EXPECT_EQ(now, features) << kind;
      }
      features = now;
    }
  }
}

}  // namespace
}  // namespace repose::dvi
