/// Recordings that would tell confounded models apart, and whether they do once they are made.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/diagnose.hpp"
#include "core/scene_yaml.hpp"
#include "tests/unit/flight_bundle.hpp"

namespace repose::diagnosis {
namespace {

const char* const drag = "{quadratic_drag: {coefficient: 0.47, fluid_density: 1.2}}";
/// The force has a component more than the tilt, fitted to noise: lambda is then chi^2 of one degree of freedom, 19 times of 20 below 1.96^2.
const double of_noise = 0.27;
const char* const push = "{uniform_force: {force: [0.0005, 0, 0]}}";

/// Two explanations, fitted to all runs.
struct Pair {
  Pair(const Bundle& bundle, const std::string& one, const std::string& other) : problem(bundle, all(bundle), fly), first(fitted(one)), second(fitted(other)) {}
  Fit fitted(const std::string& name) const {
    FitOptions options;
    options.iterations = 30;
    Fit start = start_of(problem, problem.layout({{{find_effect(name), ""}}}), all(problem.bundle()));
    if (name == "quadratic_drag") start.shared[0] = 0.4;
    if (name == "linear_drag") start.shared[0] = 0.001;
    return minimise(problem, start, options);
  }
  double chance(const Change& change) const { return chance_to_part(problem, first, second, change).value_or(-1); }
  Problem problem;
  Fit first, second;
};

/// The runs of the bundle recorded anew with the change, as numbered from 7 on, in the world of `truth`.
std::vector<BundleRun> recorded_again(const Bundle& bundle, const Change& change, const Flights& world) {
  const Problem problem(bundle, all(bundle), fly);
  const Layout nominal = problem.layout({});
  Random random(world.seed, 5);
  std::vector<BundleRun> runs;
  for (std::size_t i = 0; i < bundle.runs.size(); ++i) {
    BundleRun run = bundle.runs[i];
    run.id = "flight-" + std::to_string(bundle.runs.size() + i + 1);
    const SetValues set = changed(problem, nominal, start_of(problem, nominal, {i}).own[i], i, change);
    for (std::size_t k = 0; k < set.values.size(); ++k) {
      const Parameter& p = set.parameters[k];
      run.set.push_back({p.component < 0 ? p.key : p.key + "." + std::to_string(p.component), fmt::format("{}", set.values[k])});
    }
    const Scene truth = parse_scene(ball_scene(world.truth), "truth", run.set);
    record_anew(run, fly, truth, world, random);
    runs.push_back(run);
  }
  return runs;
}

Diagnosis diagnosed(const Bundle& bundle) {
  DiagnoseOptions options;
  options.replicas = 199;
  return diagnose(bundle, fly, options);
}

TEST(Confounding, ARecordingThatPartsTwoDragsIsAFasterOne) {
  // Slow balls: linear and quadratic drag look alike; at four times the speed they do not.
  const Bundle bundle = flights(six(9, drag));
  const Pair pair(bundle, "quadratic_drag", "linear_drag");
  const SuggestedRecording s = recording_that_parts(pair.problem, pair.first, pair.second);
  EXPECT_EQ(s.what, "start at 4 times the speed");
  EXPECT_GT(s.power, 0.9);
  EXPECT_EQ(s.first, "quadratic_drag");
  EXPECT_EQ(s.second, "linear_drag");
}

TEST(Confounding, StartsThatAreGivenCanBeChangedAsWell) {
  Bundle bundle = flights(six(9, drag));
  for (BundleRun& run : bundle.runs) run.free.clear();
  const Pair pair(bundle, "quadratic_drag", "linear_drag");
  EXPECT_EQ(recording_that_parts(pair.problem, pair.first, pair.second).what, "start at 4 times the speed");
}

TEST(Confounding, AForceAndATiltArePartedByAnotherMassAndByNothingElse) {
  const Bundle bundle = flights(six(9, push));
  const Pair pair(bundle, "uniform_force", "gravity_tilt");
  const SuggestedRecording s = recording_that_parts(pair.problem, pair.first, pair.second);
  EXPECT_TRUE(s.what == "give the ball 0.5 times the size in the same material" || s.what == "give the ball 0.25 times the mass at the same size") << s.what;
  EXPECT_GT(s.power, 0.99);
  EXPECT_GT(pair.chance({Change::Of::mass, 4, "ball"}), 0.99);
  EXPECT_LT(pair.chance({Change::Of::nothing}), of_noise);
  for (const Change::Of of : {Change::Of::speed, Change::Of::height})
    for (const double factor : {0.5, 2.0, 4.0}) EXPECT_LT(pair.chance({of, factor}), of_noise) << Change{of, factor}.words();
  EXPECT_EQ(pair.chance({Change::Of::spin, 4}), -1) << "no ball spins";
}

TEST(Confounding, BuoyancyAndAForceArePartedByAnotherSizeAndNotByAnotherMass) {
  const Bundle bundle = flights(six(9, "{buoyancy: {fluid_density: 5}}"));
  const Pair pair(bundle, "buoyancy", "uniform_force");
  const SuggestedRecording s = recording_that_parts(pair.problem, pair.first, pair.second);
  EXPECT_TRUE(s.what.ends_with("times the size in the same material")) << s.what;
  EXPECT_GT(s.power, 0.99);
  EXPECT_LT(pair.chance({Change::Of::mass, 0.5, "ball"}), 0.05);
}

TEST(Confounding, MassesThatAFitTurnsAreNotChanged) {
  Bundle bundle = flights(six(9, push));
  bundle.calibrate = {"materials.foam.density"};
  const Problem problem(bundle, {0, 1}, fly);
  for (const Change& change : changes_of(problem, start_of(problem, problem.layout({}), {0, 1})))
    EXPECT_TRUE(change.of != Change::Of::mass && change.of != Change::Of::size) << change.words();
}

TEST(Confounding, ABodyThatLiesOnTheFloorLiesOnItAtAnySize) {
  Bundle bundle = flights(six(9, push));
  bundle.runs[0].set.push_back({"bodies.ball.position", "[1, 2, 0.02]"});
  bundle.runs[0].set.push_back({"bodies.ball.angular_velocity", "[0, 50, 0]"});
  const Problem problem(bundle, {0}, fly);
  const Layout nominal = problem.layout({});
  const SetValues set = changed(problem, nominal, start_of(problem, nominal, {0}).own[0], 0, {Change::Of::size, 2, "ball"});
  const auto value = [&](const std::string& key, int component) {
    for (std::size_t i = 0; i < set.values.size(); ++i)
      if (set.parameters[i].key == key && set.parameters[i].component == component) return set.values[i];
    return std::nan("");
  };
  EXPECT_DOUBLE_EQ(value("shapes.ball.radius", -1), 0.04);
  EXPECT_DOUBLE_EQ(value("bodies.ball.position", 0), 1);
  EXPECT_DOUBLE_EQ(value("bodies.ball.position", 2), 0.04);
  EXPECT_DOUBLE_EQ(value("bodies.ball.angular_velocity", 1), 25);
}

/// Whatever is the truth: told of one kind of ball alone, the tool cannot tell, and says what would; told of both kinds it can.
TEST(Confounding, TheRecordingThatIsSuggestedTellsThemApart) {
  for (const std::string truth : {"uniform_force", "gravity_tilt"}) {
    const Flights world = six(21, truth == "uniform_force" ? push : "{gravity_tilt: {x_deg: 0, y_deg: 1.5}}");
    Bundle bundle = flights(world);
    const Diagnosis before = diagnosed(bundle);
    ASSERT_EQ(before.verdict.word, "ambiguous") << truth;
    ASSERT_EQ(before.suggested.size(), 1u);
    EXPECT_GT(before.suggested[0].power, 0.95);
    const Problem problem(bundle, all(bundle), fly);
    const std::vector<Change> all = changes_of(problem, before.models[before.best].fit);
    const auto suggested = std::find_if(all.begin(), all.end(), [&](const Change& c) { return c.words() == before.suggested[0].what; });
    ASSERT_NE(suggested, all.end()) << before.suggested[0].what;
    for (BundleRun& run : recorded_again(bundle, *suggested, world)) bundle.runs.push_back(std::move(run));
    const Diagnosis after = diagnosed(bundle);
    EXPECT_EQ(after.verdict.word, "missing") << truth;
    EXPECT_EQ(after.models[after.best].hypothesis.names(), std::vector<std::string>{truth});
  }
}

}  // namespace
}  // namespace repose::diagnosis
