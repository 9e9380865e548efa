#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "analysis/diagnosis/calibrated_constant.hpp"
#include "analysis/diagnosis/horizon.hpp"
#include "analysis/diagnosis/problem.hpp"
#include "analysis/diagnosis/start_values.hpp"
#include "core/error.hpp"
#include "core/yaml_tree.hpp"
#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

constexpr double degree = 0.017453292519943295;

/// A history of the ball at given positions and orientations, a step apart.
History path(const std::vector<Vec3>& position, double step, const Quat& orientation = Quat::Identity()) {
  History h;
  BodyTrack& track = h.bodies["ball"];
  for (std::size_t i = 0; i < position.size(); ++i) {
    h.time.push_back(static_cast<double>(i) * step);
    track.position.push_back(position[i]);
    track.orientation.push_back(orientation);
    const std::size_t a = i == 0 ? 0 : i - 1, b = i == 0 ? 1 : i;
    track.velocity.emplace_back((position[b] - position[a]) / step);
    track.spin.emplace_back(0, 0, 0);
  }
  return h;
}

Channel channel(const std::string& observable, int axis, const std::vector<double>& time, Eigen::Index first) {
  Channel c;
  c.observable = observable;
  c.body = "ball";
  c.axis = axis;
  c.time = time;
  for (std::size_t i = 0; i < time.size(); ++i) c.at.push_back(i);
  c.first = first;
  return c;
}

/// The ball moves with v from x0; the recording holds `recorded(t)` at `time`.
class Recorded : public ::testing::Test {
 protected:
  const Vec3 x0{1, 2, 3}, v{0.5, -1, 2};
  const std::vector<double> time{0.2, 0.4, 0.6};
  Vec3 truth(double t) const { return x0 + t * v; }
  History history() const {
    std::vector<Vec3> x;
    for (int i = 0; i <= 100; ++i) x.push_back(truth(0.01 * i));
    return path(x, 0.01);
  }
  template <class F>
  Eigen::VectorXd residual(F&& recorded, const Measurement& m) const {
    BundleRun run;
    Observation o;
    o.body = "ball";
    o.time = time;
    for (const double t : time) o.position.push_back(recorded(t));
    run.observations = {o};
    const std::vector<Channel> channels{channel("position", 0, time, 0), channel("position", 1, time, 3), channel("position", 2, time, 6)};
    return difference(history(), run, channels, m);
  }
};

TEST_F(Recorded, LengthsAreTrueOnesTimesAFactor) {
  Measurement m;
  m.length = 1.1;
  EXPECT_LT(residual([&](double t) { return Vec3(1.1 * truth(t)); }, m).norm(), 1e-12);
  EXPECT_GT(residual([&](double t) { return truth(t); }, m).norm(), 0.1);
}

TEST_F(Recorded, TimesAreTrueOnesTimesAFactorPlusAnOffset) {
  Measurement m;
  m.time = 1.25;
  m.offset = 0.05;
  EXPECT_LT(residual([&](double t) { return truth((t - 0.05) / 1.25); }, m).norm(), 1e-12);
}

TEST_F(Recorded, AxesAreTurnedAgainstTheWorlds) {
  Measurement m;
  m.tilt_y = 10;
  // The recording's z axis leans towards the world's x: what lies along the world's z has a negative part along the recorded x.
  const double c = std::cos(10 * degree), s = std::sin(10 * degree);
  const auto turned = [&](double t) { return Vec3(c * truth(t).x() - s * truth(t).z(), truth(t).y(), s * truth(t).x() + c * truth(t).z()); };
  EXPECT_LT(residual(turned, m).norm(), 1e-12);
}

