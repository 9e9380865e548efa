#include "core/shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "core/random.hpp"

namespace repose {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TriMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

Revolved ring() { return {{{1, 0}, {2, 0}, {2, 1}, {1, 1}}}; }

std::vector<Primitive> all_bounded() {
  return {Sphere{0.7},    Ellipsoid{{0.5, 0.9, 0.4}}, RoundCone{0.6, 0.3, 0.8}, RoundCone{0.5, 0, 1.2},
          Cone{0.5, 1.1}, Box{{0.3, 0.4, 0.8}},       Cylinder{0.6, 0.5},       ring(),
          tetrahedron()};
}

TEST(Shape, KnownPointsInsideAndOutside) {
  const double d = 1e-9;
  EXPECT_TRUE(contains(Sphere{1}, {0, 0, 1 - d}));
  EXPECT_FALSE(contains(Sphere{1}, {0, 0, 1 + d}));
  EXPECT_TRUE(contains(Ellipsoid{{1, 2, 3}}, {0, 0, 3 - d}));
  EXPECT_FALSE(contains(Ellipsoid{{1, 2, 3}}, {0, 2 + d, 0}));
  EXPECT_TRUE(contains(Cone{1, 2}, {0.5 - d, 0, 1}));
  EXPECT_FALSE(contains(Cone{1, 2}, {0.5 + d, 0, 1}));
  EXPECT_FALSE(contains(Cone{1, 2}, {0, 0, -d}));
  EXPECT_TRUE(contains(Box{{1, 2, 3}}, {1, 2, 3}));
  EXPECT_FALSE(contains(Box{{1, 2, 3}}, {1, 2 + d, 3}));
  EXPECT_TRUE(contains(Cylinder{1, 2}, {0, 1 - d, -2}));
  EXPECT_FALSE(contains(Cylinder{1, 2}, {0, 0, 2 + d}));
  EXPECT_TRUE(contains(HalfSpace{}, {5, 5, -d}));
  EXPECT_FALSE(contains(HalfSpace{}, {5, 5, d}));
  EXPECT_TRUE(contains(ring(), {0, -1.5, 0.5}));
  EXPECT_FALSE(contains(ring(), {0.9, 0, 0.5}));
  EXPECT_TRUE(contains(tetrahedron(), {0.2, 0.2, 0.2}));
  EXPECT_FALSE(contains(tetrahedron(), {0.4, 0.4, 0.4}));
}

TEST(Shape, RoundConeIsTheHullOfItsSpheres) {
  // The hull is the union of all spheres between the two: a point is inside if it is inside one of them.
  for (const RoundCone& cone : {RoundCone{0.6, 0.3, 0.8}, RoundCone{0.3, 0.6, 0.8}, RoundCone{0.5, 0, 1.2}}) {
    Random random(1, 0);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p(random.uniform(-0.7, 1.5), random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7));
      double depth = -infinity;
      for (int k = 0; k <= 1000; ++k) {
        const double t = k / 1000.0;
        depth = std::max(depth, (1 - t) * cone.radius_a + t * cone.radius_b - (p - Vec3(t * cone.length, 0, 0)).norm());
      }
      if (std::abs(depth) > 1e-5) {
        EXPECT_EQ(contains(cone, p), depth > 0) << p.transpose();
      }
    }
  }
}

TEST(Shape, BoundingRadiusHoldsThePrimitiveAndIsTight) {
  for (const Primitive& primitive : all_bounded()) {
    const double radius = bounding_radius(primitive);
    Random random(2, 0);
    double farthest = 0;
    for (int i = 0; i < 200'000; ++i) {
      const Vec3 p = 1.2 * radius * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (contains(primitive, p)) farthest = std::max(farthest, p.norm());
    }
    EXPECT_LE(farthest, radius) << primitive.index();
    EXPECT_GE(farthest, 0.8 * radius) << primitive.index();
  }
  EXPECT_EQ(bounding_radius(HalfSpace{}), infinity);
}

TEST(Shape, ScalingMovesEveryPointWithIt) {
  const Part part{RoundCone{0.6, 0.3, 0.8}, {{0.1, 0.2, -0.3}, Quat(0.5, 0.5, 0.5, -0.5)}};
  for (const Primitive& primitive : all_bounded()) {
    const Primitive twice = scaled(primitive, 2);
    EXPECT_EQ(bounding_radius(twice), 2 * bounding_radius(primitive)) << primitive.index();
    EXPECT_EQ(smallest_extent(twice), 2 * smallest_extent(primitive)) << primitive.index();
    Random random(3, 0);
    for (int i = 0; i < 200; ++i) {
      const Vec3 p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      EXPECT_EQ(contains(primitive, p), contains(twice, 2 * p));
      EXPECT_EQ(contains(part.primitive, part.pose.to_local(p)),
                contains(scaled(part, 2).primitive, scaled(part, 2).pose.to_local(2 * p)));
    }
  }
}

TEST(Shape, SmallestExtentIsTheThinnestDimension) {
  EXPECT_EQ(smallest_extent(Ellipsoid{{3, 0.5, 1}}), 1);
  EXPECT_EQ(smallest_extent(RoundCone{1, 0, 2}), 2);
  EXPECT_EQ(smallest_extent(Cone{1, 0.5}), 0.5);
  EXPECT_EQ(smallest_extent(Box{{3, 0.5, 1}}), 1);
  EXPECT_EQ(smallest_extent(Cylinder{3, 0.5}), 1);
  EXPECT_EQ(smallest_extent(ring()), 1);
  EXPECT_EQ(smallest_extent(HalfSpace{}), infinity);
}

