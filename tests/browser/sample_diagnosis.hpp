#pragma once
/// Diagnoses as the method would hand them over, one for each verdict: what words, JSON and report are tested with.
#include <cmath>
#include <string>
#include <vector>

#include "analysis/diagnosis/diagnose.hpp"

namespace repose::test {

namespace sample {

using namespace diagnosis;

inline constexpr int train_runs = 4, held_runs = 12;

/// `error`: typical residual of the model [sigma].
inline Score score(std::size_t first, std::size_t runs, double error) {
  Score s;
  for (std::size_t i = 0; i < runs; ++i) {
    s.runs.push_back(first + i);
    s.per_run.push_back(-100 * error * error * (1 + 0.05 * std::sin(static_cast<double>(i))));
    s.log_likelihood += s.per_run.back();
  }
  s.chi2_per_dof = error * error;
  s.rmse = {{"position", 2e-4 * error}, {"orientation", 2e-3 * error}};
  return s;
}

inline FittedHypothesis model(const std::vector<Term>& terms, double error) {
  FittedHypothesis m;
  m.hypothesis.terms = terms;
  m.fit.layout.hypothesis = m.hypothesis;
  m.fit.layout.per_run.resize(train_runs + held_runs);
  m.fit.own.assign(train_runs + held_runs, Eigen::VectorXd(0));
  m.held_fit = m.fit;
  for (std::size_t i = 0; i < train_runs + held_runs; ++i) (i < train_runs ? m.fit : m.held_fit).runs.push_back(i);
  m.train = score(0, train_runs, error);
  m.held_out = score(train_runs, held_runs, error);
  return m;
}

inline ParameterEstimate estimate(const std::string& name, const std::string& unit, const std::string& effect, double value, double half) {
  ParameterEstimate e;
  e.name = name;
  e.unit = unit;
  e.effect = effect;
  e.value = value;
  e.lower = value - half;
  e.upper = value + half;
  return e;
}

/// A ball of 0.1 kg that rolls along x in run push-<n>, slowed by 0.069 N.
inline Located located(std::size_t run, double from, double to, double p) {
  Located l;
  l.run = run;
  l.observable = "position";
  l.mass = 0.1;
  l.segment.body = "ball";
  l.segment.phase = Phase::rolling;
  l.segment.from = from;
  l.segment.to = to;
  l.segment.speed = 0.5 + 0.1 * static_cast<double>(run) - 0.2 * from;
  l.segment.normal_force = 0.98;
  l.segment.height = 0.02;
  l.segment.time = 0.5 * (from + to);
  l.segment.velocity = l.segment.speed * Vec3::UnitX();
  l.force = Vec3(-0.069 - 0.002 * std::sin(7.0 * static_cast<double>(run) + 9 * from), 0, 0);
  l.force_se = Vec3(0.002, 0.002, 0);
  l.p = p;
  return l;
}

}  // namespace sample

/// Rolling friction, found: the headline of the report's description. `with_effects` false: nothing found, for `none`.
inline diagnosis::Diagnosis sample_missing() {
  using namespace sample;
  Diagnosis d;
  const Term rolling{find_effect("rolling_friction"), "rubber-stone"}, drag{find_effect("quadratic_drag"), ""};
  d.models = {model({}, 9.1), model({rolling}, 1.02), model({drag}, 5)};
  d.models[1].parameters = {estimate("pairs.rubber-stone.rolling_friction", "1", "rolling_friction", 0.1, 0.01)};
  d.models[2].parameters = {estimate("effects.quadratic_drag.coefficient", "1", "quadratic_drag", 12, 2)};
  d.best = 1;
  d.verdict.word = "missing";
  d.verdict.best = 1;
  d.verdict.ranked = {{{"rolling_friction"}, 0.98, d.models[1].held_out.log_likelihood, 1},
                      {{"unknown"}, 0.0125, 0, -1},
                      {{"quadratic_drag"}, 0.0075, d.models[2].held_out.log_likelihood, 2},
                      {{}, 0, d.models[0].held_out.log_likelihood, 0}};
  d.lack_of_fit_p = 0.002;
  d.remaining_p = 0.4;
  d.explained = 0.997;
  d.replicas = 499;
  d.where = {located(0, 0.12, 0.58, 0.002)};
  for (std::size_t run = 1; run < train_runs; ++run)
    for (const double from : {0.0, 0.2, 0.4}) d.where.push_back(located(run, from, from + 0.2, 0.3));
  d.depends_on = {{"normal_force", 0.93, "linear", 0.0704}, {"speed", 0.41, "linear", 0.1}};
  SuggestedRecording suggested;
  suggested.what = "start at 2 times the speed";
  suggested.first = d.models[1].hypothesis.label();
  suggested.second = d.models[2].hypothesis.label();
  suggested.power = 0.95;
  d.suggested = {suggested};
  d.paired_p = 5e-4;
  d.effect_size = 1.8;
  for (int i = 1; i <= train_runs + held_runs; ++i) d.run_ids.push_back("push-" + std::to_string(i));
  d.train_runs = train_runs;
  for (const char* run : {"push-1", "push-5"})
    for (const char* channel : {"ball: position x", "ball: position y"}) {
      ResidualSample s{run, channel, {}, {}, {}};
      for (int i = 0; i <= 60; ++i) {
        const double t = 0.01 * i, noise = std::sin(1e3 * t * t + 3 * i);
        s.time.push_back(t);
        s.nominal.push_back(noise + (channel[15] == 'x' ? 60 * t * t : 0));
        s.extended.push_back(noise);
      }
      d.residuals.push_back(s);
    }
  d.extended_scene = "pairs:\n  rubber-stone: {friction: 0.5, rolling_friction: 0.1}\n";
  d.noise = {{"position", {2e-4, 0}}, {"orientation", {2e-3, 0.4}}};
  d.notes = {"Run push-3 is compared up to 0.55 s of 0.6 s: beyond it the noise of its start no longer acts linearly."};
  d.simulations = 4321;
  return d;
}

inline diagnosis::Diagnosis sample_none() {
  diagnosis::Diagnosis d = sample_missing();
  d.verdict.word = "none";
  d.best = 0;
  d.verdict.best = 0;
  d.models[0] = sample::model({}, 1.01);
  d.models[0].parameters = {sample::estimate("pairs.rubber-stone.friction", "1", "", 0.52, 0.02)};
  d.verdict.ranked = {{{}, 0.985, d.models[0].held_out.log_likelihood, 0},
                      {{"unknown"}, 0.01, 0, -1},
                      {{"rolling_friction"}, 0.005, d.models[1].held_out.log_likelihood, 1}};
  d.lack_of_fit_p = d.remaining_p = 0.4;
  for (diagnosis::Located& l : d.where) l.p = 0.4;
  for (diagnosis::ResidualSample& s : d.residuals) s.nominal = s.extended;
  d.paired_p = 1;
  d.effect_size = 0;
  d.suggested.clear();
  return d;
}

/// Two laws of drag that the recordings cannot tell apart.
inline diagnosis::Diagnosis sample_ambiguous() {
  diagnosis::Diagnosis d = sample_missing();
  d.verdict.word = "ambiguous";
  d.verdict.indistinguishable = {{"rolling_friction", "quadratic_drag"}};
  d.verdict.ranked[0].probability = 0.58;
  d.verdict.ranked[1].probability = 0.02;
  d.verdict.ranked[2].probability = 0.4;
  return d;
}

inline diagnosis::Diagnosis sample_unknown() {
  diagnosis::Diagnosis d = sample_missing();
  d.verdict.word = "unknown";
  d.best = 2;
  d.verdict.best = 2;
  d.explained = 0.3;
  d.remaining_p = 0.002;
  d.verdict.ranked = {{{"unknown"}, 0.9, 0, -1},
                      {{"quadratic_drag"}, 0.06, d.models[2].held_out.log_likelihood, 2},
                      {{"rolling_friction"}, 0.03, d.models[1].held_out.log_likelihood, 1},
                      {{}, 0.01, d.models[0].held_out.log_likelihood, 0}};
  return d;
}

/// A ruler that is 3 % wrong, and a clock that is late by another amount in every run.
inline diagnosis::Diagnosis sample_measurement() {
  diagnosis::Diagnosis d = sample_missing();
  d.verdict.word = "measurement";
  d.models[1] = sample::model({{find_effect("length_scale"), ""}, {find_effect("time_offset"), ""}}, 1.02);
  d.models[1].parameters = {sample::estimate("length_scale.factor", "1", "length_scale", 1.03, 0.002),
                            sample::estimate("time_offset.offset", "s", "time_offset", 0.0115, 0.0015)};
  diagnosis::FittedHypothesis& m = d.models[1];
  for (const std::size_t run : m.fit.runs) {
    diagnosis::Parameter p;
    p.use = diagnosis::Parameter::Use::time_offset;
    p.key = "time_offset.offset";
    p.effect = "time_offset";
    p.unit = "s";
    m.fit.layout.per_run[run] = {p};
    m.fit.own[run] = Eigen::VectorXd::Constant(1, 0.01 + 0.001 * static_cast<double>(run));
  }
  d.verdict.ranked[0].effects = {"length_scale", "time_offset"};
  d.suggested.clear();
  return d;
}

inline diagnosis::Diagnosis sample_numerics() {
  diagnosis::Diagnosis d = sample_missing();
  d.verdict.word = "numerics";
  d.models[1] = sample::model({{find_effect("time_step"), ""}}, 1.02);
  d.verdict.ranked[0].effects = {"time_step"};
  d.suggested.clear();
  return d;
}

}  // namespace repose::test
