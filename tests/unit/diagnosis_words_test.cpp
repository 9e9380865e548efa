#include "scenarios/diagnosis_words.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "scenarios/diagnosis_progress.hpp"
#include "scenarios/diagnosis_values.hpp"
#include "tests/browser/sample_diagnosis.hpp"

namespace repose {
namespace {

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(DiagnosisWords, missing_where_what_and_what_it_is_worth) {
  EXPECT_EQ(diagnosis_in_words(test::sample_missing()),
            "Between 0.12 s and 0.58 s of run push-1, while the ball rolls, it slows by 0.71 m/s² that the model does not have. "
            "Rolling friction explains it: ρ = 0.1000 ± 0.0100. "
            "On 12 recordings that were not used, the error falls from 9.1 σ to 1.02 σ.");
  EXPECT_EQ(verdict_in_words(test::sample_missing()), "Missing: rolling friction");
}

TEST(DiagnosisWords, none_claims_nothing) {
  const std::string words = diagnosis_in_words(test::sample_none());
  EXPECT_TRUE(says(words, "Nothing is missing")) << words;
  EXPECT_TRUE(says(words, "µ = 0.520 ± 0.020")) << words;
  EXPECT_FALSE(says(words, "explains it")) << words;
  diagnosis::Diagnosis chance = test::sample_none();
  chance.lack_of_fit_p = 0.004;
  chance.held_out_p = 0.3;
  EXPECT_TRUE(says(diagnosis_in_words(chance), "chance makes one in 250 differ (p = 0.004), those that were held out do not (p = 0.3)")) << diagnosis_in_words(chance);
}

TEST(DiagnosisWords, noise_that_was_stated_too_small) {
  diagnosis::Diagnosis d = test::sample_none();
  d.stated_noise["position"] = 1e-4;
  d.understated["position"] = d.sensor_noise["position"] = d.noise["position"].sd = 5e-4;
  EXPECT_TRUE(says(diagnosis_in_words(d), "states a noise of 0.0001 m for position, but its samples scatter by 0.0005 m")) << diagnosis_in_words(d);
  EXPECT_TRUE(says(raised_noise_in_words(d, "position"), "by the scatter of the samples it is at least 0.0005 m")) << raised_noise_in_words(d, "position");
}

TEST(DiagnosisWords, ambiguous_names_the_rival) {
  const std::string words = diagnosis_in_words(test::sample_ambiguous());
  EXPECT_TRUE(says(words, "explains it best: ρ = 0.1000 ± 0.0100; but these recordings cannot tell it from quadratic drag.")) << words;
  EXPECT_TRUE(says(words, "A recording that would tell: start at 2 times the speed (chance 95 %).")) << words;
  EXPECT_TRUE(says(verdict_in_words(test::sample_ambiguous()), "Missing: rolling friction or quadratic drag"));
}

TEST(DiagnosisWords, ambiguous_beside_what_is_sure) {
  diagnosis::Diagnosis d = test::sample_ambiguous();
  const diagnosis::Term tilt{find_effect("gravity_tilt"), ""}, rolling{find_effect("rolling_friction"), "rubber-stone"};
  d.models[1] = test::sample::model({tilt, rolling}, 1.02);
  d.models[1].parameters = {test::sample::estimate("effects.gravity_tilt.x_deg", "deg", "gravity_tilt", 1.2, 0.1),
                            test::sample::estimate("pairs.rubber-stone.rolling_friction", "1", "rolling_friction", 0.1, 0.01)};
  d.verdict.indistinguishable = {{"gravity_tilt", "uniform_force"}};
  EXPECT_EQ(verdict_in_words(d), "Missing: rolling friction, and gravity tilt or uniform force");
  EXPECT_TRUE(says(diagnosis_in_words(d), "Rolling friction (ρ = 0.1000 ± 0.0100) explains it together with gravity tilt (x = 1.200 ± 0.100°) or uniform force: "
                                          "these recordings cannot tell which of the two. On 12")) << diagnosis_in_words(d);
}

TEST(DiagnosisWords, no_recording_that_was_tried_would_tell) {
  diagnosis::Diagnosis d = test::sample_ambiguous();
  d.suggested.front().power = 0.1;
  EXPECT_TRUE(says(diagnosis_in_words(d), "No change of the start, of masses or of sizes that was tried would tell them apart; the best, start at 2 times the speed, has a chance of 10 %."))
      << diagnosis_in_words(d);
}

TEST(DiagnosisWords, a_stretch_that_is_one_moment) {
  diagnosis::Diagnosis d = test::sample_missing();
  d.where.front().segment.from = 0.3961;
  d.where.front().segment.to = 0.3964;
  EXPECT_TRUE(diagnosis_in_words(d).starts_with("At 0.396 s of run push-1, ")) << diagnosis_in_words(d);
}

TEST(DiagnosisWords, effects_that_the_scene_lacks_come_before_constants_that_it_has_wrong) {
  diagnosis::Diagnosis d = test::sample_missing();
  const diagnosis::Term bounce{find_effect("restitution"), "rubber-stone", {0.8}}, rolling{find_effect("rolling_friction"), "rubber-stone"};
  d.models[1] = test::sample::model({bounce, rolling}, 1.02);
  d.models[1].parameters = {test::sample::estimate("pairs.rubber-stone.restitution", "1", "restitution", 0.86, 0.01),
                            test::sample::estimate("pairs.rubber-stone.rolling_friction", "1", "rolling_friction", 0.1, 0.01)};
  d.verdict.ranked[0].effects = {"restitution", "rolling_friction"};
  EXPECT_EQ(verdict_in_words(d), "Missing: rolling friction and restitution");
  EXPECT_TRUE(says(diagnosis_in_words(d), "Rolling friction (ρ = 0.1000 ± 0.0100) and restitution (e = 0.8600 ± 0.0100 instead of the 0.8 that the scene states) explain it together"))
      << diagnosis_in_words(d);
  EXPECT_EQ(effects_in_order(d, d.verdict.ranked[0]), (std::vector<std::string>{"rolling_friction", "restitution"}));
}

TEST(DiagnosisWords, why_the_noise_is_not_as_stated) {
  diagnosis::Diagnosis d = test::sample_missing();
  EXPECT_EQ(raised_noise_in_words(d, "position"), "");
  d.stated_noise["position"] = d.sensor_noise["position"] = 2e-4;
  EXPECT_EQ(raised_noise_in_words(d, "position"), "");
  d.noise["position"].sd = 2.5e-4;
  EXPECT_TRUE(says(raised_noise_in_words(d, "position"), "To the 0.0002 m that the bundle states come 0.00015 m by which the step of a simulation may err here, in squares: 0.00025 m in all"))
      << raised_noise_in_words(d, "position");
}

TEST(DiagnosisWords, unknown_says_how_little_the_nearest_explains) {
  const std::string words = diagnosis_in_words(test::sample_unknown());
  EXPECT_TRUE(says(words, "no effect in the library explains it")) << words;
  EXPECT_TRUE(says(words, "quadratic drag, removes 30 % of the misfit")) << words;
  EXPECT_FALSE(says(words, "drag explains it")) << words;
}

TEST(DiagnosisWords, measurement_and_numerics_blame_no_physics) {
  const std::string ruler = diagnosis_in_words(test::sample_measurement());
  EXPECT_TRUE(says(ruler, "length scale (factor = 1.0300 ± 0.0020)") || says(ruler, "Length scale (factor = 1.0300 ± 0.0020)")) << ruler;
  EXPECT_TRUE(says(ruler, "No physics is missing")) << ruler;
  EXPECT_FALSE(says(ruler, "slows")) << ruler;
  const std::string step = diagnosis_in_words(test::sample_numerics());
  EXPECT_TRUE(says(step, "goes away with a finer simulation (time step)")) << step;
  EXPECT_FALSE(says(step, "slows")) << step;
  diagnosis::Diagnosis engine = test::sample_numerics();
  engine.models[engine.best].fit.layout.numerics.backend = "dart";
  engine.models[engine.best].fit.layout.numerics.step_factor = 0.25;
  EXPECT_TRUE(says(diagnosis_in_words(engine), "goes away when dart solves the scene, at 0.25 of its step")) << diagnosis_in_words(engine);
}

TEST(DiagnosisWords, admits_what_is_not_proven) {
  diagnosis::Diagnosis d = test::sample_missing();
  d.paired_p = 0.2;
  EXPECT_TRUE(says(diagnosis_in_words(d), "not yet proven (p = 0.2)"));
  for (diagnosis::FittedHypothesis& m : d.models) m.held_out.runs.resize(2);
  EXPECT_TRUE(says(diagnosis_in_words(d), "only 2 recordings were held out, too few to prove it.")) << diagnosis_in_words(d);
  for (diagnosis::FittedHypothesis& m : d.models) m.held_fit.runs.clear();
  EXPECT_TRUE(says(diagnosis_in_words(d), "No recording was held out"));
  d.models[1].held_out.chi2_per_dof = 9;
  d.remaining_p = 0.002;
  EXPECT_TRUE(says(diagnosis_in_words(d), "something else is missing too"));
  d.models[1].held_out.chi2_per_dof = 100;
  EXPECT_TRUE(says(diagnosis_in_words(d), "does not fall (9.1 σ before, 10 σ after)"));
  d.interrupted = true;
  EXPECT_TRUE(diagnosis_in_words(d).starts_with("Interrupted"));
}

TEST(DiagnosisWords, held_out_recordings_that_do_not_show_it) {
  diagnosis::Diagnosis d = test::sample_missing();
  d.verdict.by_fitted_runs = true;
  const std::size_t n = d.models.front().held_out.runs.size();
  EXPECT_TRUE(says(diagnosis_in_words(d), fmt::format("The {} recordings that were not used do not show it", n))) << diagnosis_in_words(d);
  for (diagnosis::FittedHypothesis& m : d.models) m.held_out.runs.resize(1);
  EXPECT_TRUE(says(diagnosis_in_words(d), "The recording that was not used does not show it")) << diagnosis_in_words(d);
}

TEST(DiagnosisWords, forces_by_what_they_do) {
  diagnosis::Located l = test::sample::located(0, 0.1, 0.2, 0.002);
  l.force = Vec3(0.05, 0, 0);
  EXPECT_EQ(force_in_words(l), "it gains speed by 0.5 m/s² that the model does not have");
  l.force = Vec3(0, 0.01, -0.05);
  EXPECT_EQ(force_in_words(l), "it is pushed towards −z by 0.51 m/s² that the model does not have");
  l.segment.phase = diagnosis::Phase::impact;
  l.force = Vec3(0, 0, 2);
  EXPECT_EQ(force_in_words(l), "its velocity changes by 2 m/s that the model does not have");
  l.force_se = Vec3::Constant(2);
  EXPECT_EQ(force_in_words(l), "");
}

TEST(DiagnosisValues, symbols_and_units) {
  EXPECT_EQ(symbol_of("pairs.a-b.rolling_friction"), "ρ");
  EXPECT_EQ(symbol_of("effects.uniform_force.force.2"), "force z");
  EXPECT_EQ(symbol_of("effects.gravity_tilt.y_deg"), "y");
  EXPECT_EQ(written_unit("m/s^2"), "m/s²");
  EXPECT_EQ(written_unit("1"), "");
  EXPECT_EQ(value_in_words(test::sample::estimate("x_deg", "deg", "", 2.5, 0.25)), "2.50 ± 0.25°");
}

TEST(DiagnosisProgress, never_falls_and_never_ends_too_soon) {
  DiagnosisProgress progress;
  EXPECT_EQ(progress.share("calibrating the nominal scene", 0, 1), 0);
  EXPECT_EQ(progress.left(1), 0);
  double last = 0;
  for (const char* stage : {"screening candidates", "fitting candidates: friction", "screening candidates", "a stage without a name", "a finer step",
                            "runs that were held out", "a recording that would tell more"})
    for (const double done : {0.0, 1.0, 2.0}) {
      const double share = progress.share(stage, done, 2);
      EXPECT_GE(share, last) << stage;
      EXPECT_LT(share, 1) << stage;
      last = share;
    }
  EXPECT_GT(last, 0.9);
  EXPECT_NEAR(progress.left(30), 30 * (1 - last) / last, 1e-12);
}

}  // namespace
}  // namespace repose