TEST(Shape, BodyFrameIsPrincipalAndRemembersTheOwnFrame) {
  const Pose tilted{{3, -2, 1}, Quat(0.8, 0.2, -0.4, 0.4).normalized()};
  const Shape shape = make_shape("brick", {Part{Box{{0.1, 0.2, 0.3}}, tilted}});
  EXPECT_EQ(shape.mass.centre, Vec3(0, 0, 0));
  EXPECT_EQ(shape.mass.inertia, Mat3(shape.mass.inertia.diagonal().asDiagonal()));
  EXPECT_LT((shape.own_frame.to_local(Vec3::Zero()) - tilted.position).norm(), 1e-14);
  EXPECT_NEAR(shape.bounding_radius, std::sqrt(0.14), 1e-14);
  Random random(4, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 own = tilted.position + 0.4 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    EXPECT_EQ(contains(Box{{0.1, 0.2, 0.3}}, tilted.to_local(own)), contains(shape, shape.own_frame.to_world(own)));
  }
}

TEST(Shape, UnboundedAndRevolvedKeepTheirFrame) {
  const Pose pose{{1, 2, 3}, Quat::Identity()};
  const Shape floor = make_shape("floor", {Part{HalfSpace{}, pose}}), cup = make_shape("cup", {Part{ring(), pose}});
  EXPECT_FALSE(floor.bounded());
  EXPECT_TRUE(cup.bounded());
  for (const Shape& shape : {floor, cup}) {
    EXPECT_EQ(shape.mass.volume, 0);
    EXPECT_EQ(shape.parts[0].pose.position, pose.position);
    EXPECT_EQ(shape.own_frame.position, Vec3(0, 0, 0));
  }
}

struct Bad {
  const char* what;
  std::vector<Part> parts;
  const char* message;  // part of it
};

TEST(Shape, RefusesWhatIsImpossible) {
  TriMesh open = tetrahedron(), inside_out = tetrahedron(), missing = tetrahedron(), twice = tetrahedron();
  open.triangles.pop_back();
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  missing.triangles[2][1] = 4;
  twice.triangles.push_back(twice.triangles[0]);
  const std::vector<Bad> cases{
      {"nothing", {}, "no parts"},
      {"negative radius", {{Sphere{-1}, {}}}, "radius is -1"},
      {"no radius", {{Sphere{0}, {}}}, "radius is 0"},
      {"nan", {{Sphere{nan}, {}}}, "radius is nan"},
      {"infinite", {{Cylinder{1, infinity}, {}}}, "half height is inf"},
      {"flat ellipsoid", {{Ellipsoid{{1, 0, 1}}, {}}}, "semi-axis is 0"},
      {"flat box", {{Box{{1, 1, -2}}, {}}}, "half extent is -2"},
      {"flat cone", {{Cone{1, 0}, {}}}, "height is 0"},
      {"swallowed sphere", {{RoundCone{1, 0.2, 0.8}, {}}}, "swallows"},
      {"negative end", {{RoundCone{1, -0.2, 3}, {}}}, "radius_b is -0.2"},
      {"long normal", {{HalfSpace{{0, 0, 2}}, {}}}, "normal has length 2"},
      {"two points", {{Revolved{{{0, 0}, {1, 0}}}, {}}}, "2 points"},
      {"clockwise", {{Revolved{{{1, 1}, {2, 1}, {2, 0}, {1, 0}}}, {}}}, "clockwise"},
      {"negative r", {{Revolved{{{-1, 0}, {2, 0}, {2, 1}}}, {}}}, "r = -1"},
      {"crossing", {{Revolved{{{1, 0}, {2, 0}, {2, 2}, {3, 1}, {1, 1}}}, {}}}, "cross"},
      {"double point", {{Revolved{{{1, 0}, {1, 0}, {2, 1}}}, {}}}, "coincide"},
      {"open mesh", {{open, {}}}, "open at the edge"},
      {"mesh inside out", {{inside_out, {}}}, "inside out"},
      {"vertex missing", {{missing, {}}}, "names vertex 4"},
      {"triangle twice", {{twice, {}}}, "same direction"},
      {"empty mesh", {{TriMesh{}, {}}}, "no triangles"},
      {"long quaternion", {{Sphere{1}, {Vec3::Zero(), Quat(1, 1, 0, 0)}}}, "quaternion of length"},
      {"nowhere", {{Sphere{1}, {{0, nan, 0}, Quat::Identity()}}}, "position is not finite"},
      {"second part", {{Sphere{1}, {}}, {Sphere{-1}, {}}}, "part 2"},
  };
  for (const Bad& bad : cases) {
    try {
      make_shape("thing", bad.parts);
      ADD_FAILURE() << bad.what << " was accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(bad.message), std::string::npos) << bad.what << ": " << error.what();
      EXPECT_NE(error.place().find("thing"), std::string::npos);
      EXPECT_FALSE(error.remedy().empty());
    }
  }
}

}  // namespace
}  // namespace repose
