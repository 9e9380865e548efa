/// Periodic cells: images, the rules for tools, filling, recordings, and contacts across the seam against an oracle.
#include "core/periodic_body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "backends/dvi/contact_finder.hpp"
#include "core/error.hpp"
#include "core/fill.hpp"
#include "core/grain_shape.hpp"
#include "core/hdf5_file.hpp"
#include "core/random.hpp"
#include "core/recording_model.hpp"
#include "core/recording_xdmf.hpp"
#include "core/scene_yaml.hpp"
#include "tests/support/model_builder.hpp"

namespace repose {
namespace {

using test::ModelBuilder;
using test::shape_of;

const PeriodicCell tall{{0, -1, 0}, {0, 2, 0}};  // along y, period 3

TEST(PeriodicCell, WrapsIntoTheCellAndKeepsTheBitsOfWhatIsInside) {
  EXPECT_EQ(tall.wrapped({7, 2, -9}), Vec3(7, -1, -9));
  EXPECT_EQ(tall.wrapped({7, -1, -9}), Vec3(7, -1, -9));
  EXPECT_DOUBLE_EQ(tall.wrapped({0, 8.5, 0}).y(), -0.5);
  EXPECT_DOUBLE_EQ(tall.wrapped({0, -7.25, 0}).y(), 1.75);
  EXPECT_EQ(tall.wrapped({0, 0.1, 0}).y(), 0.1);
  // Below the cell by less than rounding resolves: the sum is the upper bound, which belongs to the next cell.
  EXPECT_EQ((PeriodicCell{{0, 0, 0}, {0, 3, 0}}.wrapped({0, -1e-20, 0}).y()), 0);
  EXPECT_EQ(PeriodicCell{}.wrapped({5, 6, 7}), Vec3(5, 6, 7));
}

TEST(PeriodicCell, TheNearestImageIsWithinHalfAPeriod) {
  Random random(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 d(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    const Vec3 shift = tall.to_nearest(d);
    EXPECT_EQ(shift.x(), 0);
    EXPECT_EQ(shift.z(), 0);
    EXPECT_EQ(shift.y(), 3 * std::round(shift.y() / 3));
    EXPECT_LE(std::abs(d.y() + shift.y()), 1.5);
  }
}

TEST(PeriodicCell, ImagesThatReachIntoTheCell) {
  const PeriodicCell square{{0, 0, 0}, {1, 1, 0}};
  const auto count = [&](const Vec3& place) {
    int images = 0;
    square.each_image(place, 0.1, [&](const Vec3&) { return ++images > 0; });
    return images;
  };
  EXPECT_EQ(count({0.5, 0.5, 0}), 1);
  EXPECT_EQ(count({0.05, 0.5, 0}), 2);
  EXPECT_EQ(count({0.05, 0.97, 0}), 4);
  EXPECT_FALSE(square.each_image({0, 0.5, 0}, 0.1, [](const Vec3& image) { return image.x() < 1; }));
}

/// A ball of diameter 0.2 in a cell of period 1 along y, and one tool: D = 0.2, so a tool must go from -0.7 to 0.7.
Model with_tool(const Shape& tool, const Pose& pose = {}, const Motion& motion = {}) {
  return ModelBuilder()
      .material("m")
      .periodic(1, -0.5, 0.5)
      .sphere("m", 0.1, {.position = {0, 0, 5}})
      .wall("m", tool, pose, motion)
      .build();
}

const Quat along_y = test::turn(std::numbers::pi / 2, {1, 0, 0});

Shape roller(double width) {
  return shape_of("roller", Revolved{{{0, -width / 2}, {1, -width / 2}, {1, width / 2}, {0, width / 2}}});
}

TEST(PeriodicTools, EndlessOnes) {
  const auto endless = [](const Model& model) { return is_endless(model, 1, 1); };
  EXPECT_TRUE(endless(with_tool(shape_of("floor", HalfSpace{{0, 0, 1}}))));
  EXPECT_TRUE(endless(with_tool(shape_of("ramp", HalfSpace{Vec3(1, 0, 2).normalized()}))));
  EXPECT_TRUE(endless(with_tool(shape_of("plate", Box{{3, 0.7, 0.1}}))));
  EXPECT_TRUE(endless(with_tool(shape_of("plate", Box{{0.1, 3, 0.8}}), {{0, 0.05, 0}, test::turn(std::numbers::pi / 2, {1, 0, 0})})));
  EXPECT_TRUE(endless(with_tool(shape_of("rod", Cylinder{0.1, 0.7}), {{0, 0, 0}, along_y})));
  EXPECT_TRUE(endless(with_tool(roller(1.5), {{0, 0, 0}, along_y}, {.velocity = {1, 0, 0}, .angular_velocity = {0, 9, 0}})));
  // A belt, and a drum whose end walls nothing can reach.
  EXPECT_TRUE(endless(with_tool(shape_of("belt", HalfSpace{{0, 0, 1}}), {}, {.velocity = {0, 1, 0}})));
  const Revolved drum{{{0, -1}, {2, -1}, {2, 1}, {0, 1}, {0, 0.9}, {1.9, 0.9}, {1.9, -0.9}, {0, -0.9}}};
  EXPECT_TRUE(endless(with_tool(shape_of("drum", drum), {{0, 0, 5}, along_y})));
}

TEST(PeriodicTools, RepeatedOnes) {
  const auto repeated = [](const Model& model) { return !is_endless(model, 1, 1); };
  EXPECT_TRUE(repeated(with_tool(shape_of("post", Sphere{0.3}))));
  // Tall, but short along y; at the seam; swung about, through the cells.
  EXPECT_TRUE(repeated(with_tool(shape_of("post", Cylinder{0.2, 4}), {{0, 0.5, 0}, Quat::Identity()})));
  EXPECT_TRUE(repeated(with_tool(shape_of("paddle", Box{{0.1, 0.1, 0.2}}), {}, {.velocity = {0, 5, 0}, .angular_velocity = {7, 0, 0}})));
}

TEST(PeriodicTools, AllOthersAreRefused) {
  const Pose lying{{0, 0, 0}, along_y};
  EXPECT_THROW(with_tool(shape_of("plate", Box{{3, 0.69, 0.1}})), Error);
  EXPECT_THROW(with_tool(shape_of("plate", Box{{3, 0.7, 0.1}}), {{0, 0.01, 0}, Quat::Identity()}), Error);
  EXPECT_THROW(with_tool(shape_of("plate", Box{{3, 0.9, 0.1}}), {{0, 0, 0}, test::turn(1e-3, {0, 0, 1})}), Error);
  EXPECT_THROW(with_tool(shape_of("plate", Box{{3, 0.9, 0.1}}), {}, {.velocity = {0, 0.1, 0}}), Error);
  EXPECT_THROW(with_tool(shape_of("plate", Box{{3, 0.9, 0.1}}), {}, {.angular_velocity = {1, 0, 0}}), Error);
  EXPECT_THROW(with_tool(shape_of("floor", HalfSpace{{0, 0, 1}}), {}, {.angular_velocity = {1, 0, 0}}), Error);
  EXPECT_THROW(with_tool(shape_of("slope", HalfSpace{Vec3(0, 1e-3, 1).normalized()})), Error);
  EXPECT_THROW(with_tool(roller(1.0), lying), Error);
  EXPECT_THROW(with_tool(roller(1.5)), Error) << "its axis is z";
  const Revolved bottle{{{0, -1}, {2, -1}, {2, 0}, {1.9, 0.1}, {1.9, 1}, {0, 1}}};
  EXPECT_THROW(with_tool(shape_of("bottle", bottle), lying), Error);
  EXPECT_THROW(with_tool(shape_of("post", Sphere{0.31})), Error);
  EXPECT_THROW(with_tool(shape_of("post", Sphere{0.1}), {{0, 0.6, 0}, Quat::Identity()}), Error);
}

TEST(PeriodicModel, TheRulesOfTheCell) {
  const auto ball = [](double half, double range) {
    return ModelBuilder()
        .material("m")
        .law("m", "m", {.cohesion = 1, .cohesion_range = range})
        .periodic(0, -half, half)
        .sphere("m", 0.1)
        .build();
  };
  EXPECT_NO_THROW(ball(0.3001, 0));
  EXPECT_THROW(ball(0.2999, 0), Error);
  EXPECT_THROW(ball(0.3001, 0.01), Error);
  Model model = ball(0.5, 0);
  model.initial.position[0].x() = 0.6;
  EXPECT_THROW(validate(model), Error);
  model = ball(0.5, 0);
  model.periodic.upper.z() = 9;
  EXPECT_THROW(validate(model), Error);
  model = ball(0.5, 0);
  model.periodic.upper.x() = -1;
  EXPECT_THROW(validate(model), Error);
}

TEST(PeriodicModel, ScalesAndIsRecorded) {
  const Model model = ModelBuilder().material("m").periodic(0, -0.3, 0.7).periodic(1, 0.1, 1.3).sphere("m", 0.1).build();
  EXPECT_EQ(froude_scaled(model, 0.25).periodic, (PeriodicCell{{-0.075, 0.025, 0}, {0.175, 0.325, 0}}));

  Model read;
  parse_model_description(describe_model(model), model.bodies.size(), read);
  EXPECT_EQ(read.periodic, model.periodic);
  Model open = model;
  open.periodic = {};
  EXPECT_NE(fingerprint(open), fingerprint(model));
  EXPECT_EQ(describe_model(open).find("periodic"), std::string::npos) << "files of other scenes stay as they were";
  read.periodic = model.periodic;
  parse_model_description(describe_model(open), open.bodies.size(), read);
  EXPECT_FALSE(read.periodic.any());

  const std::string xdmf = xdmf_text(1, {0.0}, model.periodic);
  EXPECT_NE(xdmf.find("\"periodic_x\" Value=\"-0.2"), std::string::npos) << xdmf;
  EXPECT_NE(xdmf.find("\"periodic_y\""), std::string::npos);
  EXPECT_EQ(xdmf_text(1, {0.0}, {}).find("periodic"), std::string::npos);
}

TEST(PeriodicScene, BodiesAreTakenIntoTheCellAndGrainsFillItAcrossTheSeam) {
  const Scene scene = parse_scene(R"(
materials: {a: {density: 1000}}
pairs: {a-a: {friction: 0.5}}
shapes: {ball: {type: sphere, radius: 50 um}, floor: {type: half_space, normal: [0, 0, 1]}}
bodies:
  ball: {shape: ball, material: a, position: [0, 2.25 mm, 5 mm]}
  floor: {shape: floor, material: a, position: [0, 7, 0], fixed: true}
periodic: {y: [0, 1 mm]}
grains:
  low: {material: a, count: 150, mix: {twin: 1}, size: 60 um, fill: {box: {lower: [0, 0, 0], upper: [1 mm, 1 mm, 0.3 mm]}}}
  side: {material: a, count: 20, mix: {sphere: 1}, size: 60 um, fill: {box: {lower: [0, 0, 2 mm], upper: [1 mm, 0.4 mm, 2.4 mm]}}}
duration: 1
)",
                                  "test", {}, ".");
  EXPECT_EQ(scene.periodic.upper, Vec3(0, 1e-3, 0));
  const Model model = realise(scene, 3);
  EXPECT_NEAR(model.initial.position[0].y(), 0.25e-3, 1e-15);
  EXPECT_EQ(model.initial.position[1].y(), 7) << "what does not move stays as it was written";
  int sticking_out = 0;
  double least = 1;
  for (std::size_t i = 2; i < model.bodies.size(); ++i) {
    const Vec3& x = model.initial.position[i];
    const double r = model.bodies[i].scale * model.shapes[std::size_t(model.bodies[i].shape)].bounding_radius;
    sticking_out += x.y() < r || x.y() > 1e-3 - r;
    for (std::size_t j = 2; j < i; ++j) {
      const Vec3 d = model.initial.position[j] - x;
      const double s = model.bodies[j].scale * model.shapes[std::size_t(model.bodies[j].shape)].bounding_radius;
      least = std::min(least, ((d + model.periodic.to_nearest(d)).norm() - r - s) / r);
    }
    if (model.names[std::size_t(model.bodies[i].name)] == "side") {
      EXPECT_GE(x.y(), r);
    }
  }
  EXPECT_GE(least, 0);
  EXPECT_GT(sticking_out, 10);
}

TEST(PeriodicScene, RegionsThatOverlapThroughTheSeamAreRefused) {
  const std::string text = R"(
materials: {a: {density: 1000}}
pairs: {a-a: {friction: 0.5}}
periodic: {y: [0, 1 mm]}
grains:
  across: {material: a, count: 300, size: 60 um, fill: {box: {lower: [0, 0, 0], upper: [1 mm, 1 mm, 0.4 mm]}, grow: false}}
  edge: {material: a, count: 10, size: 60 um, fill: {box: {lower: [0, LOW, HIGH], upper: [1 mm, 0.1 mm, 1 mm]}}}
duration: 1
)";
  const auto make = [&](const std::string& low, const std::string& high) {
    std::string now = text;
    now.replace(now.find("LOW"), 3, low);
    now.replace(now.find("HIGH"), 4, high);
    return realise(parse_scene(now, "test", {}, "."), 1);
  };
  EXPECT_NO_THROW(make("0", "0.5 mm"));
  EXPECT_THROW(make("0", "0.1 mm"), Error);
  EXPECT_THROW(make("-0.1 mm", "0.5 mm"), Error);
}

// ---- contacts across the seam, against the same search with every image as a body of its own ----

struct Grain {
  std::size_t shape;
  double size;
  Vec3 place;
  Quat turn;
};

/// The contacts of a model's first state at rest.
std::vector<dvi::FoundContact> contacts_at_rest(const Model& model) {
  const std::size_t n = model.bodies.size();
  std::vector<Mat3> rotation;
  for (const Quat& q : model.initial.orientation) rotation.push_back(q.toRotationMatrix());
  const std::vector<Vec3> still(n, Vec3::Zero());
  const std::vector<double> turning(n, 0.0);
  const std::vector<char> present(n, 1);
  dvi::ContactFinder finder(model, 1);
  return finder.find({model.initial.position, rotation, still, still, turning, present}, 0, 1, 1);
}

using Touch = std::pair<int, int>;

TEST(PeriodicContacts, AreThoseAmongAllImages) {
  std::vector<Shape> shapes;
  for (const std::string& name : grain_shape_names()) shapes.push_back(make_grain_shape(name));
  Random random(5, 0);
  int across = 0, compared = 0;
  for (int scene = 0; scene < 12; ++scene) {
    const PeriodicCell cell{{-1, 0.5, 0}, {scene % 3 == 0 ? 6.2 : 9.0, scene % 2 ? 0.5 : 8.5, 0}};
    std::vector<Grain> grains;
    for (int i = 0; i < 150; ++i) {
      const Vec3 place(random.uniform(-1, cell.upper.x()), random.uniform(0.5, 8.5), random.uniform(0.4, 4));
      grains.push_back({random.below(shapes.size()), random.uniform(0.4, 1), place, random.rotation()});
    }
    ModelBuilder wrapped, open;
    wrapped.material("m").floor("m").periodic(0, cell.lower.x(), cell.upper.x());
    if (cell.along(1)) wrapped.periodic(1, cell.lower.y(), cell.upper.y());
    open.material("m").floor("m");
    for (const Grain& g : grains)
      wrapped.body("m", shapes[g.shape], {.position = g.place, .orientation = g.turn}, g.size);
    std::vector<int> image_of{0};
    const auto copy = [&](const Vec3& shift) {
      for (std::size_t i = 0; i < grains.size(); ++i) {
        open.body("m", shapes[grains[i].shape], {.position = grains[i].place + shift, .orientation = grains[i].turn},
                  grains[i].size);
        image_of.push_back(static_cast<int>(i) + 1);
      }
    };
    copy(Vec3::Zero());
    const int originals = static_cast<int>(grains.size());
    for (int a = -1; a <= 1; ++a)
      for (int b = -1; b <= 1; ++b)
        if ((a || b) && (b == 0 || cell.along(1))) copy({a * cell.length(0), b * cell.length(1), 0});
    const Model inside = wrapped.build(), outside = open.build();
    const auto key = [](int a, int b) { return Touch{std::min(a, b), std::max(a, b)}; };
    std::map<Touch, double> got, wanted;  // the smallest gap of each pair
    const auto keep = [](std::map<Touch, double>& table, const Touch& pair, double gap) {
      const auto at = table.try_emplace(pair, gap).first;
      at->second = std::min(at->second, gap);
    };
    for (const dvi::FoundContact& c : contacts_at_rest(inside)) keep(got, key(c.id.a(), c.id.b()), c.point.gap);
    for (const dvi::FoundContact& c : contacts_at_rest(outside)) {
      if (c.id.a() > originals) continue;  // one of the two in the cell is enough
      keep(wanted, key(image_of[std::size_t(c.id.a())], image_of[std::size_t(c.id.b())]), c.point.gap);
      across += c.id.b() > originals;
    }
    ASSERT_EQ(got.size(), wanted.size()) << "scene " << scene;
    for (const auto& [pair, gap] : wanted) {
      ASSERT_TRUE(got.count(pair)) << "scene " << scene << ", pair " << pair.first << ", " << pair.second;
      EXPECT_NEAR(got[pair], gap, 1e-7) << "scene " << scene << ", pair " << pair.first << ", " << pair.second;
      ++compared;
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_GT(across, 100);
}

}  // namespace
}  // namespace repose
