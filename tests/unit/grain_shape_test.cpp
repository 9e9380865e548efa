#include "core/grain_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "core/error.hpp"
#include "core/mass_properties.hpp"
#include "core/random.hpp"
#include "core/union_integrals.hpp"
#include "tests/unit/lattice_mass.hpp"

namespace repose {
namespace {

Vec3 half_extents(const Shape& shape) {
  Vec3 half = Vec3::Zero();
  for (const Part& part : shape.parts)
    for (int i = 0; i < 3; ++i)
      half[i] = std::max({half[i], support(part, Vec3::Unit(i)), support(part, -Vec3::Unit(i))});
  return half;
}

// The frame is the body frame of the sphere of equal volume and diameter 1; compares with counting lattice points, 0.1
// %.
void expect_body_frame(const Shape& shape) {
  SCOPED_TRACE(shape.kind);
  const auto inside = [&](const Vec3& p) { return contains(shape, p); };
  const MassProperties counted = test::lattice_mass(inside, Vec3::Zero(), half_extents(shape), 250'000);
  const double largest = shape.mass.inertia.diagonal().maxCoeff();
  EXPECT_NEAR(shape.mass.volume, std::numbers::pi / 6, 1e-14);
  EXPECT_NEAR(counted.volume, shape.mass.volume, 1e-3 * shape.mass.volume);
  EXPECT_EQ(shape.mass.centre, Vec3(0, 0, 0));
  EXPECT_LT(counted.centre.norm(), 5e-4);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double moment = shape.mass.inertia(i, j);
      EXPECT_NEAR(counted.inertia(i, j), moment, 1e-3 * (i == j ? moment : largest)) << i << j;
    }
}

TEST(GrainShape, AllSevenAgainstCounting) {
  ASSERT_EQ(grain_shape_names().size(), 7u);
  for (const std::string& name : grain_shape_names()) {
    const Shape shape = make_grain_shape(name);
    EXPECT_EQ(shape.kind, name);
    expect_body_frame(shape);
  }
}

TEST(GrainShape, AspectsTwentyPercentUpAndDownAgainstCounting) {
  for (double factor : {0.8, 1.2})
    for (const std::string& name : grain_shape_names())
      if (name != "sphere") expect_body_frame(make_grain_shape(name, GrainProportions{}.with_aspect(factor)));
}

TEST(GrainShape, UnevenProportionsAgainstCounting) {
  GrainProportions p;
  p.ellipsoid_aspect = 0.6;
  p.side_ellipsoid = {1.1, 0.7, 0.4};  // no solid of revolution any more
  p.piercing_ellipsoid = {0.5, 1.3, 1.3};
  p.uneven_twin_radius = 0.9;
  for (const char* name : {"ellipsoid", "sphere_ellipsoid", "pierced_twin", "uneven_twin"}) {
    SCOPED_TRACE(name);
    const Shape shape = make_grain_shape(name, p);
    const auto inside = [&](const Vec3& q) { return contains(shape, q); };
    const MassProperties counted = test::lattice_mass(inside, Vec3::Zero(), half_extents(shape), 250'000);
    EXPECT_NEAR(counted.volume, std::numbers::pi / 6, 1e-3);
    EXPECT_LT(counted.centre.norm(), 5e-4);
    EXPECT_LT((counted.inertia - shape.mass.inertia).cwiseAbs().maxCoeff(), 1e-3 * shape.mass.inertia.maxCoeff());
    EXPECT_LE(shape.mass.inertia(0, 0), shape.mass.inertia(1, 1));
    EXPECT_LE(shape.mass.inertia(1, 1), shape.mass.inertia(2, 2));
  }
}

TEST(GrainShape, KnownNumbers) {
  const Shape sphere = make_grain_shape("sphere");
  EXPECT_NEAR(sphere.bounding_radius, 0.5, 1e-15);
  EXPECT_NEAR(sphere.mass.inertia(0, 0), std::numbers::pi / 60, 1e-15);

  // Volume 4/3 pi 1.5 r^3 = pi/6.
  const Shape ellipsoid = make_grain_shape("ellipsoid");
  EXPECT_NEAR(ellipsoid.bounding_radius, 1.5 * 0.5 / std::cbrt(1.5), 1e-15);

  // Sphere of radius r with its apex at 2 r: volume 9/4 pi r^3 / 1.5 = (27/24 + 3/8) pi r^3.
  const Shape cone = make_grain_shape("sphere_cone");
  const double r = std::get<RoundCone>(cone.parts.at(0).primitive).radius_a;
  EXPECT_NEAR(1.5 * std::numbers::pi * r * r * r, std::numbers::pi / 6, 1e-14);
  EXPECT_NEAR(std::get<RoundCone>(cone.parts.at(0).primitive).length, 2 * r, 1e-15);
  EXPECT_NEAR(cone.bounding_radius, 2 * r + cone.parts.at(0).pose.position.x(), 1e-15);
}

TEST(GrainShape, BoundingRadiusHoldsTheShapeTightly) {
  for (const std::string& name : grain_shape_names()) {
    const Shape shape = make_grain_shape(name);
    Random random(1, 0);
    double farthest = 0;
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 direction = random.rotation() * Vec3::UnitX();
      EXPECT_FALSE(contains(shape, (1 + 1e-9) * shape.bounding_radius * direction));
    }
    for (double x = -1; x <= 1; x += 1e-4)
      if (contains(shape, {x, 0, 0})) farthest = std::max(farthest, std::abs(x));
    EXPECT_GT(farthest, 0.999 * shape.bounding_radius) << name;
  }
}

TEST(GrainShape, AspectIsTheExcessOverTheSphere) {
  const GrainProportions p, same = p.with_aspect(1), longer = p.with_aspect(1.2);
  EXPECT_EQ(same.ellipsoid_aspect, p.ellipsoid_aspect);
  EXPECT_DOUBLE_EQ(same.uneven_twin_distance, p.uneven_twin_distance);
  EXPECT_DOUBLE_EQ(longer.ellipsoid_aspect, 1.6);
  EXPECT_DOUBLE_EQ(longer.twin_distance, 1.44);
  EXPECT_DOUBLE_EQ(longer.uneven_twin_distance + longer.uneven_twin_radius - 1, 1.2 * 0.7);
  EXPECT_DOUBLE_EQ(longer.cone_apex, 2.2);
  EXPECT_DOUBLE_EQ(longer.side_ellipsoid.x(), 1.44);
  EXPECT_DOUBLE_EQ(longer.piercing_ellipsoid.x(), 2.2);
  EXPECT_EQ(longer.side_ellipsoid.y(), p.side_ellipsoid.y());
}

TEST(GrainShape, RefusesImpossibleProportions) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<const char*, std::function<void(GrainProportions&)>>> cases{
      {"ellipsoid", [](auto& p) { p.ellipsoid_aspect = 0; }},
      {"twin", [](auto& p) { p.twin_distance = 2; }},
      {"twin", [nan](auto& p) { p.twin_distance = nan; }},
      {"uneven_twin", [](auto& p) { p.uneven_twin_distance = 1.6; }},
      {"uneven_twin", [](auto& p) { p.uneven_twin_distance = 0.4; }},
      {"uneven_twin", [](auto& p) { p.uneven_twin_radius = -0.5; }},
      {"sphere_cone", [](auto& p) { p.cone_apex = 1; }},
      {"sphere_ellipsoid", [](auto& p) { p.side_ellipsoid.y() = 0; }},
      {"pierced_twin", [nan](auto& p) { p.piercing_ellipsoid.x() = nan; }},
      {"pierced_twin", [](auto& p) { p.twin_distance = 2.5; }},
  };
  for (const auto& [name, spoil] : cases) {
    GrainProportions p;
    spoil(p);
    EXPECT_THROW(make_grain_shape(name, p), Error) << name;
  }
  EXPECT_THROW(GrainProportions{}.with_aspect(0), Error);
  EXPECT_THROW(GrainProportions{}.with_aspect(nan), Error);
  EXPECT_THROW(make_grain_shape("cube"), Error);
  EXPECT_THROW(make_grain_shape("twin", GrainProportions{}.with_aspect(1.7)), Error);
}

}  // namespace
}  // namespace repose
