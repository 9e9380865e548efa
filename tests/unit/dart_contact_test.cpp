/// FCL's contacts, where it is asked, against the exact geometry of Repose's own narrow phase.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "backends/dart/fcl_contacts.hpp"
#include "backends/dvi/narrow_phase.hpp"
#include "core/random.hpp"

namespace repose::dart {
namespace {

dvi::ContactPoint deepest(const dvi::PlacedPrimitive& a, const dvi::PlacedPrimitive& b) {
  std::vector<dvi::ContactPoint> all;
  dvi::collide(a, b, 1000, all);
  return *std::min_element(all.begin(), all.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
}

struct Errors {
  double gap = 0, normal = 0, point = 0;
  int missed = 0;
};

/// Random poses in which the pair overlaps by up to `depth`.
Errors compare(const Primitive& a, const Primitive& b, double scale, double depth) {
  Random random(7, 0);
  FclContacts fcl;
  fcl.add(a, scale, 0, true);
  fcl.add(b, scale, 1, !std::holds_alternative<HalfSpace>(b));
  Errors errors;
  for (int trial = 0; trial < 300; ++trial) {
    dvi::PlacedPrimitive pa{&a, scale, Vec3::Zero(), random.rotation().toRotationMatrix()};
    dvi::PlacedPrimitive pb{&b, scale, Vec3::Zero(), random.rotation().toRotationMatrix()};
    const Vec3 way =
        std::holds_alternative<HalfSpace>(b) ? Vec3(-pb.rotation.col(2)) : Vec3(random.rotation() * Vec3::UnitX());
    const double wanted = -random.uniform(0, depth) * scale;
    double near = 0, far = 8 * scale;
    for (int k = 0; k < 60; ++k) {
      pb.position = 0.5 * (near + far) * way;
      (deepest(pa, pb).gap < wanted ? near : far) = 0.5 * (near + far);
    }
    const dvi::ContactPoint exact = deepest(pa, pb);
    fcl.place(0, pa.position, pa.rotation, true);
    fcl.place(1, pb.position, pb.rotation, true);
    const std::vector<FclContact>& found = fcl.find();
    if (found.empty()) {
      ++errors.missed;
      continue;
    }
    const FclContact& least =
        *std::min_element(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
    EXPECT_EQ(least.a, 0);
    EXPECT_EQ(least.b, 1);
    errors.gap = std::max(errors.gap, std::abs(least.gap - exact.gap) / scale);
    errors.normal = std::max(errors.normal, (least.normal - exact.normal).norm());
    errors.point = std::max(errors.point, std::abs((least.point - exact.point).dot(exact.normal)) / scale);
  }
  return errors;
}

TEST(DartContact, AgreesWithTheExactGeometryWhereItIsAsked) {
  const Sphere ball{1};
  const Box box{{1, 0.8, 0.6}};
  const Ellipsoid egg{{1.2, 0.9, 0.7}};
  const HalfSpace floor{};
  struct Pair {
    const char* name;
    Primitive a, b;
  };
  for (const double scale : {0.1, 1.0, 30.0})
    for (const Pair& pair :
         {Pair{"spheres", ball, ball}, Pair{"sphere and box", ball, box}, Pair{"sphere and half-space", ball, floor},
          Pair{"ellipsoid and half-space", egg, floor}, Pair{"boxes", box, box}}) {
      ASSERT_TRUE(fcl_finds(pair.a, pair.b)) << pair.name;
      // Two boxes that overlap deeply may well be parted along a face where an edge would be a little shorter.
      const Errors errors = compare(pair.a, pair.b, scale, 0.01);
      // The skin of an edge or a corner is not round: up to sqrt(3) skins instead of one, on either side.
      EXPECT_LE(errors.gap, 2 * skin / scale) << pair.name;
      EXPECT_LE(errors.normal, 3 * skin / scale) << pair.name;
      EXPECT_LE(errors.point, 3 * skin / scale) << pair.name;
      EXPECT_EQ(errors.missed, 0) << pair.name;
    }
}

TEST(DartContact, WhatItIsNotAskedForItDoesNotFind) {
  const Sphere ball{1};
  for (const Primitive& other : std::vector<Primitive>{Ellipsoid{{1, 2, 1}}, RoundCone{1, 0.5, 1}, Cone{1, 1},
                                                       Cylinder{1, 1}, Revolved{{{0, 0}, {1, 0}, {1, 1}}}, TriMesh{}}) {
    EXPECT_FALSE(fcl_finds(ball, other)) << other.index();
    EXPECT_FALSE(fcl_finds(other, ball)) << other.index();
  }
  EXPECT_FALSE(fcl_finds(Box{{1, 1, 1}}, HalfSpace{})) << "one point does not carry a face";
  EXPECT_FALSE(fcl_finds(Ellipsoid{{1, 1, 1}}, Ellipsoid{{1, 1, 1}})) << "its normal is off by up to 0.4";
}

TEST(DartContact, OnlyPairsThatMayTouch) {
  FclContacts fcl;
  const Sphere ball{1};
  for (int part = 0; part < 6; ++part) fcl.add(ball, 1, part / 2, part < 4);  // bodies 0, 1 move; body 2 does not
  fcl.add(HalfSpace{}, 1, 3, false);
  const auto place = [&](bool present) {
    for (int part = 0; part < 6; ++part)
      fcl.place(part, Vec3(0.1 * part, 0, 0.5), Mat3::Identity(), present || part != 0);
    fcl.place(6, Vec3::Zero(), Mat3::Identity(), true);
  };
  place(true);
  // Parts of bodies 0 and 1, of 0 and 2, of 1 and 2: four each; and four movable parts on the half-space.
  EXPECT_EQ(fcl.find().size(), 16u);
  place(false);
  EXPECT_EQ(fcl.find().size(), 16u - 5u);
}

TEST(DartContact, TouchingIsContact) {
  FclContacts fcl;
  fcl.add(Sphere{1}, 1, 0, true);
  fcl.add(Sphere{1}, 1, 1, true);
  fcl.place(0, Vec3::Zero(), Mat3::Identity(), true);
  for (const double gap : {-1e-15, 0.0, 1e-15, 1.9e-6}) {
    fcl.place(1, Vec3(0, 0, 2 + gap), Mat3::Identity(), true);
    ASSERT_EQ(fcl.find().size(), 1u) << gap;
    EXPECT_NEAR(fcl.find().front().gap, gap, 1e-14);
  }
  fcl.place(1, Vec3(0, 0, 2 + 2.1e-6), Mat3::Identity(), true);
  EXPECT_TRUE(fcl.find().empty());
}

}  // namespace
}  // namespace repose::dart