TEST_F(Recorded, OrientationsTurnWithTheAxes) {
  Measurement m;
  m.tilt_x = 20;
  const Quat q(Eigen::AngleAxisd(0.3, Vec3::UnitZ()));
  BundleRun run;
  Observation o;
  o.body = "ball";
  o.time = {0.01};
  o.position = {Vec3::Zero()};
  o.orientation = {Quat(Eigen::AngleAxisd(-20 * degree, Vec3::UnitX())) * q};
  run.observations = {o};
  const History h = path({Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, 0.01, q);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(difference(h, run, {channel("orientation", k, {0.01}, 0)}, m)[0], 0, 1e-12);
  EXPECT_NEAR(difference(h, run, {channel("orientation", 0, {0.01}, 0)}, {})[0], 20 * degree, 1e-12);
}

TEST_F(Recorded, SeriesHaveTheirBiasAndScaleWithLengthAndTime) {
  BundleRun run;
  Observation o;
  o.kind = ObservableKind::series;
  o.name = "speed";
  o.body = "ball";
  o.time = time;
  Measurement m;
  m.length = 1.2;
  m.time = 0.8;
  m.bias[0] = 0.3;
  o.value.assign(3, v.norm() * 1.2 / 0.8 + 0.3);
  run.observations = {o};
  EXPECT_LT(difference(history(), run, {channel("speed", 0, time, 0)}, m).norm(), 1e-12);
}

TEST(StartValues, AreReadOffTheFirstSamples) {
  const Bundle bundle = flights({.noise = 1e-4, .rate = 100});
  const std::vector<Parameter> start = start_values(bundle.runs[1], parse_yaml(bundle.scene.text, "scene"), {{"position", 1e-4}});
  ASSERT_EQ(start.size(), 3u);
  const Vec3 v(2, 1, 3);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(start[static_cast<std::size_t>(k)].key, "bodies.ball.velocity");
    EXPECT_EQ(start[static_cast<std::size_t>(k)].component, k);
    // Slope of a parabola through ten samples 0.01 s apart: its standard error is some 0.01 m/s.
    EXPECT_NEAR(start[static_cast<std::size_t>(k)].start, v[k], 0.04);
    EXPECT_GT(start[static_cast<std::size_t>(k)].step, 0);
  }
}

TEST(StartValues, AlongAnAxisOnWhichNothingMovesAreNarrow) {
  Bundle bundle = flights({.velocities = {{2, 0, 3}, {2, 1, 3}}, .noise = 1e-4, .rate = 100});
  const auto read = [&](std::size_t run) { return start_values(bundle.runs[run], parse_yaml(bundle.scene.text, "scene"), {{"position", 1e-4}}); };
  const std::vector<Parameter> straight = read(0);
  ASSERT_EQ(straight.size(), 3u);
  EXPECT_NEAR(straight[1].start, 0, 2e-3) << "of all sixty samples";
  EXPECT_NEAR(straight[1].upper - straight[1].start, 0.3, 0.03) << "a tenth of the fastest";
  EXPECT_NEAR(straight[1].start - straight[1].lower, 0.3, 0.03);
  for (const int k : {0, 2}) EXPECT_GT(straight[static_cast<std::size_t>(k)].upper, 1e100) << "what moves may have slid, or been hit, before the first samples";
  EXPECT_GT(read(1)[1].upper, 1e100);
}

TEST(StartValues, ASpinThatOnlyThePathShowsBeginsAsTheSceneHasIt) {
  Bundle bundle = flights({});
  bundle.runs[0].free = {"bodies.ball.angular_velocity"};
  bundle.runs[0].observations[0].orientation.clear();
  YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  set_path(tree, "bodies.ball.angular_velocity", "[0, 30, 0]");
  const std::vector<Parameter> start = start_values(bundle.runs[0], tree, {});
  if (!path_shows_spin(bundle.scene)) {
    EXPECT_TRUE(start.empty()) << "a ball alone in still air";
    set_path(tree, "bodies.floor", "{shape: ball, material: foam, fixed: true, position: [0, 0, -9]}");
  }
  const std::vector<Parameter> beside = start_values(bundle.runs[0], tree, {});
  ASSERT_EQ(beside.size(), 3u);
  EXPECT_EQ(beside[1].start, 30);
  EXPECT_GT(beside[1].prior_sd, 29);
  EXPECT_GT(beside[1].step, 0);
}

