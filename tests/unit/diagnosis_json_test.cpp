/// diagnosis.json against the contract, for every verdict, and for damaged copies.
#include "scenarios/diagnosis_json.hpp"

#include <gtest/gtest.h>

#include "tests/browser/sample_diagnosis.hpp"
#include "tests/unit/diagnosis_contract.hpp"

namespace repose {
namespace {

using nlohmann::json;
using test::faults_of;

TEST(DiagnosisJson, every_verdict_keeps_the_contract) {
  for (const auto& sample : {test::sample_missing(), test::sample_none(), test::sample_ambiguous(), test::sample_unknown(), test::sample_measurement(),
                             test::sample_numerics()})
    EXPECT_EQ(faults_of(diagnosis_json(sample)), std::vector<std::string>{}) << sample.verdict.word;
}

TEST(DiagnosisJson, the_checker_finds_faults) {
  const json good = diagnosis_json(test::sample_missing());
  const auto damaged = [&](const char* pointer, const json& value) {
    json bad = good;
    bad[json::json_pointer(pointer)] = value;
    return !faults_of(bad).empty();
  };
  EXPECT_TRUE(damaged("/verdict", "perhaps"));
  EXPECT_TRUE(damaged("/ranked/0/probability", 0.5));
  EXPECT_TRUE(damaged("/where/0/p", 0.5));
  EXPECT_TRUE(damaged("/where/0/p", 1e-6));
  EXPECT_TRUE(damaged("/where/0/phase", "rollin"));
  EXPECT_TRUE(damaged("/missing", json::array()));
  EXPECT_TRUE(damaged("/missing/0/parameters/pairs.rubber-stone.rolling_friction/lower", 0.2));
  EXPECT_TRUE(damaged("/fit/heldout/extended/chi2_per_dof", nullptr));
  EXPECT_TRUE(damaged("/indistinguishable", json::array({json::array({"a", "b"})})));
  EXPECT_TRUE(damaged("/depends_on/0/variable", "mood"));
  json without = good;
  without.erase("fit");
  EXPECT_FALSE(faults_of(without).empty());
}

TEST(DiagnosisJson, says_what_the_diagnosis_holds) {
  const json result = diagnosis_json(test::sample_missing());
  EXPECT_EQ(result["missing"][0]["effect"], "rolling_friction");
  EXPECT_DOUBLE_EQ(result["missing"][0]["parameters"]["pairs.rubber-stone.rolling_friction"]["upper"], 0.11);
  EXPECT_EQ(result["fit"]["train"]["runs"], (json{"push-1", "push-2", "push-3", "push-4"}));
  EXPECT_EQ(result["fit"]["heldout"]["runs"].size(), 12U);
  EXPECT_DOUBLE_EQ(result["fit"]["heldout"]["nominal"]["chi2_per_dof"], 9.1 * 9.1);
  EXPECT_EQ(result["suggested_recordings"][0]["separates"], (json{"rolling_friction", "quadratic_drag"}));
  EXPECT_EQ(result["where"][0]["run"], "push-1");
  const json ruler = diagnosis_json(test::sample_measurement());
  EXPECT_EQ(ruler["missing"].size(), 2U);
  EXPECT_NEAR(ruler["missing"][1]["parameters"]["time_offset.offset"]["value"].get<double>(), 0.0115, 1e-12);
}

TEST(DiagnosisJson, an_effect_is_as_probable_as_all_that_hold_it) {
  diagnosis::Diagnosis d = test::sample_missing();
  d.verdict.ranked[0].probability = 0.9;
  d.verdict.ranked[2] = {{"rolling_friction", "quadratic_drag"}, 0.0875, 0, 2};
  EXPECT_NEAR(diagnosis_json(d)["missing"][0]["probability"].get<double>(), 0.9875, 1e-12);
}

TEST(DiagnosisJson, gives_the_noise_as_stated_and_as_used) {
  diagnosis::Diagnosis d = test::sample_missing();
  d.stated_noise["position"] = d.sensor_noise["position"] = 1.5e-4;
  d.sensor_noise["orientation"] = d.noise["orientation"].sd;
  const json noise = diagnosis_json(d)["noise"];
  EXPECT_DOUBLE_EQ(noise["position"]["stated"].get<double>(), 1.5e-4);
  EXPECT_DOUBLE_EQ(noise["position"]["sd"].get<double>(), 2e-4);
  EXPECT_TRUE(noise["position"].contains("why"));
  EXPECT_FALSE(noise["orientation"].contains("stated"));
  EXPECT_FALSE(noise["orientation"].contains("why"));
}

TEST(DiagnosisJson, with_nothing_held_out_the_held_out_part_is_empty) {
  diagnosis::Diagnosis d = test::sample_missing();
  for (diagnosis::FittedHypothesis& m : d.models) m.held_fit.runs.clear();
  const json result = diagnosis_json(d);
  EXPECT_EQ(result["fit"]["heldout"]["runs"], json::array());
  EXPECT_EQ(result["fit"]["heldout"]["extended"], json::object());
  for (const json& r : result["ranked"]) EXPECT_FALSE(r.contains("heldout_log_likelihood")) << "of no run";
  EXPECT_EQ(faults_of(result), std::vector<std::string>{});
}

}  // namespace
}  // namespace repose
