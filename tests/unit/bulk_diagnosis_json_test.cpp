/// diagnosis.json and report.html of many grains: the contract of those of few bodies, kept by whole diagnoses of the stand-in.
#include "scenarios/bulk_diagnosis_json.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenarios/bulk_diagnosis_report.hpp"
#include "tests/unit/diagnosis_contract.hpp"
#include "tests/unit/stand_in_heap.hpp"

namespace repose {
namespace {

using namespace diagnosis;
using nlohmann::json;
using test::faults_of;

const std::vector<Override> rolling{{"pairs.grain-grain.rolling_friction", "0.075"}};

struct Sample {
  Bundle bundle;
  BulkDiagnosis found;
};

Sample diagnosed(Bundle bundle, std::vector<std::string> effects) {
  BulkOptions options;
  options.effects = std::move(effects);
  BulkDiagnosis found = diagnose_bulk(bundle, stand_in(), options);
  return {std::move(bundle), std::move(found)};
}

/// One angle that many effects explain, and one run of it.
Sample ambiguous() {
  Bundle bundle = recorded_heaps(1, 1, {});
  std::erase_if(bundle.runs.front().observations, [](const Observation& o) { return o.name != "angle_of_repose"; });
  bundle.runs.front().observations.front().scalar = 32.93;
  bundle.runs.front().observations.front().sd = 1.15;
  return diagnosed(std::move(bundle), {"rolling_friction", "cohesion", "grain_shape", "restitution"});
}

TEST(BulkDiagnosisJson, EveryVerdictKeepsTheContract) {
  const std::vector<std::string> two{"rolling_friction", "restitution"};
  const std::pair<const char*, Sample> samples[] = {{"none", diagnosed(recorded_heaps(9, 300, {}), two)},
                                                    {"missing", diagnosed(recorded_heaps(12, 500, rolling), two)},
                                                    {"unknown", diagnosed(recorded_heaps(12, 500, {}, {.hidden_flow = 0.5}), two)},
                                                    {"measurement", diagnosed(recorded_heaps(12, 500, {}, {.length_factor = 1.12}), {"rolling_friction", "length_scale"})},
                                                    {"ambiguous", ambiguous()}};
  for (const auto& [verdict, sample] : samples) {
    const json result = bulk_diagnosis_json(sample.found, sample.bundle);
    EXPECT_EQ(result["verdict"], verdict);
    EXPECT_EQ(faults_of(result), std::vector<std::string>{}) << verdict;
  }
}

TEST(BulkDiagnosisJson, APlaceNamesTheGrainsAndTheRunThatDiffersMost) {
  Bundle bundle = recorded_heaps(12, 500, rolling);
  const BulkDiagnosis first = diagnosed(bundle, {"rolling_friction"}).found;
  const std::size_t far = first.data.settings.front().train_runs[2];
  for (Observation& o : bundle.runs[far].observations)
    if (o.name == "angle_of_repose") o.scalar += 20;
  const Sample sample = diagnosed(std::move(bundle), {"rolling_friction"});
  const json where = bulk_diagnosis_json(sample.found, sample.bundle)["where"];
  const auto angle = std::find_if(where.begin(), where.end(), [](const json& w) { return w["observable"] == "angle_of_repose"; });
  ASSERT_NE(angle, where.end());
  EXPECT_EQ((*angle)["run"], sample.bundle.runs[far].id);
  EXPECT_EQ((*angle)["body"], "powder");
}

TEST(BulkDiagnosisJson, AnEffectIsAsProbableAsAllThatHoldIt) {
  Sample sample = diagnosed(recorded_heaps(12, 500, rolling), {"rolling_friction", "restitution"});
  std::vector<Ranked>& ranked = sample.found.verdict.ranked;
  for (Ranked& r : ranked) r.probability = 0;
  const auto best = std::find_if(ranked.begin(), ranked.end(), [&](const Ranked& r) { return r.model == static_cast<int>(sample.found.best); });
  ASSERT_NE(best, ranked.end());
  best->probability = 0.75;
  ranked.push_back({{"rolling_friction", "restitution"}, 0.25, 0, static_cast<int>(sample.found.best)});
  EXPECT_NEAR(bulk_diagnosis_json(sample.found, sample.bundle)["missing"][0]["probability"].get<double>(), 1, 1e-12);
}

TEST(BulkDiagnosisJson, RecordingsSeparateEffectsByTheirNames) {
  Sample sample = diagnosed(recorded_heaps(12, 500, rolling), {"rolling_friction", "restitution"});
  sample.found.suggested = {{"more", "rolling_friction (grain-grain)", "restitution (grain-grain)", 0.9}};
  EXPECT_EQ(bulk_diagnosis_json(sample.found, sample.bundle)["suggested_recordings"][0]["separates"], (json{"rolling_friction", "restitution"}));
}

// Of two settings the first may be held out altogether; what is told of one setting is then told of the other.
TEST(BulkDiagnosisJson, WhatIsToldOfOneSettingIsOfOneThatWasFitted) {
  const std::vector<Override> smoother{{"pairs.grain-grain.friction", "0.3"}};
  Bundle bundle = recorded_heaps(4, 900, {{"pairs.grain-grain.friction", "0.3"}, rolling.front()});
  for (BundleRun& run : bundle.runs) {
    run.id += "-smooth";
    run.set = smoother;
    run.held_out = true;
  }
  for (BundleRun& run : recorded_heaps(8, 500, rolling).runs) bundle.runs.push_back(std::move(run));
  bundle.split_given = true;
  const Sample sample = diagnosed(std::move(bundle), {"rolling_friction", "restitution"});
  const json result = bulk_diagnosis_json(sample.found, sample.bundle);
  EXPECT_EQ(faults_of(result), std::vector<std::string>{});
  const json& angle = result["summaries"][0];
  EXPECT_EQ(angle["name"], "angle_of_repose");
  ASSERT_TRUE(angle["recorded"].is_number());
  EXPECT_NEAR(angle["nominal"].get<double>(), 20, 1);  // a friction of 0.5, and not of 0.3: 16
  EXPECT_NEAR(angle["recorded"].get<double>(), angle["extended"].get<double>(), 1);
}

TEST(BulkDiagnosisJson, SeriesThatWereCutAreTold) {
  Bundle bundle = recorded_heaps(9, 300, {});
  for (Observation& o : bundle.runs[4].observations)
    if (o.name == "discharged_mass") {
      o.time.resize(181);
      o.value.resize(181);
    }
  const Sample sample = diagnosed(std::move(bundle), {"rolling_friction"});
  const json compared = bulk_diagnosis_json(sample.found, sample.bundle)["compared"];
  ASSERT_EQ(compared.size(), 9u);
  EXPECT_NEAR(compared[0]["until"].get<double>(), 0.09, 1e-9);
  EXPECT_NEAR(compared[0]["recorded_until"].get<double>(), 0.1, 1e-9);
}

TEST(BulkDiagnosisReport, HoldsTheSettingsOfTheUserAndWhatWasFound) {
  const Sample sample = diagnosed(recorded_heaps(12, 500, rolling), {"rolling_friction"});
  const report::Report page = bulk_diagnosis_report(sample.found, sample.bundle, {{"backend", "dvi"}, {"seed", "7"}});
  const report::Settings* settings = nullptr;
  for (const report::Section& section : page.sections)
    for (const report::Block& block : section.blocks)
      if (const auto* found = std::get_if<report::Settings>(&block)) settings = found;
  ASSERT_NE(settings, nullptr);
  ASSERT_GE(settings->entries.size(), 3u);
  EXPECT_EQ(settings->entries[1], (std::pair<std::string, std::string>{"seed", "7"}));
  EXPECT_NE(settings->entries.back().first.find("paired p"), std::string::npos);
}

TEST(BulkDiagnosisReport, OfAProfileThatWasRecordedAgainAndAgainTheLastIsDrawn) {
  Bundle bundle = recorded_heaps(9, 300, {});
  for (BundleRun& run : bundle.runs)
    for (Observation& o : run.observations) {
      if (o.kind != ObservableKind::profile) continue;
      const std::vector<double> at = o.at, heights = o.value;
      o.time.assign(at.size(), 0.05);
      o.value.assign(at.size(), 1e-4);
      o.time.insert(o.time.end(), at.size(), 0.1);
      o.at.insert(o.at.end(), at.begin(), at.end());
      o.value.insert(o.value.end(), heights.begin(), heights.end());
    }
  const Sample sample = diagnosed(std::move(bundle), {"rolling_friction"});
  const report::Chart* heap = nullptr;
  const report::Report page = bulk_diagnosis_report(sample.found, sample.bundle, {});
  for (const report::Section& section : page.sections)
    for (const report::Block& block : section.blocks)
      if (const auto* chart = std::get_if<report::Chart>(&block); chart != nullptr && chart->title == "heap") heap = chart;
  ASSERT_NE(heap, nullptr);
  ASSERT_EQ(heap->series.front().x.size(), 20u);
  EXPECT_TRUE(std::is_sorted(heap->series.front().x.begin(), heap->series.front().x.end()));
  EXPECT_GT(heap->series.front().y.front(), 1.5e-4);
}

}  // namespace
}  // namespace repose