TEST(StartValues, ContradictTheSceneWhereAxesWereExchanged) {
  Bundle bundle = flights({.noise = 1e-4, .rate = 100});
  const YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  YamlNode told = tree;
  set_path(told, "bodies.ball.velocity", "[2, 1, 3]");
  EXPECT_TRUE(contradictions(start_values(bundle.runs[1], told, {{"position", 1e-4}})).empty());
  set_path(told, "bodies.ball.velocity", "[3, 1, -2]");
  const std::vector<StartContradiction> found = contradictions(start_values(bundle.runs[1], told, {{"position", 1e-4}}));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].key, "bodies.ball.velocity");
  EXPECT_NEAR(found[0].read.z(), 3, 0.01);
  EXPECT_EQ(found[0].told.z(), -2);
  set_path(told, "bodies.ball.velocity", "[0, 0, 0]");
  EXPECT_TRUE(contradictions(start_values(bundle.runs[1], told, {{"position", 1e-4}})).empty()) << "zero says nothing";
}

TEST(StartValues, AComponentThatTheSceneStatesIsFreeOnce) {
  Bundle bundle = flights({});
  bundle.runs[0].free = {"bodies.ball.velocity.2"};
  YamlNode tree = parse_yaml(bundle.scene.text, "scene");
  set_path(tree, "bodies.ball.velocity", "[1, 2, 3]");
  const std::vector<Parameter> start = start_values(bundle.runs[0], tree, {});
  ASSERT_EQ(start.size(), 1u);
  EXPECT_EQ(start[0].key, "bodies.ball.velocity");
  EXPECT_EQ(start[0].component, 2);
}

TEST(CalibratedConstant, HasTheLibrarysBoundsOrThoseAboutItsValue) {
  const YamlNode scene = parse_yaml("gravity: [0, 0, -9.81]\neffects: {linear_drag: {viscosity: 1.8e-5}}\nbodies: {ball: {mass: 0}}\n", "scene");
  const NaturalScale scale{0.01, 0.001, 0.03};
  const Parameter viscosity = calibrated_constant("effects.linear_drag.viscosity", scene, scale);
  EXPECT_TRUE(viscosity.logarithmic);
  EXPECT_EQ(viscosity.unit, "Pa s");
  EXPECT_EQ(calibrated_constant("pairs.a-b.friction", scene, scale).upper, calibrated_constant("pairs.b-c.friction", scene, scale).upper);
  const Parameter gravity = calibrated_constant("gravity.2", scene, scale);
  EXPECT_EQ(gravity.start, -9.81);
  EXPECT_LT(gravity.lower, -9.81);
  EXPECT_LT(gravity.upper, 0);
  EXPECT_FALSE(gravity.logarithmic);
  EXPECT_THROW(calibrated_constant("bodies.ball.mass", scene, scale), Error);
}

TEST(StartValues, OfABodySeenThroughASeriesBeginWhereTheSceneStartsIt) {
  Bundle bundle = flights({});
  BundleRun& run = bundle.runs[0];
  run.free = {"bodies.ball.position.2"};
  Observation height;
  height.kind = ObservableKind::series;
  height.name = "height";
  height.body = "ball";
  run.observations = {height};
  const std::vector<Parameter> start = start_values(run, parse_yaml(bundle.scene.text, "scene"), {});
  ASSERT_EQ(start.size(), 1u);
  EXPECT_EQ(start[0].key, "bodies.ball.position");
  EXPECT_EQ(start[0].component, 2);
  EXPECT_EQ(start[0].start, 10);
  EXPECT_GT(start[0].step, 0);
}

TEST(StartValues, AreAsFreeWhereEveryOtherSampleIsMissing) {
  Bundle bundle = flights({});
  std::vector<Vec3>& position = bundle.runs[0].observations[0].position;
  for (std::size_t i = 1; i < position.size(); i += 2) position[i].setConstant(NAN);
  const std::vector<Parameter> start = start_values(bundle.runs[0], parse_yaml(bundle.scene.text, "scene"), {{"position", 1e-9}});
  ASSERT_EQ(start.size(), 3u);
  // Three tenths of the fastest that was seen: the ball falls at -0.0 to 3.9 m/s and flies at 3 m/s.
  EXPECT_GT(start[0].prior_sd, 0.3 * 3);
}

