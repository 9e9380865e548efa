/// A periodic cell changes nothing but where a body is said to be: what happens across its seam is what happens inside.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "core/random.hpp"
#include "tests/physics/answer.hpp"
#include "tests/physics/energy.hpp"
#include "tests/physics/same_state.hpp"
#include "tests/physics/scenes.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

class Periodic : public OnEveryBackend {};
REPOSE_ON_EVERY_BACKEND(Periodic);

const PairLaw everything{.friction = 0.5,
                         .rolling_friction = 0.05,
                         .spinning_friction = 0.05,
                         .restitution = 0.3,
                         .cohesion = 0.01,
                         .cohesion_range = 1e-4};

/// Distance of two places, up to whole periods.
double apart(const PeriodicCell& cell, const Vec3& a, const Vec3& b) {
  const Vec3 d = a - b;
  return (d + cell.to_nearest(d)).norm();
}

bool in_cell(const PeriodicCell& cell, const Vec3& x) { return cell.wrapped(x) == x; }

TEST_P(Periodic, AFreeBallFliesAndRollsOnAcrossTheSeam) {
  struct Case {
    const char* name;
    Vec3 velocity;
    double height;
  };
  for (const Case& c : {Case{"flying", {0.7, 1.9, 4}, 0.5}, Case{"rolling", {-1.3, 0.9, 0}, 0.02}}) {
    const auto model = [&](bool periodic) {
      ModelBuilder builder;
      builder.material("m").law("m", "m", {.friction = 0.5}).floor("m");
      if (periodic) builder.periodic(0, -0.05, 0.07).periodic(1, 0.3, 0.45);
      builder.sphere("m", 0.02, {.position = {0, 0.4, c.height}, .velocity = c.velocity, .angular_velocity = {1, 2, 3}});
      return builder.build();
    };
    const Model cell_model = model(true);
    REPOSE_SKIP_UNSUPPORTED(cell_model);
    auto cell = simulation(cell_model, precise(1e-3)), open = simulation(model(false), precise(1e-3));
    double worst = 0, speed = 0;
    int inside = 0;
    for (int i = 0; i < 600; ++i) {
      cell.step();
      open.step();
      worst = std::max(worst, apart(cell_model.periodic, cell.position(1), open.position(1)) / 0.02);
      speed = std::max(speed, ((cell.velocity(1) - open.velocity(1)).norm() + 0.02 * (cell.spin(1) - open.spin(1)).norm()));
      inside += in_cell(cell_model.periodic, cell.position(1));
    }
    EXPECT_EQ(inside, 600);
    EXPECT_GT((open.position(1) - cell.position(1)).norm(), 0.3) << "it crossed";
    const std::string what = std::string("periodic cell, ball ") + c.name + " round it: ";
    expect_answer({what + "largest shift from the open run / R", 0, worst, 1e-11, 0, 1}, GetParam());
    expect_answer({what + "largest change of velocity [m/s]", 0, speed, 1e-12, 0, 1}, GetParam());
  }
}

/// Two grains that meet head-on, the first from below, around `middle`.
Model meeting(const Shape& a, const Shape& b, const Vec3& middle, unsigned seed) {
  Random random(seed, 0);
  const double size = 0.02, reach = size * (a.bounding_radius + b.bounding_radius);
  ModelBuilder builder;
  builder.material("m").law("m", "m", everything).gravity(Vec3::Zero()).periodic(0, -0.1, 0.1).periodic(1, 0, 0.25);
  const Vec3 along = Vec3(0.4, 1, 0.2).normalized();
  builder.body("m", a,
               {.position = middle - 0.52 * reach * along,
                .velocity = 0.5 * along,
                .angular_velocity = {3, -5, 8},
                .orientation = random.rotation()},
               size);
  builder.body("m", b,
               {.position = middle + 0.52 * reach * along + 0.003 * Vec3::UnitX(),
                .velocity = -0.5 * along,
                .angular_velocity = {1, 7, -2},
                .orientation = random.rotation()},
               size);
  return builder.build();
}

