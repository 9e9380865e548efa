/// Bundles that are wrong in one place each, beside a twin that is right there: refused with place and remedy, or accepted with a
/// warning; never read as if nothing were wrong.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "analysis/bundle/read_bundle.hpp"
#include "core/error.hpp"
#include "tests/unit/dropped_ball.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

const std::string recording = R"(scene: nominal.yaml
calibrate: [pairs.steel-steel.friction]
noise: {position: 1.0e-3, orientation: 0.01}
runs:
  - id: a
    held_out: false
    set: {bodies.ball.velocity: [0.3, 0, 0]}
    free: [bodies.ball.velocity]
    observables:
      - {kind: trajectory, body: ball, file: a.csv}
      - {kind: series, name: specific_force, body: ball, axis: [0, 0, 1], unit: m/s^2, file: s.csv}
      - {kind: scalar, name: angle_of_repose, value: 30, sd: 1, unit: deg}
  - id: b
    observables: [{kind: trajectory, body: ball, file: b.csv}]
)";
const std::string path_a = "time,body,x,y,z,qw,qx,qy,qz\n0,ball,0,0,1,1,0,0,0\n0.1,ball,0.03,0,0.951,1,0,0,0\n0.2,ball,0.06,0,0.804,1,0,0,0\n0.3,ball,0.09,0,0.559,1,0,0,0\n";
const std::string path_b = "time,body,x,y,z\n0,ball,0,0,1\n0.1,ball,0.031,0,0.951\n0.2,ball,0.062,0,0.804\n0.3,ball,0.093,0,0.559\n";
/// A longer flight; what is not empty takes the place of x, y, z in the sixth sample.
std::string flight_b(const std::string& sixth) {
  std::string text = "time,body,x,y,z\n";
  for (int i = 0; i < 12; ++i) {
    const double t = 0.025 * i;
    text += fmt::format("{},ball,", t) + (i == 5 && !sixth.empty() ? sixth : fmt::format("{},0,{}", 0.31 * t, 1 - 4.905 * t * t)) + "\n";
  }
  return text;
}

/// Long enough to tell its own noise.
const std::string force = [] {
  std::string text = "time,value\n";
  for (int i = 0; i < 13; ++i) text += std::to_string(0.025 * i) + "," + std::to_string(0.0025 * i) + "\n";
  return text;
}();