TEST(StartValues, OfAnAxisThatWasNotObservedAreNotFree) {
  Bundle bundle = flights({});
  for (Vec3& x : bundle.runs[0].observations[0].position) x.y() = NAN;
  const std::vector<Parameter> start = start_values(bundle.runs[0], parse_yaml(bundle.scene.text, "scene"), {});
  ASSERT_EQ(start.size(), 2u);
  EXPECT_EQ(start[0].component, 0);
  EXPECT_EQ(start[1].component, 2);
}

TEST(Layout, HoldsCalibratedConstantsThenTermsThenStartsThenOwnParameters) {
  Bundle bundle = flights({});
  bundle.calibrate = {"pairs.foam-stone.friction"};
  const Problem problem(bundle, all(bundle), fly);
  const Layout layout = problem.layout({{{find_effect("quadratic_drag"), ""}, {find_effect("time_offset"), ""}}});
  ASSERT_EQ(layout.shared.size(), 2u);  // the fluid's density is held: only its product with the coefficient can be seen
  EXPECT_EQ(layout.shared[0].key, "pairs.foam-stone.friction");
  EXPECT_EQ(layout.shared[0].start, 0.5);
  EXPECT_EQ(layout.shared[1].key, "effects.quadratic_drag.coefficient");
  ASSERT_EQ(layout.per_run.size(), 4u);
  ASSERT_EQ(layout.per_run[0].size(), 4u);
  EXPECT_EQ(layout.per_run[0][3].use, Parameter::Use::time_offset);
}

TEST(Layout, ABiasMayBeAllThatASensorReads) {
  // An accelerometer in free flight reads zero: with a bias, that and little noise.
  Observation o;
  o.kind = ObservableKind::series;
  o.name = "specific_force";
  o.body = "ball";
  o.unit = "m/s^2";
  o.time = {0, 0.1, 0.2};
  o.value = {-0.45, NAN, -0.47};
  const TermParameters bias = parameters_of({find_effect("sensor_bias"), ""}, {}, {Observation{}, o});
  ASSERT_EQ(bias.per_run.size(), 1u);
  EXPECT_EQ(bias.per_run[0].component, 1);
  EXPECT_LT(bias.per_run[0].lower, -0.5);
  EXPECT_GT(bias.per_run[0].upper, 0.5);
}

TEST(Layout, ScenesHoldTheValues) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), fly);
  const Layout layout = problem.layout({{{find_effect("uniform_force"), ""}}});
  Values shared(3), own(3);
  shared << 0.001, 0.002, -0.003;
  own << 1, 2, 3;
  const Scene scene = read_scene(problem.scene(layout, 2, shared, own), "scene");
  ASSERT_EQ(scene.effects.size(), 1u);
  EXPECT_EQ(std::get<UniformForce>(scene.effects[0]).force, Vec3(0.001, 0.002, -0.003));
  EXPECT_EQ(scene.bodies[0].velocity, Vec3(1, 2, 3));
}

TEST(Layout, TheExtendedSceneHasThePhysicsAndNoRunsStart) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), fly);
  Values shared(1);
  shared << 0.47;
  const Scene scene = read_scene(problem.extended_scene(problem.layout({{{find_effect("quadratic_drag"), ""}}}), shared), "scene");
  ASSERT_EQ(scene.effects.size(), 1u);
  EXPECT_EQ(std::get<QuadraticDrag>(scene.effects[0]).coefficient, 0.47);
  EXPECT_EQ(scene.bodies[0].velocity, Vec3(1, 0, 0));
}

TEST(Problem, ResidualsAreInUnitsOfTheNoise) {
  Bundle bundle = flights({.noise = 0});
  bundle.noise["position"] = 0.01;
  const Problem problem(bundle, all(bundle), fly);
  const Layout layout = problem.layout({});
  Values own(3);
  own << 3, 0, 2;
  EXPECT_LT(problem.residual(layout, 0, Values(0), own).norm(), 1e-6);
  own.x() += 0.1;
  const Eigen::VectorXd r = problem.residual(layout, 0, Values(0), own);
  const Channel& x = problem.runs()[0].channels[0];
  for (std::size_t i = 0; i < x.time.size(); ++i) EXPECT_NEAR(r[x.first + static_cast<Eigen::Index>(i)], 0.1 * x.time[i] / 0.01, 1e-6);
}

