/// diagnosis.json against the contract: a checker of keys, kinds and meanings, run on every verdict, and on damaged copies.
#include "scenarios/diagnosis_json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/browser/sample_diagnosis.hpp"

namespace repose {
namespace {

using nlohmann::json;

const std::set<std::string> verdicts = {"missing", "none", "unknown", "ambiguous", "measurement", "numerics"};
const std::set<std::string> phases = {"flight", "impact", "sliding", "rolling", "rest", "flow", "heap", "spread"};
const std::set<std::string> variables = {"speed",  "slip_speed", "normal_force", "spin",      "position", "height",
                                         "time",   "temperature", "direction",   "size", "impact_speed"};

bool is_share(const json& v) { return v.is_number() && v.get<double>() >= 0 && v.get<double>() <= 1; }

bool is_p(const json& v, int replicas) { return is_share(v) && v.get<double>() >= 1.0 / (replicas + 1) - 1e-12; }

void check_interval(const json& v, const std::string& name, std::vector<std::string>& faults) {
  if (!v["value"].is_number() || !v["lower"].is_number() || !v["upper"].is_number())
    faults.push_back(name + ": value, lower, upper");
  else if (v["lower"] > v["value"] || v["value"] > v["upper"])
    faults.push_back(name + ": lower <= value <= upper");
}

void check_fit(const json& fit, const std::string& name, std::vector<std::string>& faults) {
  if (!fit["runs"].is_array()) faults.push_back(name + ".runs");
  for (const char* model : {"nominal", "extended"}) {
    if (fit["runs"].empty()) continue;
    if (!fit[model]["chi2_per_dof"].is_number()) faults.push_back(name + "." + model + ".chi2_per_dof");
    if (!fit[model]["rmse"].is_object() || fit[model]["rmse"].empty()) faults.push_back(name + "." + model + ".rmse");
    for (const auto& [observable, rmse] : fit[model]["rmse"].items())
      if (!rmse.is_number() || rmse < 0) faults.push_back(name + "." + model + ".rmse." + observable);
  }
}

void check_where(const json& where, int replicas, std::vector<std::string>& faults) {
  double last = 0;
  for (const json& w : where) {
    for (const char* key : {"observable", "body", "run"})
      if (!w[key].is_string()) faults.push_back(std::string("where.") + key);
    if (!phases.contains(w.value("phase", ""))) faults.push_back("where.phase");
    if (!w.contains("region") || !(w["region"].is_null() || w["region"].is_string())) faults.push_back("where.region");
    if (!w["t_start"].is_number() || !w["t_end"].is_number() || w["t_start"] > w["t_end"]) faults.push_back("where.t_start");
    if (!is_p(w["p"], replicas)) faults.push_back("where.p");
    if (w["p"] < last) faults.push_back("where is sorted by p");
    last = w["p"];
  }
}

void check_ranked(const json& result, std::vector<std::string>& faults) {
  double total = 0;
  bool nothing = false, unknown = false;
  for (const json& r : result["ranked"]) {
    if (!r["effects"].is_array() || !is_share(r["probability"])) faults.push_back("ranked");
    total += r["probability"].get<double>();
    nothing = nothing || r["effects"].empty();
    unknown = unknown || r["effects"] == json{"unknown"};
  }
  if (std::abs(total - 1) > 1e-9) faults.push_back("probabilities sum to 1");
  if (!nothing) faults.push_back("ranked has []");
  if (!unknown) faults.push_back("ranked has [\"unknown\"]");
}

/// What is wrong with a diagnosis.json; empty: nothing.
std::vector<std::string> faults_of(json result) {
  std::vector<std::string> faults;
  for (const char* key : {"verdict", "missing", "ranked", "indistinguishable", "suggested_recordings", "where", "depends_on", "nominal", "fit", "extended_scene", "compared"})
    if (!result.contains(key)) faults.push_back(std::string("no key ") + key);
  if (!faults.empty()) return faults;
  const std::string verdict = result["verdict"];
  if (!verdicts.contains(verdict)) faults.push_back("verdict");
  const bool names = verdict != "none" && verdict != "unknown";
  if (result["missing"].empty() == names) faults.push_back("missing names effects exactly if the verdict does");
  for (const json& m : result["missing"]) {
    if (find_effect(m.value("effect", "")) == nullptr || !is_share(m["probability"])) faults.push_back("missing");
    for (const auto& [name, value] : m["parameters"].items()) {
      check_interval(value, name, faults);
      if (!value["unit"].is_string()) faults.push_back(name + ".unit");
    }
  }
  check_ranked(result, faults);
  for (const json& group : result["indistinguishable"])
    if (group.size() < 2 || group.size() > 3) faults.push_back("indistinguishable: two or three");
  if ((verdict == "ambiguous") == result["indistinguishable"].empty()) faults.push_back("ambiguous has a class, others none");
  for (const json& s : result["suggested_recordings"])
    if (!s["what"].is_string() || s["separates"].size() != 2 || s["separates"][0] == s["separates"][1] || !is_share(s["power"]))
      faults.push_back("suggested_recordings");
  for (const json& s : result["depends_on"])
    if (!variables.contains(s.value("variable", "")) || !is_share(s["explained"])) faults.push_back("depends_on");
  const json& nominal = result["nominal"];
  if (!nominal["calibrated"].is_object() || !nominal["replicas"].is_number_integer() || !is_p(nominal["lack_of_fit_p"], nominal["replicas"]))
    faults.push_back("nominal");
  for (const auto& [name, value] : nominal["calibrated"].items()) check_interval(value, name, faults);
  check_where(result["where"], nominal["replicas"], faults);
  check_fit(result["fit"]["train"], "fit.train", faults);
  check_fit(result["fit"]["heldout"], "fit.heldout", faults);
  if (!is_share(result["fit"]["heldout"]["paired_p"]) || !result["fit"]["heldout"]["effect_size"].is_number()) faults.push_back("fit.heldout.paired_p");
  for (const json& c : result["compared"])
    if (!c["run"].is_string() || !c["until"].is_number() || c["until"] > c["recorded_until"]) faults.push_back("compared");
  if (result["extended_scene"] != "extended.yaml") faults.push_back("extended_scene");
  return faults;
}

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