TEST_P(Periodic, ACollisionAcrossTheSeamIsThatInTheMiddle) {
  std::vector<Shape> shapes;
  for (const std::string& name : grain_shape_names()) shapes.push_back(make_grain_shape(name));
  const Vec3 middle(0.01, 0.12, 0.5), corner(0.1, 0.25, 0.5);
  double worst_speed = 0, worst_place = 0;
  int pairs = 0, met = 0;
  for (std::size_t a = 0; a < shapes.size(); ++a)
    for (std::size_t b = 0; b < shapes.size(); ++b, ++pairs) {
      const unsigned seed = static_cast<unsigned>(7 * a + b);
      const Model inside = meeting(shapes[a], shapes[b], middle, seed), across = meeting(shapes[a], shapes[b], corner, seed);
      REPOSE_SKIP_UNSUPPORTED(inside);
      auto one = simulation(inside, precise(5e-4)), two = simulation(across, precise(5e-4));
      double work = 0;
      bool seam = false;
      for (int i = 0; i < 100; ++i) {
        one.step();
        two.step();
        work += one.report().contact_work;
        seam = seam || (two.report().contacts > 0 && (two.position(0) - two.position(1)).norm() > 0.1);
      }
      met += work < -1e-6 && seam;
      for (int k = 0; k < 2; ++k) {
        worst_speed = std::max(worst_speed, (one.velocity(k) - two.velocity(k)).norm() / 0.5);
        worst_speed = std::max(worst_speed, 0.01 * (one.spin(k) - two.spin(k)).norm() / 0.5);
        worst_place =
            std::max(worst_place, apart(inside.periodic, one.position(k) - middle, two.position(k) - corner) / 0.01);
      }
    }
  EXPECT_GE(met, pairs - 5) << "of " << pairs;
  note("periodic cell, pairs of the seven shapes that met across the corner of the cell", met);
  expect_answer({"periodic cell, collision across the corner: change of velocities / v", 0, worst_speed, 1e-8, 0, 1},
                GetParam());
  expect_answer({"periodic cell, collision across the corner: shift / R", 0, worst_place, 1e-8, 0, 1}, GetParam());
}

// Equal balls that touch all around the cell; one is set in motion. Dead impacts: it drives those in front, the last of
// which is behind it, so that all share its momentum at once.
TEST_P(Periodic, AChainAroundTheCellMovesAsOne) {
  constexpr int n = 8;
  constexpr double d = 0.02, v = 0.4;
  ModelBuilder builder;
  builder.material("m").gravity(Vec3::Zero()).periodic(1, 0, n * d);
  for (int i = 0; i < n; ++i)
    builder.sphere("m", d / 2, {.position = {0, (i + 0.3) * d, 0}, .velocity = {0, i == 2 ? v : 0, 0}});
  const Model model = builder.build();
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, precise(1e-3));
  s.step();
  EXPECT_EQ(s.report().contacts, n);
  s.run(200);
  double worst = 0;
  for (int i = 0; i < n; ++i) worst = std::max(worst, std::abs(s.velocity(i).y() - v / n));
  expect_answer({"periodic cell, chain around it: speed [m/s]", v / n, v / n + worst, 1e-9}, GetParam());
}

/// Grains of all shapes that fly about in a full cell without gravity.
Model cloud(unsigned seed, int count) {
  Random random(seed, 0);
  FillRegion region;
  region.lower = {-0.08, 0.1, 0};
  region.upper = {0.12, 0.3, 0.2};
  PairLaw law = everything;
  law.cohesion = 0;
  ModelBuilder builder;
  builder.material("m").law("m", "m", law).gravity(Vec3::Zero()).periodic(0, -0.08, 0.12).periodic(1, 0.1, 0.3);
  const std::vector<double> radii(static_cast<std::size_t>(count), 0.017);
  int i = 0;
  for (const Placement& at : place_balls(region, radii, seed, {{-0.08, 0.1, 0}, {0.12, 0.3, 0}})) {
    const Shape shape = make_grain_shape(grain_shape_names()[static_cast<std::size_t>(i++ % 7)]);
    const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) - 12 * (at.position.z() - 0.1));
    builder.body("m", shape, {.position = at.position, .velocity = v, .orientation = at.orientation},
                 0.017 / shape.bounding_radius);
  }
  return builder.build();
}

TEST_P(Periodic, MomentumIsKept) {
  const Model model = cloud(3, 90);
  REPOSE_SKIP_UNSUPPORTED(model);
  auto s = simulation(model, precise(5e-4));
  const Vec3 first = momentum(s).linear;
  double scale = 0, worst = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) scale += model.bodies[i].mass * s.state().velocity[i].norm();
  int across = 0;
  s.run(400, [&](const Simulation& now) {
    worst = std::max(worst, (momentum(now).linear - first).norm() / scale);
    for (const Contact& c : now.contacts())
      across += c.force.norm() > 0 && (now.position(c.a) - now.position(c.b)).norm() > 0.1;
  });
  note("periodic cell, cloud of 90 grains of seven shapes: contacts with force across the seam", across);
  EXPECT_GT(across, 30);
  expect_answer({"periodic cell, cloud: change of momentum", 0, worst, 1e-13, 0, 1}, GetParam());
}