struct Case {
  std::string name, file, from, bad, good;  ///< in `file` the text `from` becomes `bad`, in the twin `good`
  std::string place, remedy;                ///< what a refusal holds; no remedy: a warning holds `place`
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {"no_such_file", "recording.yaml", "a.csv", "other.csv", "a.csv", "other.csv: no such file", "--root"},
      {"file_name_beyond_all_length", "recording.yaml", "a.csv", std::string(5000, 'a'), "a.csv", "no such file", "--root"},
      {"folder_for_a_file", "recording.yaml", "a.csv", ".", "a.csv", "not a file", "CSV"},
      {"folder_for_a_scene", "recording.yaml", "nominal.yaml", ".", "nominal.yaml", "recording.yaml:1: scene", "relative"},
      {"no_such_scene", "recording.yaml", "nominal.yaml", "nominl.yaml", "nominal.yaml", "there is no file", "relative"},
      {"binary_garbage", "a.csv", path_a, std::string("\x89HDF\r\n\x1a\n\0\1\2\3", 12), path_a, "a.csv", ""},
      {"binary_recording", "recording.yaml", recording, std::string("\x89HDF\r\n\x1a\n\0\1\2\3", 12), recording, "recording.yaml", ""},
      {"empty_table", "a.csv", path_a, "", path_a, "a.csv: empty", "names the columns"},
      {"header_only", "a.csv", path_a, "time,body,x,y,z\n", path_a, "0 samples", "two samples"},
      {"one_sample", "b.csv", "0.1,ball,0.031,0,0.951\n0.2,ball,0.062,0,0.804\n0.3,ball,0.093,0,0.559\n", "",
       "0.1,ball,0.031,0,0.951\n0.2,ball,0.062,0,0.804\n0.3,ball,0.093,0,0.559\n", "1 sample", "two samples"},
      {"no_header", "s.csv", "time,value\n", "", "time,value\n", "s.csv:1", "header line"},
      {"unknown_column", "b.csv", "body,x", "body,u", "body,x", "unknown column `u`", "known: time"},
      {"column_twice", "b.csv", "x,y,z", "x,x,z", "x,y,z", "column `x` is there twice", "rename"},
      {"no_number", "b.csv", "0.951", "high", "0.951", "b.csv:3: column `z`", "decimal point"},
      {"not_a_number", "b.csv", "0.951", "NaN", "", "b.csv:3: column `z`", "leave the field empty"},
      {"infinite", "b.csv", "0.951", "inf", "0.951", "b.csv:3: column `z`", "leave the field empty"},
      {"beyond_all_numbers", "b.csv", "0.951", "1e999", "0.951", "b.csv:3: column `z`", "number"},
      {"decimal_comma", "b.csv", "0.1,ball,0.031,0,0.951", "0,1,ball,0,031,0,0,951", "0.1,ball,0.031,0,0.951", "b.csv:3", "decimal comma"},
      {"shuffled_time", "b.csv", "0.1,ball", "0.25,ball", "0.1,ball", "b.csv:4: column `time`", "sort the lines"},
      {"time_twice", "b.csv", "0.1,ball", "0,ball", "0.1,ball", "b.csv:3: column `time`", "doubled"},
      {"no_time", "b.csv", "0.1,ball", ",ball", "0.1,ball", "a sample has no time", "remove the line"},
      {"quaternion_too_long", "a.csv", "0.951,1,0,0,0", "0.951,2,0,0,0", "0.951,1.001,0,0,0", "a.csv:3: qw,qx,qy,qz", "normalise"},
      {"half_a_quaternion", "a.csv", "0.951,1,0,0,0", "0.951,1,0,,0", "0.951,,,,", "lacks components", "all four"},
      {"millimetres", "b.csv", path_b,
       "time,body,x,y,z\n0,ball,0,0,1000\n0.1,ball,31,0,951\n0.2,ball,62,0,804\n0.3,ball,93,0,559\n", path_b, "run b: b.csv", "millimetres"},
      {"kilometres", "b.csv", path_b,
       "time,body,x,y,z\n0,ball,0,0,0.001\n0.1,ball,0.000031,0,0.000951\n0.2,ball,0.000062,0,0.000804\n0.3,ball,0.000093,0,0.000559\n", path_b,
       "run b: b.csv", "kilometres"},
      {"milliseconds", "b.csv", path_b, "time,body,x,y,z\n0,ball,0,0,1\n100,ball,0.031,0,0.951\n200,ball,0.062,0,0.804\n300,ball,0.093,0,0.559\n", path_b,
       "run b: b.csv", "milliseconds"},
      {"series_of_another_dimension", "recording.yaml", "unit: m/s^2", "unit: N", "unit: mm/s^2", "specific_force", "measured in"},
      {"angle_in_radians", "recording.yaml", "unit: deg", "unit: rad", "unit: deg", "`angle_of_repose` of 1719", "unit: deg"},
      {"angle_in_newtons", "recording.yaml", "unit: deg", "unit: N", "unit: deg", "is an angle", "unit: deg"},
      {"angle_without_unit", "recording.yaml", ", unit: deg", "", ", unit: deg", "in radians", "unit: deg"},
      {"negative_noise", "recording.yaml", "position: 1.0e-3", "position: -1.0e-3", "position: 2.0e-3", "noise.position", "positive"},
      {"noise_of_nothing", "recording.yaml", "{position:", "{positon:", "{position:", "noise.positon", "did you mean `position`?"},
      {"unknown_key", "recording.yaml", "runs:", "rounds:", "runs:", "rounds", "runs"},
      {"unknown_kind", "recording.yaml", "kind: series", "kind: serie", "kind: series", "kind", "series"},
      {"no_runs", "recording.yaml", recording, "scene: nominal.yaml\nruns: []\n", recording, "no runs", "one run at least"},
      {"run_twice", "recording.yaml", "id: b", "id: a", "id: c", "run `a` is there twice", "id of its own"},
      {"all_held_out", "recording.yaml", recording,
       "scene: nominal.yaml\nruns: [{id: b, held_out: true, observables: [{kind: trajectory, body: ball, file: b.csv}]}]\n", recording,
       "every run is held out", "held_out: false"},
      {"another_body", "recording.yaml", "trajectory, body: ball, file: a", "trajectory, body: cube, file: a", "trajectory, body: ball, file: a",
       "no body `cube`", "known: ball"},
      {"file_of_another_body", "b.csv", path_b, "time,body,x,y,z\n0,cube,0,0,1\n0.1,cube,0.031,0,0.951\n", path_b, "no sample of body `ball`",
       "name in recording.yaml"},
      {"fixed_body", "recording.yaml", "trajectory, body: ball, file: a", "trajectory, body: floor, file: a", "trajectory, body: ball, file: a",
       "`floor` is fixed", "moves freely"},
      {"set_to_a_bad_key", "recording.yaml", "set: {bodies.ball.velocity", "set: {bodies.ball.velocty", "set: {bodies.ball.velocity", "runs.0.set",
       "did you mean `velocity`?"},
      {"set_to_nonsense", "recording.yaml", "[0.3, 0, 0]", "fast", "[0.4, 0, 0]", "runs.0.set", ""},
      {"free_body_unknown", "recording.yaml", "free: [bodies.ball.velocity]", "free: [bodies.bal.velocity]", "free: [bodies.ball.velocity]", "runs.0.free",
       "did you mean `ball`?"},
      {"free_material", "recording.yaml", "free: [bodies.ball.velocity]", "free: [bodies.ball.material]", "free: [bodies.ball.position]", "runs.0.free",
       "number in SI"},
      {"free_part_of_an_orientation", "recording.yaml", "free: [bodies.ball.velocity]", "free: [bodies.ball.orientation.0]", "free: [bodies.ball.orientation]", "runs.0.free",
       "name the whole: `bodies.ball.orientation`"},
      {"calibrates_what_is_not_there", "recording.yaml", "steel-steel.friction]", "steel-steel.fricton]", "steel-steel.friction]", "calibrate",
       "did you mean `friction`?"},
      {"calibrates_a_word", "recording.yaml", "[pairs.steel-steel.friction]", "[bodies.ball.material]", "[pairs.steel-steel.restitution]", "calibrate",
       "number in SI"},
      {"set_and_calibrated", "recording.yaml", "set: {bodies.ball.velocity: [0.3, 0, 0]}", "set: {pairs.steel-steel: {friction: 0.2}}", "set: {bodies.ball.velocity: [0.2, 0, 0]}",
       "which `calibrate` leaves to one fit", "one of the two"},
      // Doubtful, but possible.
      {"noise_that_no_run_tells", "s.csv", force, "time,value\n0,0\n0.1,0.01\n0.2,0.02\n0.3,0.03\n", force, "the noise of `specific_force` is not given", ""},
      {"same_run_twice", "recording.yaml", "file: b.csv}]", "file: b.csv}]\n  - id: c\n    observables: [{kind: trajectory, body: ball, file: b.csv}]",
       "file: b.csv}]", "hold the same data", ""},
      {"hanging_sensor", "s.csv", force, "time,value\n0,0.01\n0.1,0.01\n0.2,0.01\n0.3,0.01\n", force, "never changes", ""},
      {"two_clocks", "s.csv", force, "time,value\n1000,0\n1000.1,0.01\n1000.2,0.02\n1000.3,0.03\n", force, "", "a clock of their own"},
      {"clocks_that_do_not_meet", "s.csv", force, "time,value\n0.5,0\n0.6,0.01\n0.7,0.02\n0.8,0.03\n", force, "share one clock", ""},
      {"clock_of_its_own", "b.csv", path_b, "time,body,x,y,z\n5,ball,0,0,1\n5.1,ball,0.031,0,0.951\n5.2,ball,0.062,0,0.804\n5.3,ball,0.093,0,0.559\n", path_b,
       "run b: the first sample is at 5 s, and the scene begins at 0; if the clock ran before the run began, say when that was: `from: 5`", ""},
      {"long_gap", "b.csv", path_b, "time,body,x,y,z\n0,ball,0,0,1\n0.001,ball,0,0,1\n0.002,ball,0.001,0,1\n0.003,ball,0.001,0,1\n0.3,ball,0.093,0,0.559\n",
       path_b, "a gap", ""},
      {"misread_sample", "b.csv", path_b, flight_b("0.03875,0,1.4"), flight_b(""), "run b: `position` jumps away and back within one sample, first at 0.125 s",
       "Leave such a cell empty"},
      {"zeros_for_a_gap", "b.csv", path_b, flight_b("0,0,0"), flight_b(",,"), "run b: `position` is exactly zero in all axes in 1 sample, first at 0.125 s",
       "an empty cell"},
      {"unseen_start_value", "recording.yaml", "id: b\n", "id: b\n    free: [bodies.ball.orientation]\n", "id: b\n    free: [bodies.ball.velocity]\n",
       "nothing recorded shows", ""},
      {"unknown_series", "recording.yaml", "name: specific_force, body: ball, axis: [0, 0, 1], unit: m/s^2", "name: humidity",
       "name: height, body: ball, unit: m", "none that can be simulated", ""},
  };
  return all;
}

