#include "tests/bench/concealment/recorded_again.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/bench/concealment/judged_case.hpp"

namespace repose::concealment {
namespace {

using diagnosis::Change;
using nlohmann::json;

std::string value_of(const BundleRun& run, const std::string& key) {
  for (const Override& o : run.set)
    if (o.path == key) return o.value;
  return "";
}

/// Balls that are thrown, with a drag: starts have a speed.
ConcealedCase thrown() {
  for (std::uint64_t seed = 1;; ++seed)
    if (ConcealedCase made = make_case("C0", seed); made.truth.at("family") == "throw") return made;
}

TEST(RecordedAgain, EveryRunStandsThereTwiceChangedAsPlannedAndAsItWas) {
  const ConcealedCase made = thrown();
  const Bundle both = recorded_again(made, {Change::Of::speed, 2}, 7), same = recorded_again(made, {Change::Of::speed, 2}, 7), slow = recorded_again(made, {Change::Of::speed, 0.5}, 7);
  const std::size_t n = made.bundle.runs.size();
  ASSERT_EQ(both.runs.size(), 2 * n);
  std::set<std::string> files;
  for (std::size_t i = 0; i < n; ++i) {
    const BundleRun &before = both.runs[i], &again = both.runs[n + i];
    EXPECT_EQ(before.id, made.bundle.runs[i].id);
    EXPECT_EQ(again.id, before.id + "-again");
    EXPECT_EQ(again.held_out, before.held_out);
    EXPECT_EQ(again.free, before.free);
    EXPECT_NE(value_of(again, "bodies.ball.velocity"), value_of(before, "bodies.ball.velocity"));
    const Observation &fast = again.observations[0], &half = slow.runs[n + i].observations[0];
    const auto reach = [](const Observation& o) {
      Vec3 last = o.position.front();
      for (const Vec3& x : o.position)
        if (x.allFinite()) last = x;
      return (last - o.position.front()).head<2>().norm();
    };
    EXPECT_GT(reach(fast), 2 * reach(half)) << again.id;
    for (std::size_t k = 0; k < fast.position.size(); ++k) {
      const Vec3 other = same.runs[n + i].observations[0].position[k];
      EXPECT_TRUE(fast.position[k] == other || (!fast.position[k].allFinite() && !other.allFinite())) << "the same seed, other noise";
    }
    for (const BundleRun* run : {&before, &again})
      for (const Observation& o : run->observations) EXPECT_TRUE(files.insert(o.file).second) << o.file;
  }
}

TEST(RecordedAgain, WordsThatADiagnosisSaysAreAChange) {
  const ConcealedCase made = thrown();
  Bundle bundle = made.bundle;
  bundle.scene = parse_scene(bundle.scene.text, "scene");
  const std::optional<Change> change = change_in_words(bundle, Change{Change::Of::speed, 4, ""}.words());
  ASSERT_TRUE(change.has_value());
  EXPECT_EQ(change->of, Change::Of::speed);
  EXPECT_EQ(change->factor, 4);
  EXPECT_FALSE(change_in_words(bundle, "throw it to the moon").has_value());
}

TEST(JudgedCase, ASuggestedRecordingSeparatesWhereTheTruthIsNamedAlone) {
  const json truth = {{"level", "C0"}, {"family", "throw"}, {"backend", "dvi"}, {"sensor", "rounded"}, {"signal", 1.0}, {"where", json::object()},
                      {"effects", {{{"effect", "magnus"}, {"parameter", "effects.magnus.lift"}, {"value", 1.0}, {"null", 0.0}, {"phase", ""}}}}};
  const auto verdict = [](const std::string& word, const std::string& name) {
    const json side = {{"log_likelihood", -1.0}, {"chi2_per_dof", 1.0}};
    return json{{"verdict", word}, {"missing", {{{"effect", name}, {"parameters", json::object()}}}}, {"indistinguishable", json::array()}, {"ranked", json::array()},
                {"fit", {{"heldout", {{"nominal", side}, {"extended", side}}}}}};
  };
  const auto separated = [&](const json& suggested) { return judge("case", truth, verdict("ambiguous", "magnus"), nullptr, suggested).separated; };
  EXPECT_EQ(separated(nullptr), std::nullopt);
  EXPECT_EQ(separated(verdict("missing", "magnus")), true);
  EXPECT_EQ(separated(verdict("ambiguous", "magnus")), false);
  EXPECT_EQ(separated(verdict("missing", "linear_drag")), false);
  EXPECT_EQ(separated(json{{"verdict", "failed"}}), false);
}

}  // namespace
}  // namespace repose::concealment
