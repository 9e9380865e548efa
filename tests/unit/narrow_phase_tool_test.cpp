/// Solids of revolution: which surfaces a grain touches, how often, and where.
#include "tests/unit/narrow_phase_samples.hpp"

namespace repose::dvi {
namespace {

PlacedPrimitive at(const Primitive& p, const Vec3& position, const Mat3& rotation = Mat3::Identity(),
                   double scale = 1) {
  return {&p, scale, position, rotation};
}

Mat3 x_to(const Vec3& axis) { return Quat::FromTwoVectors(Vec3::UnitX(), axis).toRotationMatrix(); }

TEST(NarrowPhaseTool, BallOnThePlate) {
  const Primitive dish = Samples::dish(), ball = Sphere{0.5};
  for (const double r : {0.0, 1e-9, 2.0, 4.0}) {
    const auto found = contacts(at(ball, Vec3(0, r, 0.6)), at(dish, Vec3::Zero()), 0.2);
    ASSERT_EQ(found.size(), 1u) << r;
    EXPECT_NEAR(found[0].gap, 0.1, 1e-15);
    EXPECT_EQ(found[0].normal, Vec3(-Vec3::UnitZ()));
    EXPECT_LT((found[0].point - Vec3(0, r, 0.05)).norm(), 1e-15);
  }
}

TEST(NarrowPhaseTool, BallInTheCornerTouchesPlateAndRim) {
  const Primitive dish = Samples::dish(), ball = Sphere{0.5};
  const Vec3 radial = Vec3(3, 4, 0) / 5;
  const auto found = contacts(at(ball, 4.45 * radial + 0.52 * Vec3::UnitZ()), at(dish, Vec3::Zero()), 0.1);
  ASSERT_EQ(found.size(), 2u);
  std::vector<double> gaps{found[0].gap, found[1].gap};
  std::sort(gaps.begin(), gaps.end());
  EXPECT_NEAR(gaps[0], 0.02, 1e-14);
  EXPECT_NEAR(gaps[1], 0.05, 1e-14);
  for (const ContactPoint& c : found) {
    const Vec3 expected = c.gap < 0.03 ? Vec3(-Vec3::UnitZ()) : radial;
    EXPECT_LT((c.normal - expected).norm(), 1e-14);
  }
  EXPECT_NE(found[0].feature, found[1].feature);
}

TEST(NarrowPhaseTool, BallOnTheEdgeOfTheRim) {
  const Primitive dish = Samples::dish(), ball = Sphere{0.5};
  // The inner edge of the rim is the circle r = 5, z = 1.5; the ball hangs over it at 45 degrees.
  const Vec3 out = Vec3(-1, 0, 1).normalized();
  const auto found = contacts(at(ball, Vec3(5, 0, 1.5) + 0.55 * out), at(dish, Vec3::Zero()), 0.1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, 0.05, 1e-14);
  EXPECT_LT((found[0].normal + out).norm(), 1e-14);
}

TEST(NarrowPhaseTool, CentreInsideAThinWallLeavesByTheNearerSide) {
  const Primitive dish = Samples::dish(), ball = Sphere{0.5};
  const auto inner = contacts(at(ball, Vec3(5.3, 0, 0.8)), at(dish, Vec3::Zero()), 0);
  ASSERT_EQ(inner.size(), 1u);
  EXPECT_NEAR(inner[0].gap, -0.8, 1e-14);
  EXPECT_LT((inner[0].normal - Vec3::UnitX()).norm(), 1e-14);
  const auto outer = contacts(at(ball, Vec3(5.8, 0, 0.8)), at(dish, Vec3::Zero()), 0);
  ASSERT_EQ(outer.size(), 1u);
  EXPECT_NEAR(outer[0].gap, -0.7, 1e-14);
  EXPECT_LT((outer[0].normal + Vec3::UnitX()).norm(), 1e-14);
}

TEST(NarrowPhaseTool, BallInAFunnelOfKnownAngle) {
  // The inner wall runs from (1.5, 0) to (6.5, 6).
  const Primitive funnel = Samples::funnel(), ball = Sphere{0.5};
  const Vec2 wall = Vec2(5, 6).normalized(), n(-wall.y(), wall.x());
  const Vec2 foot = Vec2(1.5, 0) + 3 * wall, centre = foot + 0.6 * n;
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 radial(std::cos(2), std::sin(2), 0), shift(4, 5, 6);
  const Vec3 local = centre.x() * radial + centre.y() * Vec3::UnitZ();
  const auto found = contacts(at(ball, shift + turn * local), at(funnel, shift, turn), 0.2);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, 0.1, 1e-13);
  EXPECT_LT((found[0].normal + turn * (n.x() * radial + n.y() * Vec3::UnitZ())).norm(), 1e-13);
}

TEST(NarrowPhaseTool, BallThatPlugsAFunnelIsHeldAllRound) {
  const Primitive funnel = Samples::funnel(), ball = Sphere{2};
  const auto found = contacts(at(ball, Vec3(0, 0, 2.0)), at(funnel, Vec3::Zero()), 0.5);
  ASSERT_EQ(found.size(), 3u);
  Vec3 sum = Vec3::Zero();
  for (const ContactPoint& c : found) {
    EXPECT_NEAR(c.gap, found[0].gap, 1e-14);
    sum += c.normal;
  }
  EXPECT_NEAR(Vec2(sum.x(), sum.y()).norm(), 0, 1e-14);
}

TEST(NarrowPhaseTool, EllipsoidOnRollerHasTheClosedFormOfItsAxes) {
  // A roller about y with an ellipsoid on top, its axes along those of the world.
  const Primitive roller = Revolved{{Vec2(0, -10), Vec2(5, -10), Vec2(5, 10), Vec2(0, 10)}};
  const Mat3 lying = Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitX()).toRotationMatrix();
  const Primitive grain = Ellipsoid{Vec3(0.5, 0.4, 0.3)};
  const auto found = contacts(at(grain, Vec3(0, 0, 5.35)), at(roller, Vec3::Zero(), lying), 0.1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, 0.05, 1e-12);
  EXPECT_LT((found[0].normal + Vec3::UnitZ()).norm(), 1e-7);
}

