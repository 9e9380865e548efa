#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "analysis/bundle/csv_table.hpp"
#include "analysis/bundle/read_bundle.hpp"
#include "analysis/bundle/sensor.hpp"
#include "analysis/bundle/write_bundle.hpp"
#include "core/error.hpp"
#include "tests/unit/dropped_ball.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test.
class BundleFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() /
             ("repose-bundle-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    write("nominal.yaml", dropped_ball_scene);
    write("a.csv", "time,body,x,y,z\n0,ball,0,,1\n0.1,ball,0.03,,0.95\n0.2,ball,,,\n");
    write("recording.yaml", yaml());
  }
  void TearDown() override { fs::remove_all(folder); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
  static std::string yaml(const std::string& run = "", const std::string& top = "") {
    return "title: Test\nscene: nominal.yaml\n" + top + "runs:\n  - id: a\n" + run +
           "    observables: [{kind: trajectory, body: ball, file: a.csv}]\n";
  }
  /// The message of the refusal; "" if the bundle is accepted.
  std::string refusal() const {
    try {
      read_bundle(folder);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  void expect_refusal(const std::string& place, const std::string& remedy) const {
    const std::string message = refusal();
    EXPECT_NE(message.find(place), std::string::npos) << message;
    EXPECT_NE(message.find(remedy), std::string::npos) << message;
  }
  fs::path folder;
};

TEST_F(BundleFolder, EmptyFieldsAreNotObserved) {
  const Bundle bundle = read_bundle(folder);
  const Observation& o = bundle.runs.at(0).observations.at(0);
  ASSERT_EQ(o.time.size(), 3U);
  EXPECT_DOUBLE_EQ(o.position[1].x(), 0.03);
  EXPECT_TRUE(std::isnan(o.position[1].y()));
  EXPECT_TRUE(o.position[2].array().isNaN().all());
  EXPECT_TRUE(o.orientation.empty());
}

TEST_F(BundleFolder, KeepsWhatTheExperimenterSaid) {
  write("recording.yaml",
        yaml("    set: {bodies.ball.velocity: [1, 0, 0]}\n    free: [bodies.ball.position]\n    held_out: true\n",
             "calibrate: [pairs.steel-steel.friction]\nnoise: {position: 1 mm}\n") +
            "  - id: b\n    observables: [{kind: scalar, name: angle_of_repose, value: 32.93, sd: 1.15, unit: deg}]\n");
  const Bundle bundle = read_bundle(folder);
  EXPECT_EQ(bundle.runs.at(0).set.at(0).path, "bodies.ball.velocity");
  EXPECT_EQ(bundle.runs.at(0).free.at(0), "bodies.ball.position");
  EXPECT_TRUE(bundle.runs.at(0).held_out);
  EXPECT_DOUBLE_EQ(bundle.noise.at("position"), 1e-3);
  EXPECT_DOUBLE_EQ(bundle.runs.at(1).observations.at(0).scalar, 32.93);
}

TEST_F(BundleFolder, AWindowDropsSamplesAndCountsFromItsBeginning) {
  write("a.csv", "time,body,x,y,z\n0,ball,0,,1\n0.1,ball,0.03,,0.95\n0.2,ball,0.06,,0.8\n0.3,ball,0.09,,0.6\n");
  write("recording.yaml", yaml("    from: 50 ms\n    until: 0.25\n"));
  const Bundle bundle = read_bundle(folder);
  const Observation& o = bundle.runs[0].observations[0];
  EXPECT_EQ(bundle.runs[0].from, 0.05);
  ASSERT_EQ(o.time.size(), 2u);
  EXPECT_DOUBLE_EQ(o.time[0], 0.05);
  EXPECT_DOUBLE_EQ(o.time[1], 0.15);
  EXPECT_EQ(o.position[1].z(), 0.8);
  ASSERT_EQ(o.position.size(), 2u);

  write("recording.yaml", yaml("    from: 0.2\n    until: 0.1\n"));
  expect_refusal("until", "later than `from`");
  write("recording.yaml", yaml("    from: 0.25\n"));
  expect_refusal("from", "two samples");
}

/// A body that moves smoothly but for a kink at 0.3 s.
std::string kinked() {
  std::string text = "time,body,x,y,z\n";
  for (int i = 0; i <= 60; ++i) {
    const double t = 0.01 * i, x = t < 0.3 ? t : 0.3 - 2 * (t - 0.3);
    text += std::to_string(t) + ",ball," + std::to_string(x) + ",,1\n";
  }
  return text;
}

TEST_F(BundleFolder, WindowsHoldEverySampleOnceAndBeginWhereThePathIsSmooth) {
  write("a.csv", kinked());
  const std::string twin =
      "  - id: b\n    held_out: true\n    free: [bodies.ball.velocity]\n"
      "    observables: [{kind: trajectory, body: ball, file: a.csv}]\n";
  write("recording.yaml", yaml("    free: [bodies.ball.velocity]\n", "windows: 0.2 s\n") + twin);
  const Bundle bundle = read_bundle(folder);
  ASSERT_EQ(bundle.runs.size(), 6u);
  EXPECT_EQ(bundle.runs[0].id, "a@0.000");
  EXPECT_EQ(bundle.runs[3].id, "b@0.000");
  std::size_t samples = 0;
  for (const BundleRun& window : bundle.runs) {
    EXPECT_EQ(window.held_out, window.id[0] == 'b');
    EXPECT_EQ(window.observations[0].time.front(), 0);
    samples += window.observations[0].time.size();
    EXPECT_FALSE(window.from > 0.235 && window.from < 0.295) << window.from;
  }
  EXPECT_EQ(samples, 2 * 61u);
  EXPECT_EQ(bundle.runs[0].from, 0);

  write("recording.yaml", yaml("", "windows: 0.2 s\n"));
  expect_refusal("runs", "free");
  write("recording.yaml", yaml("    free: [bodies.ball.velocity]\n", "windows: 0.2 s\n"));
  expect_refusal("windows", "held_out");
}

TEST_F(BundleFolder, StartValuesMayBeComponentsAndNumbers) {
  write("recording.yaml", yaml("    free: [bodies.ball.velocity.2, shapes.ball.radius, bodies.ball.orientation]\n"));
  EXPECT_EQ(read_bundle(folder).runs[0].free.size(), 3u);
  write("recording.yaml", yaml("    free: [bodies.ball.speed.2]\n"));
  EXPECT_NE(refusal(), "");
}

TEST_F(BundleFolder, RefusesWithPlaceAndRemedy) {
  EXPECT_EQ(refusal(), "");
  const auto with_csv = [&](const std::string& text) { write("a.csv", text); };
  const auto with_yaml = [&](const std::string& text) {
    write("a.csv", "time,body,x,y,z\n0,ball,0,,1\n0.1,ball,0.03,,0.95\n");
    write("recording.yaml", text);
  };
  with_csv("time,body,x,y,z\n0,ball,0,,1\n0.1,ball,0.03,,0.95\n0.05,ball,1,,2\n");
  expect_refusal("a.csv:4: column `time`", "ascend");
  with_csv("time,body,x,y,z\n0,ball,0,,1\n0.1,ball,nan,,0.95\n");
  expect_refusal("a.csv:3: column `x`", "leave the field empty");
  with_csv("time,body,x,y,z\n0,ball,0,,1\n0.1,ball,0.03 m,,0.95\n");
  expect_refusal("a.csv:3: column `x`", "without a unit");
  with_csv("time,body,x,y,z\n0,ball,0,,1\n");
  expect_refusal("a.csv: 1 sample", "two samples");
  with_csv("time,body,x,y,z\n0,ball,,,\n1,ball,,,\n");
  expect_refusal("no axis was observed", "leave the observable out");
  with_csv("time,body,x,y,z\n0,bal,0,,1\n1,bal,0,,1\n");
  expect_refusal("no sample of body `ball`", "name in recording.yaml");
  with_csv("time,body,x,y,hight\n0,ball,0,,1\n1,ball,0,,1\n");
  expect_refusal("unknown column `hight`", "known: time");
  with_csv("0,ball,0,,1\n1,ball,0,,1\n");
  expect_refusal("a.csv:1", "header line");
  with_csv("time,body,x,y,z\n0,ball,0,,1\n0,1,ball,0,03,,0,95\n");
  expect_refusal("a.csv:3", "decimal comma");
  with_csv("time,body,x,y,z\n0,\"ball,0,,1\n");
  expect_refusal("a.csv:2", "close it");
  with_csv("time,body,x,y,z,qw,qx,qy,qz\n0,ball,0,0,1,1,0,0,0\n1,ball,0,0,1,2,0,0,0\n");
  expect_refusal("a.csv:3: qw,qx,qy,qz", "normalise");
  with_csv("time,body,x,y,z,qw,qx,qy,qz\n0,ball,0,0,1,1,0,0,0\n1,ball,0,0,1,1,0,,0\n");
  expect_refusal("lacks components", "all four");
  with_csv("");
  expect_refusal("a.csv", "names the columns");
  fs::remove(folder / "a.csv");
  expect_refusal("no such file", "--root");

  with_yaml("scene: nominal.yaml\nrun: []\n");
  expect_refusal("recording.yaml:2: run", "did you mean `runs`?");
  with_yaml("scene: other.yaml\nruns: []\n");
  expect_refusal("recording.yaml:1: scene", "relative to recording.yaml");
  with_yaml(yaml("    fre: [bodies.ball.position]\n"));
  expect_refusal("fre", "did you mean `free`?");
  with_yaml(yaml("    free: [bodies.bal.position]\n"));
  expect_refusal("runs.0.free", "did you mean `ball`?");
  with_yaml(yaml("    set: {bodies.ball.velocty: [1, 0, 0]}\n"));
  expect_refusal("runs.0.set", "did you mean `velocity`?");
  with_yaml(yaml("", "calibrate: [pairs.steel-steel.fricton]\n"));
  expect_refusal("calibrate", "did you mean `friction`?");
  with_yaml(yaml("", "noise: {positon: 1.0e-3}\n"));
  expect_refusal("noise.positon", "did you mean `position`?");
  with_yaml(yaml("", "noise: {position: -1}\n"));
  expect_refusal("noise.position", "positive");
  with_yaml(yaml() + "  - id: a\n    observables: [{kind: trajectory, body: ball, file: a.csv}]\n");
  expect_refusal("run `a` is there twice", "id of its own");
  with_yaml("scene: nominal.yaml\nruns: [{id: a, observables: [{kind: trajectory, body: cube, file: a.csv}]}]\n");
  expect_refusal("the scene has no body `cube`", "known: ball");
  with_yaml(
      "scene: nominal.yaml\nruns: [{id: a, observables: [{kind: series, name: specific_force, body: ball, file: "
      "a.csv}]}]\n");
  expect_refusal("`axis` is missing", "add");
  with_yaml(yaml("    held_out: true\n"));
  expect_refusal("every run is held out", "for some");
}

TEST_F(BundleFolder, SaysWhatIsDoubtful) {
  write("recording.yaml", yaml("", "noise: {position: 1 mm}\n") + "  - id: b\n    observables: [{kind: trajectory, body: ball, file: a.csv}]\n");
  const Bundle bundle = read_bundle(folder);
  ASSERT_EQ(bundle.warnings.size(), 1U);
  EXPECT_NE(bundle.warnings[0].find("same data"), std::string::npos);
}

TEST_F(BundleFolder, SaysThatShortRecordsDoNotTellTheirNoise) {
  const Bundle bundle = read_bundle(folder);
  ASSERT_EQ(bundle.warnings.size(), 1U);
  EXPECT_NE(bundle.warnings[0].find("noise of `position` is not given, and no run has the 11 samples that would tell it"), std::string::npos) << bundle.warnings[0];
}

TEST_F(BundleFolder, AnglesAreInRadiansWithoutAUnitAndProfilesInTheirs) {
  write("p.csv", "radius,height\n0,5\n10,2\n20,0\n");
  write("recording.yaml", "scene: nominal.yaml\nruns:\n  - id: a\n    observables:\n      - {kind: scalar, name: angle_of_repose, value: 0.5, sd: 0.01}\n"
                          "      - {kind: profile, name: heap, unit: mm, file: p.csv}\n");
  const Bundle bundle = read_bundle(folder);
  EXPECT_NEAR(bundle.runs[0].observations[0].scalar, 0.5 * 180 / M_PI, 1e-12);
  EXPECT_NEAR(bundle.runs[0].observations[0].sd, 0.01 * 180 / M_PI, 1e-12);
  EXPECT_DOUBLE_EQ(bundle.runs[0].observations[1].at[1], 0.01);
  EXPECT_DOUBLE_EQ(bundle.runs[0].observations[1].value[0], 0.005);
  write("recording.yaml", "scene: nominal.yaml\nruns:\n  - id: a\n    observables: [{kind: scalar, name: angle_of_repose, value: 32.93}]\n");
  expect_refusal("without a unit, angles are in radians", "unit: deg");
}

TEST_F(BundleFolder, AFreeStartMayBeFast) {
  write("a.csv", "time,body,x,y,z\n0,ball,0,0,1\n0.01,ball,0.075,0,1\n0.02,ball,0.15,0,1\n0.03,ball,0.225,0,1\n");
  write("recording.yaml", yaml("    free: [bodies.ball.velocity]\n"));
  EXPECT_EQ(refusal(), "");
  write("a.csv", "time,body,x,y,z\n0,ball,0,0,1\n0.01,ball,75,0,1\n0.02,ball,150,0,1\n0.03,ball,225,0,1\n");
  expect_refusal("it moves 225 m", "millimetres");
}

TEST_F(BundleFolder, AFreeStartIsHardlyAThousandTimesTooHigh) {
  const std::string free = "    free: [bodies.ball.position, bodies.ball.velocity]\n";
  // A ball that rolls half a metre, a metre up, seen by a camera a kilometre away; and the same in millimetres.
  write("a.csv", "time,body,x,y,z\n0,ball,1000,0,1\n0.3,ball,1000.2,0,1\n0.6,ball,1000.3,0,1\n1,ball,1000.5,0,1\n");
  write("recording.yaml", yaml(free));
  EXPECT_EQ(refusal(), "");
  write("a.csv", "time,body,x,y,z\n0,ball,0,0,1000\n0.3,ball,200,0,1000\n0.6,ball,300,0,1000\n1,ball,500,0,1000\n");
  expect_refusal("a factor of about 1000", "millimetres");
}

TEST_F(BundleFolder, ANoiseMayHaveTheUnitOfWhatItIsOf) {
  write("h.csv", "time,value\n0,1\n0.1,0.951\n0.2,0.804\n0.3,0.559\n");
  const auto with = [&](const std::string& noise) {
    write("recording.yaml", "scene: nominal.yaml\nnoise: {height: " + noise + "}\nruns: [{id: a, observables: [{kind: series, name: height, body: ball, file: h.csv}]}]\n");
  };
  with("2 mm");
  EXPECT_EQ(read_bundle(folder).noise.at("height"), 2e-3);
  with("2 s");
  EXPECT_NE(refusal(), "");
}

TEST_F(BundleFolder, AHeightInMillimetresFallsFasterThanAnythingCan) {
  const std::string height = "scene: nominal.yaml\nnoise: {height: 1.0e-3}\nruns: [{id: a, observables: [{kind: series, name: height, body: ball, file: h.csv}]}]\n";
  write("h.csv", "time,value\n0,1\n0.1,0.951\n0.2,0.804\n0.3,0.559\n");
  write("recording.yaml", height);
  EXPECT_EQ(refusal(), "");
  write("h.csv", "time,value\n0,1000\n0.1,951\n0.2,804\n0.3,559\n");
  expect_refusal("height of `ball`", "millimetres");
}

TEST_F(BundleFolder, DoubtsAPathAThousandTimesTooShort) {
  write("a.csv", "time,body,x\n0,ball,0\n0.1,ball,0.00003\n0.2,ball,0.00006\n0.3,ball,0.00009\n");
  write("recording.yaml", yaml("    free: [bodies.ball.position]\n", "noise: {position: 1 mm}\n"));
  const Bundle bundle = read_bundle(folder);
  ASSERT_EQ(bundle.warnings.size(), 1U);
  EXPECT_NE(bundle.warnings[0].find("are positions in metres"), std::string::npos) << bundle.warnings[0];
}

TEST_F(BundleFolder, GapsHideTheNoiseOnlyWhereTooFewSamplesAreLeft) {
  const auto with_every = [&](int n) {
    std::string rows = "time,body,x\n";
    for (int i = 0; i < 30; ++i) rows += std::to_string(0.01 * i) + ",ball," + (i % n == 0 ? std::to_string(0.003 * i) : "") + "\n";
    write("a.csv", rows);
    return read_bundle(folder).warnings.size();
  };
  EXPECT_EQ(with_every(1), 0U);
  EXPECT_EQ(with_every(2), 0U) << "fifteen samples";
  EXPECT_EQ(with_every(3), 1U) << "ten samples";
}

TEST_F(BundleFolder, ProfilesComeInTheOrderOfTheirTimes) {
  write("p.csv", "time,radius,height\n0.1,0,5e-3\n0.1,1e-3,2e-3\n0,0,1e-3\n0,1e-3,0\n");
  write("recording.yaml", "scene: nominal.yaml\nruns: [{id: a, observables: [{kind: profile, name: heap, file: p.csv}]}]\n");
  expect_refusal("not in the order of their times", "sort the lines");
}

TEST_F(BundleFolder, EqualProfilesAreTheSameRunThoughTheirAnglesAreEqualToo) {
  write("p.csv", "radius,height\n0,5e-3\n1e-3,2e-3\n");
  const std::string observables = "observables: [{kind: scalar, name: angle_of_repose, value: 0.5, sd: 0.01}, {kind: profile, name: heap, file: p.csv}]";
  write("recording.yaml", "scene: nominal.yaml\nruns:\n  - id: a\n    " + observables + "\n  - id: b\n    " + observables + "\n");
  ASSERT_EQ(read_bundle(folder).warnings.size(), 1U);
  EXPECT_NE(read_bundle(folder).warnings[0].find("same data"), std::string::npos);
  const std::string angle = "observables: [{kind: scalar, name: angle_of_repose, value: 0.5, sd: 0.01}]";
  write("recording.yaml", "scene: nominal.yaml\nruns:\n  - id: a\n    " + angle + "\n  - id: b\n    " + angle + "\n");
  EXPECT_TRUE(read_bundle(folder).warnings.empty()) << "two angles may be equal by chance";
}

TEST_F(BundleFolder, ABodyHasOneTrajectory) {
  write("recording.yaml", "scene: nominal.yaml\nruns:\n  - id: a\n    observables:\n      - {kind: trajectory, body: ball, file: a.csv}\n"
                          "      - {kind: trajectory, body: ball, file: a.csv}\n");
  expect_refusal("a second trajectory of `ball`", "one file");
}

TEST_F(BundleFolder, WrittenAndReadAgainIsTheSame) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Bundle bundle = read_bundle(folder);
  bundle.noise["position"] = 1e-3;
  bundle.runs[0].free = {"bodies.ball.velocity"};
  bundle.runs[0].set = {{"bodies.ball.position", "[0.1, 0, 1]"}};
  Observation o = bundle.runs[0].observations[0];
  o.position = {{0.1, nan, 1.0 / 3}, {nan, nan, nan}, {1e-300, nan, -7}};
  o.orientation = {Quat(1, 2, 3, 4).normalized(), Quat(nan, nan, nan, nan), Quat(0, 1, 0, 0)};
  Observation series;
  series.kind = ObservableKind::series;
  series.name = "speed";
  series.body = "ball";
  series.file = "speed, of \"ball\".csv";
  series.time = {0, 0.1};
  series.value = {1.0 / 7, 2};
  bundle.runs[0].observations = {o, series};

  write_bundle(folder / "again", bundle);
  const Bundle again = read_bundle(folder / "again");
  const Observation& p = again.runs.at(0).observations.at(0);
  for (std::size_t i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_TRUE(p.position[i][k] == o.position[i][k] ||
                  (std::isnan(p.position[i][k]) && std::isnan(o.position[i][k])));
  EXPECT_LT(p.orientation[0].angularDistance(o.orientation[0]), 1e-15);
  EXPECT_TRUE(std::isnan(p.orientation[1].w()));
  EXPECT_EQ(again.runs[0].observations.at(1).value, series.value);
  EXPECT_EQ(again.runs[0].free, bundle.runs[0].free);
  EXPECT_EQ(again.noise, bundle.noise);
}

TEST(Sensor, NoiseHasTheStatedScatterAndIsReproducible) {
  Observation exact;
  exact.kind = ObservableKind::series;
  exact.name = "speed";
  for (int i = 0; i < 20000; ++i) {
    exact.time.push_back(i);
    exact.value.push_back(0);
  }
  const SensorModel sensor{.rate = 1, .noise = {{"speed", 0.5}}, .dropouts = 0.1};
  Observation a = exact, b = exact;
  Random first(7, 1), second(7, 1);
  disturb(sensor, first, a);
  disturb(sensor, second, b);
  double sum = 0, squares = 0;
  int seen = 0;
  for (std::size_t i = 0; i < a.value.size(); ++i) {
    if (std::isnan(a.value[i])) {
      EXPECT_TRUE(std::isnan(b.value[i]));
      continue;
    }
    EXPECT_EQ(a.value[i], b.value[i]);
    ++seen;
    sum += a.value[i];
    squares += a.value[i] * a.value[i];
  }
  EXPECT_NEAR(seen, 18000, 5 * std::sqrt(20000 * 0.09));
  EXPECT_NEAR(sum / seen, 0, 5 * 0.5 / std::sqrt(seen));
  EXPECT_NEAR(std::sqrt(squares / seen), 0.5, 5 * 0.5 / std::sqrt(2.0 * seen));
}

TEST(Sensor, ASingleNumberKeepsItsOwnErrorBesideTheNoise) {
  Observation angle;
  angle.kind = ObservableKind::scalar;
  angle.name = "angle_of_repose";
  angle.scalar = 30;
  angle.sd = 0.3;
  SensorModel sensor;
  Random random(1, 1);
  disturb(sensor, random, angle);
  EXPECT_EQ(angle.scalar, 30);
  EXPECT_EQ(angle.sd, 0.3);
  sensor.noise["angle_of_repose"] = 0.4;
  disturb(sensor, random, angle);
  EXPECT_NE(angle.scalar, 30);
  EXPECT_NEAR(angle.scalar, 30, 2);
  EXPECT_NEAR(angle.sd, 0.5, 1e-12);
}

}  // namespace
}  // namespace repose
