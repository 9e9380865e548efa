#include "core/tool.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "core/error.hpp"

namespace repose {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 place(0.3, -0.2, 1.5);

/// The tool as seen by a grain: which points are solid, relative to the tool's position.
class Solid {
 public:
  explicit Solid(const ToolKind& kind, const Vec3& position = place)
      : position_(position), bodies_(build_tool({"it", "steel", kind, position, {}})) {}

  bool operator()(const Vec3& point, double time = 0) const {
    return std::any_of(bodies_.begin(), bodies_.end(), [&](const ToolBody& body) {
      const bool there =
          body.active.empty() || std::any_of(body.active.begin(), body.active.end(),
                                             [&](const Interval& i) { return time >= i.from && time < i.to; });
      return there && contains(body.shape, body.pose.to_local(position_ + point));
    });
  }
  /// At radius r about the vertical axis and height z, in some direction.
  bool at(double r, double z, double time = 0) const {
    const bool solid = (*this)({r * std::cos(2.2), r * std::sin(2.2), z}, time);
    EXPECT_EQ(solid, (*this)({r * std::cos(-0.4), r * std::sin(-0.4), z}, time)) << r << " " << z;
    return solid;
  }
  const std::vector<ToolBody>& bodies() const { return bodies_; }

 private:
  Vec3 position_;
  std::vector<ToolBody> bodies_;
};

void expect_refused(const ToolKind& kind, const std::string& key) {
  try {
    build_tool({"it", "steel", kind, {}, {}});
    FAIL() << "accepted; expected a complaint about " << key;
  } catch (const Error& error) {
    EXPECT_EQ(error.place(), "tools.it." + key);
    EXPECT_FALSE(error.remedy().empty());
  }
}

const Funnel funnel{.outlet_diameter = 2e-3,
                    .half_angle_deg = 30,
                    .top_diameter = 12e-3,
                    .wall_height = 4e-3,
                    .thickness = 0.5e-3,
                    .opens = 0.1,
                    .closes = 0.7};

TEST(Funnel, TheConeHasItsAngleAndThicknessEverywhere) {
  const Solid solid(funnel);
  const double angle = pi / 6, cone_height = 5e-3 / std::tan(angle);
  for (const double share : {0.05, 0.5, 0.9}) {
    const double z = share * cone_height, inner = 1e-3 + z * std::tan(angle);
    // Along the normal of the cone's inner surface, into the wall.
    const auto wall = [&](double depth) {
      return solid.at(inner + depth * std::cos(angle), z - depth * std::sin(angle));
    };
    EXPECT_FALSE(wall(-1e-9));
    EXPECT_TRUE(wall(1e-9));
    if (share < 0.06) continue;  // the outlet's plane cuts the wall there
    EXPECT_TRUE(wall(0.5e-3 - 1e-9));
    EXPECT_FALSE(wall(0.5e-3 + 1e-9));
  }
}

TEST(Funnel, TheCylinderStandsOnTheCone) {
  const Solid solid(funnel);
  const double cone_height = 5e-3 / std::tan(pi / 6), middle = cone_height + 2e-3;
  EXPECT_FALSE(solid.at(6e-3 - 1e-9, middle));
  EXPECT_TRUE(solid.at(6e-3 + 1e-9, middle));
  EXPECT_TRUE(solid.at(6.5e-3 - 1e-9, middle));
  EXPECT_FALSE(solid.at(6.5e-3 + 1e-9, middle));
  EXPECT_TRUE(solid.at(6.2e-3, cone_height + 4e-3 - 1e-9));
  EXPECT_FALSE(solid.at(6.2e-3, cone_height + 4e-3 + 1e-9));
  EXPECT_FALSE(solid.at(1.2e-3, -1e-9, 0.5));  // nothing reaches below the outlet's plane while it is open
}

TEST(Funnel, TheShutterIsThereExceptWhileOpen) {
  const Solid solid(funnel);
  ASSERT_EQ(solid.bodies().size(), 2u);
  const double below = -1e-9;
  for (const double r : {0.0, 0.5e-3, 0.999e-3}) {
    EXPECT_TRUE(solid.at(r, below, 0));
    EXPECT_TRUE(solid.at(r, below, 0.0999));
    EXPECT_FALSE(solid.at(r, below, 0.1));
    EXPECT_FALSE(solid.at(r, below, 0.6999));
    EXPECT_TRUE(solid.at(r, below, 0.7));
    EXPECT_TRUE(solid.at(r, below, 1e6));
    EXPECT_FALSE(solid.at(r, 1e-9, 0));
  }
  EXPECT_TRUE(solid.at(1e-3, below, 0));  // wider than the outlet, no gap at its edge
}

TEST(Funnel, WithoutTimesThereIsNoShutterOrItNeverCloses) {
  Funnel open = funnel;
  open.opens = 0;
  open.closes = Funnel{}.closes;
  EXPECT_EQ(Solid(open).bodies().size(), 1u);
  open.opens = 0.2;
  const Solid solid(open);
  ASSERT_EQ(solid.bodies().size(), 2u);
  ASSERT_EQ(solid.bodies()[1].active.size(), 1u);
  EXPECT_FALSE(solid.at(0, -1e-9, 1e9));
}

TEST(Funnel, WithoutWallTheConeEndsAtTheTop) {
  Funnel cone = funnel;
  cone.wall_height = 0;
  const Solid solid(cone);
  const double height = 5e-3 / std::tan(pi / 6);
  EXPECT_TRUE(solid.at(6e-3 + 1e-6, height - 1e-9));
  EXPECT_FALSE(solid.at(6e-3 + 1e-6, height + 1e-9));
}

TEST(Funnel, AThickWallSwallowsTheOuterCone) {
  Funnel thick{
      .outlet_diameter = 2e-3, .half_angle_deg = 80, .top_diameter = 3e-3, .wall_height = 2e-3, .thickness = 2e-3};
  const Solid solid(thick);
  EXPECT_TRUE(solid.at(3.4e-3, 1e-6));
  EXPECT_FALSE(solid.at(3.6e-3, 1e-6));
}

TEST(Funnel, RefusesImpossibleDimensions) {
  const auto spoiled = [](const std::function<void(Funnel&)>& spoil) {
    Funnel bad = funnel;
    spoil(bad);
    return bad;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused(spoiled([](Funnel& f) { f.outlet_diameter = 0; }), "outlet_diameter");
  expect_refused(spoiled([=](Funnel& f) { f.outlet_diameter = nan; }), "outlet_diameter");
  expect_refused(spoiled([](Funnel& f) { f.half_angle_deg = 90; }), "half_angle_deg");
  expect_refused(spoiled([](Funnel& f) { f.half_angle_deg = -5; }), "half_angle_deg");
  expect_refused(spoiled([](Funnel& f) { f.top_diameter = 1e-3; }), "top_diameter");
  expect_refused(spoiled([](Funnel& f) { f.wall_height = -1; }), "wall_height");
  expect_refused(spoiled([](Funnel& f) { f.thickness = 0; }), "thickness");
  expect_refused(spoiled([](Funnel& f) { f.opens = -1; }), "opens");
  expect_refused(spoiled([](Funnel& f) { f.closes = 0.05; }), "closes");
}

const Base base{.diameter = 54.8e-3,
                .rim_height = 1e-3,
                .rim_width = 2e-3,
                .trench_width = 8e-3,
                .trench_depth = 5e-3,
                .trench_wall = 9e-3};

TEST(Base, PlateRimTrenchAndWall) {
  const Solid solid(base);
  ASSERT_EQ(solid.bodies().size(), 1u);
  const double e = 1e-7, rim = 27.4e-3, outside = 29.4e-3, wall = 37.4e-3;
  EXPECT_TRUE(solid.at(0, -e));
  EXPECT_FALSE(solid.at(0, e));
  EXPECT_TRUE(solid.at(rim - e, -e));
  EXPECT_FALSE(solid.at(rim - e, e));
  EXPECT_TRUE(solid.at(rim + e, 1e-3 - e));
  EXPECT_FALSE(solid.at(rim + e, 1e-3 + e));
  EXPECT_TRUE(solid.at(outside - e, 0.5e-3));
  EXPECT_FALSE(solid.at(outside + e, 0.5e-3));  // the channel is open ...
  EXPECT_FALSE(solid.at(33e-3, -5e-3 + e));     // ... down to its floor
  EXPECT_TRUE(solid.at(33e-3, -5e-3 - e));
  EXPECT_FALSE(solid.at(wall - e, 3e-3));
  EXPECT_TRUE(solid.at(wall + e, 4e-3 - e));  // 9 mm above the floor is 4 mm above the plate
  EXPECT_FALSE(solid.at(wall + e, 4e-3 + e));
  EXPECT_TRUE(solid.at(wall + 0.9 * 0.05 * 54.8e-3, 0));
}

TEST(Base, WithoutTrenchAPlainDiscWithRim) {
  Base plain;
  plain.diameter = 4e-3;
  EXPECT_TRUE(Solid(plain).at(2e-3 - 1e-9, -1e-9));
  EXPECT_FALSE(Solid(plain).at(2e-3 + 1e-9, -1e-9));
  EXPECT_FALSE(Solid(plain).at(1e-3, 1e-9));
  const Solid disc(plain);
  EXPECT_EQ(std::get<Revolved>(disc.bodies()[0].shape.parts[0].primitive).profile.size(),
            4u);  // no points that only repeat an edge

  plain.rim_height = 0.2e-3;
  plain.rim_width = 0.3e-3;
  EXPECT_TRUE(Solid(plain).at(2.1e-3, 0.2e-3 - 1e-9));
  EXPECT_FALSE(Solid(plain).at(2.4e-3, 0));
}

TEST(Base, TrenchWithoutRimAndRimWithoutStep) {
  Base level = base;
  level.rim_height = 0;
  level.rim_width = 0;
  EXPECT_TRUE(Solid(level).at(27.4e-3 - 1e-7, -1e-7));
  EXPECT_FALSE(Solid(level).at(27.4e-3 + 1e-7, -1e-7));
  level = base;
  level.trench_depth = 0;
  EXPECT_FALSE(Solid(level).at(33e-3, 1e-7));
  EXPECT_TRUE(Solid(level).at(33e-3, -1e-7));
}

TEST(Base, RefusesImpossibleDimensions) {
  const auto spoiled = [](const std::function<void(Base&)>& spoil) {
    Base bad = base;
    spoil(bad);
    return bad;
  };
  expect_refused(spoiled([](Base& b) { b.diameter = -1; }), "diameter");
  expect_refused(spoiled([](Base& b) { b.rim_height = -1; }), "rim_height");
  expect_refused(spoiled([](Base& b) { b.rim_width = 0; }), "rim_width");
  expect_refused(spoiled([](Base& b) { b.trench_width = 0; }), "trench_width");
  expect_refused(spoiled([](Base& b) { b.trench_wall = 0; }), "trench_wall");
  expect_refused(spoiled([](Base& b) { b.trench_depth = -1; }), "trench_depth");
  expect_refused(spoiled([](Base& b) { b.trench_depth = b.rim_height = b.rim_width = 0; }), "trench_depth");
}

TEST(Plate, ItsTopFaceIsCentredOnThePosition) {
  const Solid solid(Plate{{0.3, 0.2, 0.1}});
  EXPECT_TRUE(solid({0.149, 0.099, -0.001}));
  EXPECT_TRUE(solid({-0.149, -0.099, -0.099}));
  EXPECT_FALSE(solid({0, 0, 0.001}));
  EXPECT_FALSE(solid({0, 0, -0.101}));
  EXPECT_FALSE(solid({0.151, 0, -0.05}));
  EXPECT_FALSE(solid({0, 0.101, -0.05}));
  expect_refused(Plate{{1, 0, 1}}, "size");
}

TEST(Floor, IsTheHalfSpaceUnderItsNormal) {
  const Solid solid(Floor{{0, 0, 3}});
  EXPECT_TRUE(solid({1e3, -1e3, -1e-9}));
  EXPECT_FALSE(solid({1e3, -1e3, 1e-9}));
  EXPECT_TRUE(Solid(Floor{{1, 0, 1}})({-1, 0, 0.9}));
  EXPECT_FALSE(Solid(Floor{{1, 0, 1}})({-1, 0, 1.1}));
  expect_refused(Floor{{0, 0, 0}}, "normal");
}

TEST(Container, IsClosedAllAroundItsInnerSize) {
  const Container open{{0.4, 0.6, 0.3}, 0.05, false};
  Container closed = open;
  closed.lid = true;
  for (const bool lid : {false, true}) {
    const Solid solid(lid ? closed : open);
    EXPECT_EQ(solid.bodies().size(), lid ? 6u : 5u);
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; j <= 20; ++j) {
        const double s = (i - 10) / 10.0, t = (j - 10) / 10.0, up = 0.15 + 0.15 * t;
        EXPECT_FALSE(solid({0.199 * s, 0.299 * t, 0.15})) << "inside";
        EXPECT_TRUE(solid({0.249 * s, 0.349 * t, -0.001})) << "floor";
        EXPECT_TRUE(solid({0.201, 0.349 * s, 0.999 * up})) << "wall x";
        EXPECT_TRUE(solid({-0.249, 0.349 * s, 0.999 * up})) << "wall -x";
        EXPECT_TRUE(solid({0.249 * s, 0.301, 0.999 * up})) << "wall y";
        EXPECT_TRUE(solid({0.249 * s, -0.349, 0.999 * up})) << "wall -y";
        EXPECT_EQ(solid({0.249 * s, 0.349 * t, 0.301}), lid) << "lid";
      }
    }
  }
  expect_refused(Container{{1, 1, 0}, 0.1, false}, "inner_size");
  expect_refused(Container{{1, 1, 1}, 0, false}, "thickness");
}