class BadBundle : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("repose-bad-bundle-" + GetParam().name);
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  /// Writes the bundle with `text` in the place of the case.
  void write(const std::string& text) const {
    std::map<std::string, std::string> files{{"nominal.yaml", dropped_ball_scene}, {"recording.yaml", recording}, {"a.csv", path_a}, {"b.csv", path_b}, {"s.csv", force}};
    std::string& file = files.at(GetParam().file);
    const std::size_t at = file.find(GetParam().from);
    ASSERT_NE(at, std::string::npos);
    file.replace(at, GetParam().from.size(), text);
    for (const auto& [name, content] : files) std::ofstream(folder / name, std::ios::binary) << content;
  }
  fs::path folder;
};

TEST_P(BadBundle, IsRefusedOrDoubtedAndItsTwinIsNot) {
  const Case& c = GetParam();
  write(c.bad);
  std::string refusal, warnings;
  try {
    for (const std::string& warning : read_bundle(folder).warnings) warnings += warning + "\n";
  } catch (const Error& error) {
    refusal = error.what();
    EXPECT_EQ(error.kind(), Error::Kind::input);
  }
  EXPECT_FALSE(refusal.empty() && warnings.empty());
  EXPECT_NE((refusal + warnings).find(c.place), std::string::npos) << refusal << warnings;
  EXPECT_NE((refusal + warnings).find(c.remedy), std::string::npos) << refusal << warnings;
  write(c.good);
  const Bundle twin = read_bundle(folder);
  EXPECT_TRUE(twin.warnings.empty()) << twin.warnings.front();
}

TEST(BundleDoubts, OrientationsAloneTellRunsApartAndNoSensorHangs) {
  Bundle bundle;
  bundle.scene = parse_scene(dropped_ball_scene, "scene");
  for (const double turned : {0.1, 0.2}) {
    Observation o;
    o.name = "position";
    o.body = "ball";
    for (int i = 0; i < 20; ++i) {
      o.time.push_back(0.01 * i);
      o.position.push_back(Vec3::Constant(NAN));
      o.orientation.push_back(rotation_of(Vec3(turned * i, 0, 0)));
    }
    BundleRun run;
    run.id = std::to_string(turned);
    run.observations = {o};
    bundle.runs.push_back(run);
  }
  bundle.noise = {{"position", 1e-3}, {"orientation", 1e-3}};
  EXPECT_EQ(doubts_of(bundle), std::vector<std::string>{});
  bundle.runs[1].observations[0].orientation = bundle.runs[0].observations[0].orientation;
  ASSERT_EQ(doubts_of(bundle).size(), 1u);
  EXPECT_NE(doubts_of(bundle)[0].find("hold the same data"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, BadBundle, ::testing::ValuesIn(cases()), [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace repose
