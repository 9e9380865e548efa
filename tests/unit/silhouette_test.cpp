#include "analysis/silhouette.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/error.hpp"
#include "tests/unit/synthetic_heap.hpp"

namespace repose {
namespace {

struct One {
  Model model;
  Snapshot state;
  Pose pose;
  Primitive primitive;
  double scale = 0;

  bool inside(const Vec3& world) const { return contains(primitive, pose.to_local(world) / scale); }
};

One placed(const Primitive& primitive, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  One one;
  synthetic::Heap heap = synthetic::empty_heap(1);
  heap.model.shapes[0].parts = {Part{primitive, {}}};
  heap.model.shapes[0].bounding_radius = bounding_radius(primitive);
  synthetic::add_sphere(heap, Vec3(normal(random), normal(random), normal(random)), 0.7);
  heap.state.orientation[0] = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
  one.pose = {heap.state.position[0], heap.state.orientation[0]};
  one.model = heap.model;
  one.state = heap.state;
  one.primitive = primitive;
  one.scale = 0.7;
  return one;
}

// The highest inside point over (x, y) by scanning downwards, then bisection.
double scanned_top(const One& one, const Vec2& p) {
  const double reach = 3, step = 1e-3;
  for (double z = one.pose.position.z() + reach; z > one.pose.position.z() - reach; z -= step)
    if (one.inside({p.x(), p.y(), z})) {
      double low = z, high = z + step;
      for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (one.inside({p.x(), p.y(), middle}) ? low : high) = middle;
      }
      return low;
    }
  return -std::numeric_limits<double>::infinity();
}

class Outlines : public ::testing::TestWithParam<Primitive> {};

TEST_P(Outlines, TopOverPointIsThatOfTheSolid) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int covered = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const One one = placed(GetParam(), seed);
    const auto parts = grain_parts(one.model, one.state, {0});
    ASSERT_EQ(parts.size(), 1u);
    for (int i = 0; i < 60; ++i) {
      const Vec2 p = one.pose.position.head<2>() + Vec2(uniform(random), uniform(random));
      const double expected = scanned_top(one, p), top = top_over_point(parts[0], p);
      if (std::isinf(expected)) {
        // A sliver thinner than the scan step may be missed by the scan, never more.
        if (!std::isinf(top)) { EXPECT_LT(scanned_top(one, p + Vec2(1e-3, 0)) - top, 0.1); }
        continue;
      }
      ++covered;
      EXPECT_NEAR(top, expected, 1e-9);
      EXPECT_LE((Vec3(p.x(), p.y(), top) - parts[0].centre).norm(), parts[0].reach() + 1e-12);
    }
  }
  EXPECT_GT(covered, 20);
}

TEST_P(Outlines, SideViewIsTheHighestOfAllPointsBehind) {
  for (std::uint64_t seed = 11; seed <= 14; ++seed) {
    const One one = placed(GetParam(), seed);
    const auto parts = grain_parts(one.model, one.state, {0});
    const double a = 0.3 * static_cast<double>(seed);
    const Vec2 across(std::cos(a), std::sin(a)), along(-std::sin(a), std::cos(a));
    const SideView view(parts[0], across);
    EXPECT_LT(view.left(), view.right());
    for (double share : {0.02, 0.3, 0.5, 0.9}) {
      const double s = view.left() + share * (view.right() - view.left());
      double best = -1e9;
      for (double t = -2; t <= 2; t += 1e-3)
        best = std::max(best, top_over_point(parts[0], s * across + (along.dot(one.pose.position.head<2>()) + t) * along));
      EXPECT_GE(view.top(s), best - 1e-12);
      EXPECT_NEAR(view.top(s), best, 1e-4);
    }
    EXPECT_TRUE(std::isinf(view.top(view.right() + 1e-6)));
    EXPECT_TRUE(std::isinf(view.top(view.left() - 1e-6)));
  }
}

INSTANTIATE_TEST_SUITE_P(Parts, Outlines,
                         ::testing::Values(Primitive(Sphere{1}), Primitive(Ellipsoid{Vec3(1.5, 1, 1)}),
                                           Primitive(Ellipsoid{Vec3(2, 0.5, 0.3)}), Primitive(RoundCone{1, 0, 2}),
                                           Primitive(RoundCone{0.5, 0.5, 1.2}), Primitive(RoundCone{0.4, 0.9, 0.8})));

TEST(Outlines, UprightHullIsItsHighestSphere) {
  GrainPart part;
  part.is_hull = true;
  part.axis = Vec3(0, 0, 2);
  part.radius_a = 1;
  part.radius_b = 0;
  EXPECT_NEAR(top_over_point(part, Vec2(0, 0)), 2, 1e-12);
  // On the tangent cone, half angle 30 degrees: z = 2 - r / tan 30.
  EXPECT_NEAR(top_over_point(part, Vec2(0.3, 0.4)), 2 - 0.5 * std::sqrt(3.0), 1e-12);
  // On the sphere, beyond the circle of tangency (r = cos 30).
  EXPECT_NEAR(top_over_point(part, Vec2(0.95, 0)), std::sqrt(1 - 0.95 * 0.95), 1e-12);
}

TEST(Outlines, RefusesOtherParts) {
  One one = placed(Box{Vec3(1, 1, 1)}, 1);
  EXPECT_THROW(grain_parts(one.model, one.state, {0}), Error);
}

}  // namespace
}  // namespace repose