TEST(Cup, IsOpenAtTheTop) {
  const Solid solid(Cup{0.2, 0.3, 0.01});
  EXPECT_FALSE(solid.at(0.099, 0.001));
  EXPECT_TRUE(solid.at(0.05, -0.001));
  EXPECT_TRUE(solid.at(0.109, -0.009));
  EXPECT_TRUE(solid.at(0.101, 0.299));
  EXPECT_FALSE(solid.at(0.101, 0.301));
  EXPECT_FALSE(solid.at(0.111, 0.1));
  EXPECT_FALSE(solid.at(0, 0.5));
  expect_refused(Cup{0, 1, 1}, "inner_diameter");
  expect_refused(Cup{1, 0, 1}, "height");
  expect_refused(Cup{1, 1, 0}, "thickness");
}

TEST(Roller, ItsAxisIsY) {
  const Solid solid(Roller{0.0762, 0.2});
  EXPECT_TRUE(solid({0, 0.099, 0}));
  EXPECT_FALSE(solid({0, 0.101, 0}));
  for (int k = 0; k < 12; ++k) {
    const Vec3 direction(std::cos(k), 0, std::sin(k));
    EXPECT_TRUE(solid(0.0380 * direction - Vec3(0, 0.09, 0)));
    EXPECT_FALSE(solid(0.0382 * direction));
  }
  expect_refused(Roller{0, 1}, "diameter");
  expect_refused(Roller{1, -1}, "width");
}