TEST(Problem, SolvesToSecondOrderAndAllowsForTheStepOfWhoeverMadeTheRecordings) {
  Bundle bundle = flights({.noise = 0});
  bundle.noise["position"] = 0.001;
  const Problem problem(bundle, all(bundle), fly_late_by(1));
  EXPECT_TRUE(problem.numerics().second_order);
  EXPECT_TRUE(problem.layout({}).numerics.second_order);
  // Along x 10 mm/s too much from the middle on, in mm; another start imitates the larger part of it.
  double squares = 0, start_squares = 0, products = 0, count = 0;
  for (const double t : bundle.runs[0].observations[0].time) {
    const double error = std::max(0.0, t - 0.3) / 0.1;
    squares += error * error;
    start_squares += t * t;
    products += t * error;
    count += 3;
  }
  const double error = std::sqrt((squares - products * products / start_squares) / count);
  EXPECT_NEAR(problem.noise().at("position").sd, 0.001 * std::hypot(1, 0.25 * error), 1e-8);
  EXPECT_NEAR(problem.scene_error().at("position"), error / std::hypot(1, 0.25 * error), 1e-5);
}

TEST(Problem, StepsMoreCoarselyThanTheSceneWhereThatDoesNotShow) {
  Bundle bundle = flights({});
  std::string finely = ball_scene();
  finely.replace(finely.find("1.0e-2"), 6, "2.0e-4");
  const auto factor = [&](const std::string& scene, const Simulate& engine) {
    bundle.scene = parse_scene(scene, "nominal");
    return Problem(bundle, all(bundle), engine).numerics().step_factor;
  };
  const Simulate late = [](const SimulationRequest& request) {  // an error in proportion to the step in second order, too
    History history = fly(request);
    for (std::size_t i = 0; i < history.time.size(); ++i)
      history.bodies["ball"].position[i].x() += 20 * request.scene->solver.time_step * std::max(0.0, history.time[i] - 0.3);
    return history;
  };
  EXPECT_EQ(factor(finely, fly), 8);
  EXPECT_EQ(factor(finely, late), 1);
  EXPECT_EQ(factor(ball_scene(), fly), 1) << "as coarse as it may be";
}

TEST(Problem, LooksForNoForceFasterThanTheSamplesShow) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), fly);
  const Channel& c = problem.runs()[0].channels[0];
  const double usual = (c.time.back() - c.time.front()) / static_cast<double>(c.time.size() - 1);
  double upper = 0;
  for (const Parameter& p : problem.layout({{{find_effect("periodic_force"), ""}}}).shared)
    if (p.key.ends_with(".frequency")) upper = p.upper;
  EXPECT_NEAR(upper * usual, 0.5, 0.05);
}

TEST(Problem, StaysWithTheScenesOwnWayWhereTheBackendHasNoOther) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), [](const SimulationRequest& request) -> History {
    if (request.scene->solver.integration == Integration::second_order) throw Error("solver.integration", "not here", "");
    return fly(request);
  });
  EXPECT_FALSE(problem.numerics().second_order);
  EXPECT_TRUE(problem.scene_error().empty());
  Values own(3);
  own << 3, 0, 2;
  EXPECT_EQ(problem.residual(problem.layout({}), 0, Values(0), own).size(), problem.runs()[0].size);
}

TEST(Horizon, ReachesFurtherOnceStartValuesAreFitted) {
  // From 0.3 s on the path has a kink in the start's velocity, as an impact has that comes earlier or later.
  const Bundle bundle = flights({});
  const Simulate kinked = [](const SimulationRequest& request) {
    History history = fly(request);
    const double off = std::abs(request.scene->bodies[0].velocity.z() - 2);
    for (std::size_t i = 0; i < history.time.size(); ++i) history.bodies["ball"].position[i].z() += 10 * off * std::max(0.0, history.time[i] - 0.3);
    return history;
  };
  Problem problem(bundle, {0}, kinked);
  const double before = problem.runs()[0].horizon, read = problem.runs()[0].start[2].begin();
  EXPECT_GE(before, 0.3);
  ASSERT_LT(before, 0.5);
  follow_further(problem, {});
  EXPECT_GT(problem.runs()[0].horizon, 1.05 * before);
  EXPECT_NEAR(problem.runs()[0].start[2].start, 2, 0.01);
  // Other physics than the nominal's begin where the data say, not where the nominal fit was led.
  EXPECT_NE(problem.runs()[0].start[2].start, read);
  EXPECT_EQ(problem.runs()[0].start[2].begin(), read);
}

