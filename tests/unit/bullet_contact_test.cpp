/// Bullet's GJK on exact supports against the exact geometry of the DVI narrow phase.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "backends/bullet/convex_shape.hpp"
#include "core/random.hpp"

namespace repose::bullet {
namespace {

struct Named {
  const char* name;
  Primitive primitive;
};

const std::vector<Named> round_shapes{{"sphere", Sphere{1}},
                                      {"ellipsoid", Ellipsoid{{1.5, 1, 0.8}}},
                                      {"needle", Ellipsoid{{2, 0.5, 0.5}}},
                                      {"round cone", RoundCone{1, 0.6, 1.1}},
                                      {"sharp cone", RoundCone{1, 0, 2}}};
const std::vector<Named> flat_shapes{
    {"box", Box{{1, 0.7, 0.5}}}, {"cylinder", Cylinder{0.8, 0.9}}, {"cone", Cone{0.9, 1.6}}};

struct Errors {
  double gap = 0, normal = 0;
  int apart = 0, no_answer = 0;
};

/// Random poses in which the pair stands at a gap drawn from [low, high], in units of the shapes' size.
Errors compare(const Primitive& a, const Primitive& b, double low, double high, std::uint64_t seed) {
  Random random(seed, 0);
  const ConvexShapePointer shape_a = convex_shape(a, 1), shape_b = convex_shape(b, 1);
  Errors errors;
  for (int trial = 0; trial < 300; ++trial) {
    dvi::PlacedPrimitive pa{&a, 1, Vec3::Zero(), random.rotation().toRotationMatrix()};
    dvi::PlacedPrimitive pb{&b, 1, Vec3::Zero(), random.rotation().toRotationMatrix()};
    const Vec3 direction = random.rotation() * Vec3::UnitX();
    const double wanted = random.uniform(low, high);
    // Bisection along the direction to the wanted gap.
    double near = 0, far = 8;
    std::vector<dvi::ContactPoint> exact;
    for (int k = 0; k < 40; ++k) {
      const double at = 0.5 * (near + far);
      pb.position = at * direction;
      exact.clear();
      dvi::collide(pa, pb, 20, exact);
      const auto least = std::min_element(exact.begin(), exact.end(),
                                          [](const auto& x, const auto& y) { return x.gap < y.gap; });
      (least->gap < wanted ? near : far) = at;
    }
    const auto least =
        *std::min_element(exact.begin(), exact.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
    dvi::ContactPoint found;
    const Touch answer =
        touch({shape_a.get(), pa.position, pa.rotation}, {shape_b.get(), pb.position, pb.rotation}, 1, found);
    errors.apart += answer == Touch::apart;
    errors.no_answer += answer == Touch::no_answer;
    if (answer != Touch::found) continue;
    errors.gap = std::max(errors.gap, std::abs(found.gap - least.gap));
    errors.normal = std::max(errors.normal, (found.normal - least.normal).norm());
  }
  return errors;
}

TEST(BulletContact, AgreesWithTheExactGeometry) {
  struct Range {
    const char* name;
    double low, high;
  };
  for (const Range& range : {Range{"apart", 1e-3, 0.5}, Range{"touching", -1e-4, 1e-4}, Range{"overlapping", -0.1, -1e-3}}) {
    std::uint64_t seed = 1;
    const auto check = [&](const Named& a, const Named& b) {
      const Errors errors = compare(a.primitive, b.primitive, range.low, range.high, ++seed);
      const std::string name = std::string(a.name) + " and " + b.name + ", " + range.name;
      std::printf("%-40s gap %.1e normal %.1e left %d\n", name.c_str(), errors.gap, errors.normal, errors.no_answer);
      EXPECT_EQ(errors.apart, 0) << name;
      // Only two sharp cones have no margin at all. Of the others Bullet's GJK leaves one pair in some thousands without an
      // answer that can be proven, which ones depends on rounding; never is a wrong one taken.
      const bool both_sharp = &a == &b && &a == &round_shapes.back();
      EXPECT_LE(both_sharp ? 0 : errors.no_answer, 3) << name;
      EXPECT_LE(errors.gap, 1e-8) << name;
      EXPECT_LE(errors.normal, 2e-4) << name;
    };
    for (std::size_t i = 0; i < round_shapes.size(); ++i) {
      for (std::size_t k = i; k < round_shapes.size(); ++k) check(round_shapes[i], round_shapes[k]);
      if (i < 3)
        for (const Named& flat : flat_shapes) check(round_shapes[i], flat);
    }
  }
}

}  // namespace
}  // namespace repose::bullet