TEST(Drum, IsHollowAndClosedAtItsEnds) {
  const Solid solid(Drum{0.2, 0.1, 0.01});
  for (int k = 0; k < 12; ++k) {
    const Vec3 direction(std::cos(k), 0, std::sin(k));
    EXPECT_FALSE(solid(0.099 * direction + Vec3(0, 0.049, 0)));
    EXPECT_TRUE(solid(0.101 * direction));
    EXPECT_TRUE(solid(0.109 * direction));
    EXPECT_FALSE(solid(0.111 * direction));
    EXPECT_TRUE(solid(0.05 * direction + Vec3(0, 0.051, 0)));
    EXPECT_TRUE(solid(0.05 * direction - Vec3(0, 0.059, 0)));
    EXPECT_FALSE(solid(0.05 * direction - Vec3(0, 0.061, 0)));
  }
  expect_refused(Drum{0, 1, 1}, "inner_diameter");
  expect_refused(Drum{1, 0, 1}, "inner_width");
  expect_refused(Drum{1, 1, 0}, "thickness");
}

TEST(Tool, RefusesAPositionThatIsNotFinite) {
  EXPECT_THROW(build_tool({"it", "steel", Roller{1, 1}, {0, 0, std::numeric_limits<double>::quiet_NaN()}, {}}), Error);
}

}  // namespace
}  // namespace repose