TEST(Problem, AFailedSimulationIsNoPointAtAll) {
  const Bundle bundle = flights({});
  const Problem problem(bundle, all(bundle), [](const SimulationRequest& request) -> History {
    if (request.scene->bodies[0].velocity.x() > 10) throw Error("", "exploded", "", Error::Kind::simulation);
    return fly(request);
  });
  const Layout layout = problem.layout({});
  Values own(3);
  own << 11, 0, 0;
  EXPECT_EQ(problem.residual(layout, 0, Values(0), own).size(), 0);
  own << 3, 0, 2;
  EXPECT_EQ(problem.residual(layout, 0, Values(0), own).size(), problem.runs()[0].size);
}

TEST(Problem, AsksForASimulationOnce) {
  const Bundle bundle = flights({});
  SimulationStore store;
  const Problem first(bundle, all(bundle), fly, &store);
  const Layout layout = first.layout({});
  Values own(3);
  own << 3, 0, 2.5;
  const Eigen::VectorXd r = first.residual(layout, 0, Values(0), own);
  const std::size_t before = first.simulations();
  EXPECT_EQ(first.residual(layout, 0, Values(0), own), r);
  EXPECT_EQ(first.simulations(), before);
  const Problem second(bundle, all(bundle), fly, &store);
  EXPECT_EQ(second.residual(layout, 0, Values(0), own), r);
  EXPECT_EQ(second.simulations(), 0u);
}

TEST(Problem, WithNothingToCompareIsRefused) {
  Bundle bundle = flights({});
  for (Vec3& x : bundle.runs[0].observations[0].position) x.setConstant(NAN);
  EXPECT_THROW(Problem(bundle, {0}, fly), Error);
}

class StoreFile : public ::testing::Test {
 protected:
  const std::filesystem::path file = std::filesystem::temp_directory_path() /
                                     ("repose-store-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
  void TearDown() override { std::filesystem::remove(file); }
  void fill(SimulationStore& store) const {
    store.add(1, Eigen::VectorXd::LinSpaced(5, 0, 1));
    store.add(2, {});
    store.save();
  }
};

TEST_F(StoreFile, ReadsBackWhatItWrote) {
  SimulationStore store(file, "dvi");
  fill(store);
  SimulationStore again(file, "dvi");
  EXPECT_EQ(again.find(1), Eigen::VectorXd(Eigen::VectorXd::LinSpaced(5, 0, 1)));
  ASSERT_TRUE(again.find(2).has_value());
  EXPECT_EQ(again.find(2)->size(), 0);
  EXPECT_FALSE(again.find(3).has_value());
}

TEST_F(StoreFile, OfAnotherBuildIsLeftAside) {
  SimulationStore store(file, "dvi");
  fill(store);
  EXPECT_EQ(SimulationStore(file, "bullet").size(), 0u);
}

TEST_F(StoreFile, DamageIsLeftAside) {
  SimulationStore store(file, "dvi");
  fill(store);
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(50).put('x');
  EXPECT_EQ(SimulationStore(file, "dvi").size(), 0u);
  std::filesystem::resize_file(file, 30);
  EXPECT_EQ(SimulationStore(file, "dvi").size(), 0u);
}

TEST_F(StoreFile, StaysWithinItsBoundAndKeepsWhatIsInUse) {
  SimulationStore store(file, "dvi", 2000);
  for (std::uint64_t i = 0; i < 10; ++i) store.add(i, Eigen::VectorXd::Constant(20, static_cast<double>(i)));
  store.save();
  SimulationStore again(file, "dvi", 2000);
  EXPECT_LE(std::filesystem::file_size(file), 2100u);
  ASSERT_GT(again.size(), 5u);
  again.add(77, Eigen::VectorXd::Constant(200, 1.0));
  again.save();
  EXPECT_TRUE(SimulationStore(file, "dvi").find(77).has_value());
}

}  // namespace
}  // namespace repose::diagnosis