TEST(NarrowPhaseTool, EllipsoidsBuiltOnConeAndCylinderWalls) {
  Samples samples(3);
  const Primitive funnel = Samples::funnel();
  const Vec2 wall = Vec2(5, 6).normalized(), n2(-wall.y(), wall.x());
  for (int k = 0; k < 300; ++k) {
    const Primitive grain = samples.make("ellipsoid", 0.03);
    const Vec3 e = std::get<Ellipsoid>(grain).semi_axes;
    const Mat3 r = samples.rotation();
    const double angle = samples.between(0, 6.28), gap = samples.between(-0.1, 1) * e.minCoeff();
    const Vec3 radial(std::cos(angle), std::sin(angle), 0);
    const Vec3 n = n2.x() * radial + n2.y() * Vec3::UnitZ();  // out of the wall
    const Vec2 foot = Vec2(1.5, 0) + samples.between(2, 6) * wall;
    const Vec3 m = r.transpose() * n;
    const Vec3 lowest = -(r * e.cwiseProduct(e.cwiseProduct(m))) / e.cwiseProduct(m).norm();
    const Vec3 surface = foot.x() * radial + foot.y() * Vec3::UnitZ();
    const auto found = contacts(at(grain, surface + gap * n - lowest, r), at(funnel, Vec3::Zero()), 1.1 * e.minCoeff());
    ASSERT_EQ(found.size(), 1u) << "at " << k;
    EXPECT_NEAR(found[0].gap, gap, 1e-6 * 0.03) << "at " << k;
    EXPECT_LT((found[0].normal + n).norm(), 1e-6) << "at " << k;
  }
}

TEST(NarrowPhaseTool, RoundConeLiesOnThePlateWithBothEnds) {
  const Primitive dish = Samples::dish(), rod = RoundCone{0.3, 0.3, 2};
  const auto found = contacts(at(rod, Vec3(1, 1, 0.35)), at(dish, Vec3::Zero()), 0.1);
  ASSERT_EQ(found.size(), 2u);
  for (const ContactPoint& c : found) EXPECT_NEAR(c.gap, 0.05, 1e-14);
}

TEST(NarrowPhaseTool, RoundConeAcrossARollerTouchesInTheMiddle) {
  const Primitive roller = Revolved{{Vec2(0, -10), Vec2(5, -10), Vec2(5, 10), Vec2(0, 10)}};
  const Primitive rod = RoundCone{0.3, 0.3, 4};
  const auto found = contacts(at(rod, Vec3(5.4, -1.5, 0), x_to(Vec3::UnitY())), at(roller, Vec3::Zero()), 0.15);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, 0.1, 1e-12);
  EXPECT_LT((found[0].point - Vec3(5.05, 0, 0)).norm(), 1e-9);
}

TEST(NarrowPhaseTool, RoundConeAcrossTheEdgeOfTheRim) {
  const Primitive dish = Samples::dish(), rod = RoundCone{0.3, 0.3, 3};
  // A rod that leans over the inner edge of the rim, square to the bisector of the edge.
  const Vec3 out = Vec3(-1, 0, 1).normalized(), along = Vec3(1, 0, 1).normalized();
  const auto found =
      contacts(at(rod, Vec3(5, 0, 1.5) + 0.4 * out - 1.2 * along, x_to(along)), at(dish, Vec3::Zero()), 0.15);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].gap, 0.1, 1e-12);
  EXPECT_LT((found[0].normal + out).norm(), 1e-9);
}

TEST(NarrowPhaseTool, BoxAndCylinderStandOnThePlate) {
  const Primitive dish = Samples::dish(), box = Box{Vec3(0.5, 0.4, 0.3)}, can = Cylinder{0.4, 0.5};
  const auto corners = contacts(at(box, Vec3(1, 2, 0.35)), at(dish, Vec3::Zero()), 0.1);
  EXPECT_EQ(corners.size(), 4u);
  for (const ContactPoint& c : corners) EXPECT_NEAR(c.gap, 0.05, 1e-14);
  const auto rim = contacts(at(can, Vec3(1, 2, 0.55)), at(dish, Vec3::Zero()), 0.1);
  EXPECT_EQ(rim.size(), 4u);
  for (const ContactPoint& c : rim) EXPECT_NEAR(c.gap, 0.05, 1e-14);
}

TEST(NarrowPhaseTool, FeaturesOfABallAreThoseOfTheSurfaceItTouches) {
  const Primitive dish = Samples::dish(), ball = Sphere{0.5};
  std::uint32_t feature = 0;
  for (int k = 0; k < 30; ++k) {
    const double angle = 0.2 * k;
    const auto found =
        contacts(at(ball, Vec3(2 * std::cos(angle), 3 * std::sin(angle), 0.5)), at(dish, Vec3::Zero()), 0.1);
    ASSERT_EQ(found.size(), 1u);
    if (k > 0) {
      EXPECT_EQ(found[0].feature, feature);
    }
    feature = found[0].feature;
  }
}

}  // namespace
}  // namespace repose::dvi
