/// The bundles of real recordings, and what a small diagnosis of each must say. The data are not part of the project.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "analysis/bundle/read_bundle.hpp"
#include "analysis/diagnosis/diagnose.hpp"
#include "backends/backends.hpp"
#include "scenarios/history.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;
using diagnosis::Diagnosis;

class Recordings : public ::testing::Test {
 protected:
  void SetUp() override {
    if (fs::is_directory(REPOSE_RECORDINGS)) return;
    if (std::getenv("CI") != nullptr) FAIL() << "no recordings in " << REPOSE_RECORDINGS;
    GTEST_SKIP() << "no recordings in " << REPOSE_RECORDINGS << ": give their folder as -DREPOSE_RECORDINGS=...";
  }
  static Bundle read(const std::string& set, const std::string& file = "recording.yaml") {
    return read_bundle(fs::path(REPOSE_BUNDLES) / set / file, fs::path(REPOSE_RECORDINGS) / set);
  }
  static Diagnosis diagnose(const Bundle& bundle, int runs, int held_out) {
    diagnosis::DiagnoseOptions options;
    options.other_backends = backends_beside(find_backend("dvi"));
    options.max_train_runs = runs;
    options.max_held_out_runs = held_out;
    return diagnosis::diagnose(bundle, simulate_with(find_backend("dvi"), false), options);
  }
  static bool names(const Diagnosis& d, const std::vector<std::string>& any_of) {
    const std::vector<std::string> found = d.models[d.best].hypothesis.names();
    return std::any_of(any_of.begin(), any_of.end(),
                       [&](const std::string& name) { return std::find(found.begin(), found.end(), name) != found.end(); });
  }
  static double held_out_gain(const Diagnosis& d) {
    return d.models[d.best].held_out.log_likelihood - d.models.front().held_out.log_likelihood;
  }
};

const std::vector<std::string> resistance{"linear_drag", "quadratic_drag", "finite_reynolds_drag"};

TEST_F(Recordings, BundlesAreReadWithoutDoubt) {
  const std::vector<std::tuple<std::string, std::string, std::size_t>> bundles{{"ball_drops", "recording.yaml", 22},
                                                                              {"phone_fall", "recording.yaml", 11},
                                                                              {"cube_tosses", "recording.yaml", 191},
                                                                              {"cube_tosses", "recording_frictionless.yaml", 191},
                                                                              {"cube_tosses", "recording_no_restitution.yaml", 191}};
  for (const auto& [set, file, runs] : bundles) {
    const Bundle bundle = read(set, file);
    EXPECT_EQ(bundle.runs.size(), runs) << set;
    for (const std::string& warning : bundle.warnings) ADD_FAILURE() << set << ": " << warning;
  }
}

// With four of the eleven balls one coefficient for all explains too little to be named.
TEST_F(Recordings, BallsFallSlowerThanInAVacuum) {
  const Diagnosis d = diagnose(read("ball_drops"), 8, 7);
  EXPECT_TRUE(d.verdict.word == "missing" || d.verdict.word == "ambiguous") << d.verdict.word;
  EXPECT_TRUE(names(d, resistance));
  EXPECT_GT(held_out_gain(d), 0);
  ASSERT_FALSE(d.where.empty());
  EXPECT_GT(d.where.front().force.z(), 0);
}

// Four runs are fitted. The bias of the sensor is not asked for here: with so few runs the search has been seen to leave it out.
TEST_F(Recordings, ThePhoneMeetsTheAir) {
  const Diagnosis d = diagnose(read("phone_fall"), 4, 3);
  EXPECT_TRUE(names(d, resistance));
  EXPECT_GT(held_out_gain(d), 0);
}

}  // namespace
}  // namespace repose