TEST_P(Periodic, AllGrainsShiftedByAThirdOfThePeriodMoveAsBefore) {
  const Model model = cloud(4, 90);
  REPOSE_SKIP_UNSUPPORTED(model);
  Model shifted = model;
  const Vec3 third(0.2 / 3, 0.2 / 3, 0);
  for (Vec3& x : shifted.initial.position) x = shifted.periodic.wrapped(x + third);
  auto one = simulation(model, precise(5e-4)), two = simulation(shifted, precise(5e-4));
  double place = 0, speed = 0;
  int contacts = 0;
  for (int i = 0; i < 150; ++i) {
    one.step();
    two.step();
    contacts += one.report().contacts;
    EXPECT_EQ(one.report().contacts, two.report().contacts) << "step " << i;
  }
  for (int b = 0; b < 90; ++b) {
    place = std::max(place, apart(model.periodic, one.position(b) + third, two.position(b)) / 0.01);
    speed = std::max(speed, (one.velocity(b) - two.velocity(b)).norm());
  }
  EXPECT_GT(contacts, 700);
  // A cloud forgets its start exponentially fast: rounding of 1e-16 grows with every collision.
  expect_answer({"periodic cell, cloud shifted by a third: shift / R after 150 steps", 0, place, 1e-7, 0, 1}, GetParam());
  expect_answer({"periodic cell, cloud shifted by a third: change of velocities [m/s]", 0, speed, 1e-6, 0, 1}, GetParam());
}

TEST_P(Periodic, AnImageOfAPostIsMetAndAPlateHasNoEdgeAtTheSeam) {
  const auto post = [](double place, bool periodic) {
    ModelBuilder builder;
    builder.material("m").law("m", "m", everything).gravity(Vec3::Zero());
    if (periodic) builder.periodic(1, 0, 0.3);
    return builder.wall("m", shape_of("post", Cylinder{0.03, 1}), {{0, place, 0}, Quat::Identity()})
        .sphere("m", 0.02, {.position = {0.01, 0.2, 0}, .velocity = {0, 1, 0.1}})
        .build();
  };
  const Model periodic = post(0.01, true);
  REPOSE_SKIP_UNSUPPORTED(periodic);
  auto cell = simulation(periodic, precise(1e-3)), open = simulation(post(0.31, false), precise(1e-3));
  cell.run(150);
  open.run(150);
  EXPECT_LT(open.velocity(1).y(), 0.5) << "it hit the post";
  expect_answer({"periodic cell, ball thrown back by the image of a post: change of velocity [m/s]", 0,
                 (cell.velocity(1) - open.velocity(1)).norm() + 0.02 * (cell.spin(1) - open.spin(1)).norm(), 1e-9, 0, 1},
                GetParam());

  // A box and an egg dropped on the seam, onto a plate that ends one diameter beyond it, and onto a half-space.
  const auto drop = [](bool plate) {
    ModelBuilder builder;
    builder.material("m").law("m", "m", {.friction = 0.4}).periodic(1, 0, 0.3);
    if (plate)
      builder.wall("m", shape_of("plate", Box{{1, 0.35, 0.1}}), {{0, 0.15, -0.1}, Quat::Identity()});
    else
      builder.floor("m");
    return builder
        .body("m", shape_of("egg", Ellipsoid{{0.02, 0.03, 0.015}}),
              {.position = {0.1, 0.299, 0.05}, .velocity = {0, 0.3, 0}, .orientation = turn(0.7, {1, 0, 0})})
        .body("m", shape_of("twin", make_grain_shape("twin").parts.front().primitive),
              {.position = {-0.2, 0.001, 0.02}, .velocity = {0, -0.4, 0}}, 0.04)
        .build();
  };
  auto on_plate = simulation(drop(true), precise(1e-3)), on_floor = simulation(drop(false), precise(1e-3));
  on_plate.run(250);
  on_floor.run(250);
  double worst = 0;
  for (int b = 1; b <= 2; ++b)
    worst = std::max(worst, (on_plate.velocity(b) - on_floor.velocity(b)).norm() + (on_plate.position(b) - on_floor.position(b)).norm());
  expect_answer({"periodic cell, grains on a plate and on a half-space across the seam: difference [SI]", 0, worst, 1e-8, 0, 1},
                GetParam());
}

