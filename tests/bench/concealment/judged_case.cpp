#include "tests/bench/concealment/judged_case.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace repose::concealment {
namespace {

using nlohmann::json;
using Names = std::vector<std::string>;

const double detected = std::log(100.0);  // a likelihood ratio of 100 has a chance of at most 1 % under the nominal (Markov)
constexpr double same_fit = 2;            // [nats]

Names sorted(Names names) {
  for (std::string& name : names)
    if (name == "wall_friction") name = "friction";  // the same key
  std::sort(names.begin(), names.end());
  return names;
}

Names names_of(const json& list) { return sorted(list.get<Names>()); }

Names answer_of(const json& verdict) {
  if (verdict.at("verdict") == "unknown" || verdict.at("verdict") == "failed") return {verdict.at("verdict")};
  Names names;
  for (const json& missing : verdict.at("missing")) names.push_back(missing.at("effect"));
  return sorted(names);
}

double heldout(const json& verdict, const char* model, const char* what) {
  const json& side = verdict.at("fit").at("heldout").at(model);
  return side.contains(what) && side.at(what).is_number() ? side.at(what).get<double>() : NAN;
}

/// Held-out log likelihood of the hypothesis `names`; the best of all if it was not tried; NAN without any.
double log_likelihood(const json& verdict, const Names& names) {
  double best = NAN;
  for (const json& ranked : verdict.at("ranked")) {
    if (!ranked.contains("heldout_log_likelihood")) continue;
    const double value = ranked.at("heldout_log_likelihood");
    if (names_of(ranked.at("effects")) == names) return value;
    if (!(value <= best)) best = value;
  }
  return best;
}

double overlap_of(const json& first, const json& times) {
  const double from = first.at("t_start"), to = first.at("t_end");
  double common = 0, all = to - from;
  for (const json& t : times) {
    const double a = t.at(0), b = t.at(1);
    const double shared = std::max(0.0, std::min(to, b) - std::max(from, a));
    common += shared;
    all += (b - a) - shared;
  }
  return all > 0 ? common / all : 0;
}

void judge_place(const json& truth, const json& verdict, JudgedCase& c) {
  if (truth.at("where").empty() || verdict.value("where", json::array()).empty()) return;
  const json& first = verdict.at("where").front();
  const std::string run = first.at("run");
  if (!truth.at("where").contains(run)) return;
  const std::string phase = truth.at("effects").front().value("phase", "");
  if (!phase.empty()) c.phase_right = first.at("phase") == phase;
  c.overlap = overlap_of(first, truth.at("where").at(run));
}

void judge_coefficient(const json& truth, const json& verdict, JudgedCase& c) {
  if (!c.right_first || c.truth.empty() || c.level == "unknown") return;
  const json& effect = truth.at("effects").front();
  const std::string key = effect.at("parameter");
  for (const json& missing : verdict.at("missing")) {
    if (!missing.at("parameters").contains(key)) continue;
    const json& p = missing.at("parameters").at(key);
    const double value = effect.at("value");
    c.coefficient_error = std::abs(p.at("value").get<double>() - value) / std::abs(value - effect.at("null").get<double>());
    c.covered = p.at("lower") <= value && value <= p.at("upper");
  }
}

void judge_oracle(const json& verdict, const json& oracle, JudgedCase& c) {
  c.detectable = false;
  if (oracle.is_null() || oracle.at("verdict") == "failed" || verdict.at("verdict") == "failed") return;
  const double told = log_likelihood(oracle, c.truth), nothing = heldout(oracle, "nominal", "log_likelihood");
  c.detectable = told - nothing > detected;
  if (!c.detectable) return;
  const double gain = heldout(verdict, "extended", "log_likelihood") - heldout(verdict, "nominal", "log_likelihood");
  if (std::isfinite(gain)) c.gain_share = gain / (told - nothing);
  c.confounded = false;
  for (const json& ranked : verdict.at("ranked")) {
    const Names names = names_of(ranked.at("effects"));
    if (!ranked.contains("heldout_log_likelihood") || names == c.truth || names.size() != c.truth.size()) continue;
    if (ranked.at("heldout_log_likelihood").get<double>() > told - same_fit) c.confounded = true;
  }
}

}  // namespace

JudgedCase judge(const std::string& id, const json& truth, const json& verdict, const json& oracle, const json& suggested) {
  JudgedCase c;
  c.id = id;
  c.level = truth.at("level");
  c.family = truth.at("family");
  c.backend = truth.at("backend");
  c.sensor = truth.at("sensor");
  c.signal = truth.at("signal");
  for (const json& effect : truth.at("effects")) c.truth.push_back(c.level == "unknown" ? "unknown" : effect.at("effect").get<std::string>());
  c.truth = sorted(c.truth);
  c.word = verdict.at("verdict");
  c.wall_s = verdict.value("wall_s", 0.0);
  c.answer = answer_of(verdict);
  c.right_first = c.answer == c.truth;
  if (c.word == "failed") {
    c.brier = 2;
    return c;
  }
  std::set<std::string> said(c.answer.begin(), c.answer.end());
  c.ambiguous = c.word == "ambiguous";
  for (const json& group : verdict.at("indistinguishable"))
    for (const std::string& name : names_of(group)) said.insert(name);
  c.within_set = c.truth.empty() ? c.answer.empty() : std::all_of(c.truth.begin(), c.truth.end(), [&](const std::string& n) { return said.contains(n); });
  bool listed = false;
  for (const json& ranked : verdict.at("ranked")) {
    const bool is_truth = names_of(ranked.at("effects")) == c.truth;
    const double p = ranked.at("probability");
    c.brier += std::pow(p - (is_truth ? 1 : 0), 2);
    listed = listed || is_truth;
    if (names_of(ranked.at("effects")) == c.answer) c.top_probability = std::max(c.top_probability, p);
  }
  if (!listed) c.brier += 1;
  c.heldout_nominal = heldout(verdict, "nominal", "chi2_per_dof");
  c.heldout_extended = heldout(verdict, "extended", "chi2_per_dof");
  if (!c.truth.empty() && c.level != "unknown") judge_oracle(verdict, oracle, c);
  if (!suggested.is_null()) c.separated = answer_of(suggested) == c.truth && suggested.at("verdict") != "ambiguous";
  judge_place(truth, verdict, c);
  judge_coefficient(truth, verdict, c);
  return c;
}

}  // namespace repose::concealment