// A pile carried through the seam by a belt: contacts keep their impulses, so no step costs more than another.
TEST_P(Periodic, WarmStartSurvivesTheCrossing) {
  const auto carried = [](bool periodic) {
    ModelBuilder builder;
    builder.material("m").law("m", "m", {.friction = 0.6, .rolling_friction = 0.1});
    if (periodic) builder.periodic(1, 0, 0.2);
    builder.wall("m", shape_of("belt", HalfSpace{}), {}, {.velocity = {0, 0.5, 0}});
    // A pyramid of 30 touching balls.
    const double d = 0.02;
    for (int layer = 0; layer < 4; ++layer)
      for (int i = 0; i < 4 - layer; ++i)
        for (int j = 0; j < 4 - layer; ++j)
          builder.sphere("m", d / 2,
                         {.position = d * Vec3(i + 0.5 * layer, j + 0.5 * layer + 2, 0.5 + layer / std::numbers::sqrt2),
                          .velocity = {0, 0.5, 0}});
    return builder.build();
  };
  const Model model = carried(true);
  REPOSE_SKIP_UNSUPPORTED(model);
  SolverOptions options = usual(1e-3, 1e-7);
  options.max_iterations = 20000;
  const auto iterations = [&](const Model& m, const SolverOptions& o) {
    Simulation s(GetParam(), m, o);
    s.run(60);
    int sum = 0;
    s.run(500, [&](const Simulation& now) { sum += now.report().iterations; });
    return sum / 500.0;
  };
  SolverOptions cold = options;
  cold.warm_start = false;
  const double through = iterations(model, options), open = iterations(carried(false), options);
  const double without = iterations(model, cold);
  note("pile carried through the seam: iterations per step, open space", open);
  note("pile carried through the seam: iterations per step, periodic", through);
  note("pile carried through the seam: iterations per step, periodic, cold", without);
  EXPECT_LE(through, open + 0.02 * (without - open)) << "a crossing would cost a cold step";
  EXPECT_GT(without, 5 * open + 5);
}

/// Touching grains in a cell that they fill from side to side, knocked about.
Model knocked_bed() {
  const double d = 0.02;
  Random random(2, 0);
  ModelBuilder builder;
  builder.material("m").law("m", "m", everything).periodic(0, 0, 10 * d).periodic(1, 0, 10 * d).floor("m");
  for (int i = 0; i < 800; ++i) {
    const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    builder.sphere("m", d / 2, {.position = d * Vec3(i % 10, i / 10 % 10, i / 100 + 0.5), .velocity = 0.2 * v});
  }
  return builder.build();
}

TEST_P(Periodic, ThreadsAndCheckpointsGiveTheSameBytesAndScalesTheSameBits) {
  if (GetParam() != "dvi") GTEST_SKIP() << "promised by DVI alone";
  const Model model = knocked_bed();
  SolverOptions options = usual(1e-3);
  options.max_iterations = 20;
  auto one = simulation(model, options), saved = simulation(model, options), resumed = simulation(model, options);
  const double length = 0x1p-14, time = 0x1p-7;
  SolverOptions fast = options;
  fast.time_step *= time;
  auto small = simulation(froude_scaled(model, length), fast);
  options.threads = 2;
  auto two = simulation(model, options);
  int wrapped = 0, fewest = 1 << 30;
  saved.run(15);
  Frame frame;
  saved.world().save(frame);
  for (int i = 0; i < 40; ++i) {
    const Snapshot before = one.state();
    one.step();
    two.step();
    small.step();
    fewest = std::min(fewest, one.report().contacts);
    for (std::size_t b = 1; b < model.bodies.size(); ++b) {
      wrapped += (one.state().position[b] - before.position[b]).norm() > 0.1;
      ASSERT_TRUE(in_cell(model.periodic, one.state().position[b]));
    }
  }
  resumed.restore(frame);
  resumed.run(25);
  EXPECT_GT(wrapped, 20);
  EXPECT_GT(fewest, 1000);
  note("periodic bed of 800 grains: bodies wrapped in 40 steps", wrapped);
  EXPECT_TRUE(same_state(one.state(), two.state()));
  EXPECT_TRUE(same_state(one.state(), resumed.state()));
  long different = 0;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    different += one.state().position[b] * length != small.state().position[b];
    different += one.state().velocity[b] * (length / time) != small.state().velocity[b];
    different += one.state().angular_velocity[b] / time != small.state().angular_velocity[b];
  }
  EXPECT_EQ(different, 0);
}

}  // namespace
}  // namespace repose::test
