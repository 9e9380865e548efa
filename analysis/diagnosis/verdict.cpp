#include "analysis/diagnosis/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/two_samples.hpp"

namespace repose::diagnosis {
namespace {

bool all_of_site(const Evidence& e, EffectSite site) {
  return !e.sites.empty() && std::all_of(e.sites.begin(), e.sites.end(), [&](EffectSite s) { return s == site; });
}

std::string word_of(const Evidence& best) {
  if (best.effects.empty()) return "none";
  if (all_of_site(best, EffectSite::numerics)) return "numerics";
  for (const EffectSite site : best.sites)
    if (site != EffectSite::measurement && site != EffectSite::numerics) return "missing";
  return "measurement";
}

/// With the numerics that it needs, which are in the place of one.
std::size_t effects_of(const Evidence& e) { return e.effects.size() + (e.solved.empty() ? 0 : 1); }

/// Does `large` hold every effect of `small`? Then it is no rival of it, but the same with more.
bool nested(const Evidence& small, const Evidence& large) {
  return std::all_of(small.effects.begin(), small.effects.end(), [&](const std::string& name) {
    if (name == large.solved) return true;
    return std::find(large.effects.begin(), large.effects.end(), name) != large.effects.end();
  });
}

/// Log odds of `rival` against `best` that the scatter of their differences between runs leaves open; 0 where one cannot tell.
double log_odds_by_runs(const Evidence& best, const Evidence& rival) {
  std::vector<double> ours, theirs;  // a run that one of them holds to be impossible says nothing of the scatter
  for (std::size_t i = 0; i < best.per_run.size(); ++i)
    if (std::isfinite(best.per_run[i]) && std::isfinite(rival.per_run[i])) {
      ours.push_back(best.per_run[i]);
      theirs.push_back(rival.per_run[i]);
    }
  if (ours.size() < 2) return 0;
  const MeanDifference d = paired_difference(ours, theirs);
  const double p = std::min(0.5, d.p_greater());
  return std::log(p / (1 - p));
}

/// The uncertainty of a parameter that hardly matters has cost a rival that fits alike its likelihood, and the parameter as such a nat: that is twice.
void count_parameters_once(const std::vector<Evidence>& evidence, std::size_t best, double temper, std::vector<double>& score) {
  const Evidence& leader = evidence[best];
  if (best == 0) return;
  for (std::size_t i = 1; i < evidence.size(); ++i) {
    const Evidence& rival = evidence[i];
    const int more = rival.parameters - leader.parameters;
    if (i == best || more != 1 || effects_of(rival) != effects_of(leader) || rival.general > leader.general || rival.stated > leader.stated) continue;
    const double apart = std::max(leader.held_out_as_fitted - rival.held_out_as_fitted, 0.5 * (leader.train_gain - rival.train_gain));
    const double charged = std::max(0.0, rival.held_out_as_fitted - rival.held_out) / temper;
    if (apart <= alike_within * temper) score[i] += std::clamp(score[best] - cost_of_parameter * more - score[i], 0.0, charged);
  }
}

constexpr double as_good = 0.1;     // nats
constexpr double comparable = 0.8;  // of the leader's share of what was left over: a rival explains as much as that, or fits held-out runs better

/// Samples of one run share what is systematic in it; counted one by one they would make a winner of every rival.
void count_runs_not_samples(const std::vector<Evidence>& evidence, std::size_t best, std::vector<double>& score) {
  const Evidence& leader = evidence[best];
  const auto held_out_gain = [&](const Evidence& e) { return e.held_out - evidence[0].held_out; };
  if (best == 0 || leader.lack_of_fit * leader.lack_of_fit <= plainly_more_than_noise) return;
  for (std::size_t i = 1; i < evidence.size(); ++i) {
    const Evidence& rival = evidence[i];
    if (i == best || effects_of(rival) != effects_of(leader) || rival.train_gain < least_explained * leader.train_gain) continue;
    if (held_out_gain(rival) < least_explained * held_out_gain(leader)) continue;
    if (rival.explained < comparable * leader.explained && rival.held_out < leader.held_out) continue;
    score[i] = std::max(score[i], score[best] + log_odds_by_runs(leader, rival) - cost_of_stated * std::max(0, rival.stated - leader.stated));
  }
}

/// A flexible effect imitates much of anything: what plainly leaves more than noise must have halved the rest with each parameter. Numerics that do are a
/// part of the mismatch, and no answer to what is missing.
bool explains_enough(const Evidence& e) {
  if (e.effects.empty() || e.explained < (e.stated > 0 ? least_explained_by_stated : least_explained)) return false;
  const bool plain = e.lack_of_fit * e.lack_of_fit > plainly_more_than_noise;
  if (plain && all_of_site(e, EffectSite::numerics)) return false;
  if (plain && e.accelerations < least_explained) return false;
  if (e.lack_of_fit > far_beyond_noise && e.error_left > most_error_left) return false;
  return !plain || 1 - e.explained <= std::pow(1 - least_explained, std::max(1, e.form_parameters));
}

/// The best of those that explain enough; 0 if there is none. Those that do not are put behind it: they are no rivals.
std::size_t best_that_explains(const std::vector<Evidence>& evidence, std::vector<double>& score) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < evidence.size(); ++i)
    if (explains_enough(evidence[i]) && score[i] > score[0] && (best == 0 || score[i] > score[best])) best = i;
  if (best != 0)
    for (std::size_t i = 1; i < evidence.size(); ++i)
      if (!explains_enough(evidence[i])) score[i] = std::min(score[i], score[best] - 2 * indistinguishable_within);
  // One share above the limit and another just below it are no reason to call the first alone the truth.
  count_runs_not_samples(evidence, best, score);
  return best;
}

/// Where runs that were held out do not go where the mismatch is, they speak for nothing and against nothing; the fitted ones then do. Adds what these say
/// to the scores, and tells the best; 0 if that is the nominal, or what the held-out runs speak against.
std::size_t best_of_fitted_runs(const std::vector<Evidence>& evidence, double temper, std::vector<double>& score) {
  std::vector<double> of_all(score.size());
  for (std::size_t i = 0; i < score.size(); ++i) of_all[i] = score[i] + 0.5 * evidence[i].train_gain / temper;
  const auto best = static_cast<std::size_t>(std::max_element(of_all.begin(), of_all.end()) - of_all.begin());
  if (best == 0 || evidence[best].held_out < evidence[0].held_out - indistinguishable_within) return 0;
  if (of_all[best] - of_all[0] < indistinguishable_within) return 0;
  score = std::move(of_all);
  return best;
}

/// Of explanations that are as good as each other, one that blames the measurement before one that needs physics: rounding must not decide.
/// It is put first.
std::size_t best_of(const std::vector<Evidence>& evidence, std::vector<double>& score) {
  const auto best = static_cast<std::size_t>(std::max_element(score.begin(), score.end()) - score.begin());
  if (best == 0 || all_of_site(evidence[best], EffectSite::measurement) || all_of_site(evidence[best], EffectSite::numerics)) return best;
  for (std::size_t i = 1; i < evidence.size(); ++i)
    if (score[best] - score[i] < as_good && all_of_site(evidence[i], EffectSite::measurement)) {
      score[i] = score[best] + 1e-9;  // nats
      return i;
    }
  return best;
}

}  // namespace

Verdict judge(const std::vector<Evidence>& evidence, double lack_of_fit_p, double remaining_p, bool any_held_out) {
  Verdict verdict;
  const bool fits = lack_of_fit_p > level;
  std::vector<double> score;
  const auto worth = [&](const Evidence& e, double temper) {
    return (e.held_out - evidence[0].held_out) / temper - cost_of_parameter * e.parameters -
           cost_of_effect * static_cast<double>(effects_of(e)) - cost_of_generality * e.general - cost_of_stated * e.stated;
  };
  const auto temper_of = [&](const Evidence& e) { return std::max(1.0, e.lack_of_fit * e.lack_of_fit); };
  double temper = 1;
  for (int pass = 0; pass < 2; ++pass) {
    score.clear();
    for (const Evidence& e : evidence) score.push_back(worth(e, temper));
    const std::size_t best = best_of(evidence, score);
    verdict.best = static_cast<int>(best);
    temper = temper_of(evidence[best]);
  }
  count_runs_not_samples(evidence, static_cast<std::size_t>(verdict.best), score);
  // Without a lack of fit nothing is missing: at best the prior odds of the level are against it.
  if (fits) verdict.best = 0;
  if (!fits && verdict.best == 0 && remaining_p > level && any_held_out) {
    verdict.best = static_cast<int>(best_of_fitted_runs(evidence, temper, score));
    verdict.by_fitted_runs = verdict.best != 0;
  }
  bool unknown = !fits && verdict.best == 0;
  if (!fits && remaining_p <= level && !explains_enough(evidence[static_cast<std::size_t>(verdict.best)])) {
    const std::size_t named = best_that_explains(evidence, score);
    unknown = named == 0;
    if (!unknown) verdict.best = static_cast<int>(named);
  }
  if (!unknown) count_parameters_once(evidence, static_cast<std::size_t>(verdict.best), temper, score);
  const double explained = evidence[static_cast<std::size_t>(verdict.best)].explained;

  const double top = *std::max_element(score.begin(), score.end());
  double total = 0;
  for (std::size_t i = 0; i < evidence.size(); ++i) {
    double p = std::exp(score[i] - top);
    if (fits && i > 0) p *= level;
    if (fits && i == 0) p = 1;
    if (!fits && i == 0) p = std::min(p, lack_of_fit_p);
    verdict.ranked.push_back({evidence[i].effects, p, evidence[i].held_out, static_cast<int>(i)});
    total += p;
  }
  // What is left over after the best speaks for something outside the library.
  const double for_unknown = unknown ? std::max(1.0, 9 * total) : fits ? level * total : std::max(0.01, remaining_p <= level ? 1 - explained : 0.01) * total;
  verdict.ranked.push_back({{"unknown"}, for_unknown, 0, -1});
  total += for_unknown;
  for (Ranked& r : verdict.ranked) r.probability /= total;
  std::stable_sort(verdict.ranked.begin(), verdict.ranked.end(), [](const Ranked& a, const Ranked& b) { return a.probability > b.probability; });

  if (unknown) {
    verdict.word = "unknown";
    return verdict;
  }
  verdict.word = word_of(evidence[static_cast<std::size_t>(verdict.best)]);
  if (verdict.best == 0) return verdict;
  std::vector<std::string> open, others;  // names of the best that its nearest rival does without; names that stand in their place
  const Evidence& best = evidence[static_cast<std::size_t>(verdict.best)];
  std::vector<std::size_t> nearest(evidence.size() - 1);
  std::iota(nearest.begin(), nearest.end(), std::size_t{1});
  std::stable_sort(nearest.begin(), nearest.end(), [&](std::size_t a, std::size_t b) { return score[a] > score[b]; });
  for (const std::size_t i : nearest) {
    if (static_cast<int>(i) == verdict.best || score[static_cast<std::size_t>(verdict.best)] - score[i] > indistinguishable_within) continue;
    if (nested(best, evidence[i]) || nested(evidence[i], best)) continue;
    verdict.rivals.push_back(static_cast<int>(i));
    for (const std::string& name : others.empty() ? best.effects : std::vector<std::string>{})
      if (std::find(evidence[i].effects.begin(), evidence[i].effects.end(), name) == evidence[i].effects.end()) open.push_back(name);
    for (const std::string& name : evidence[i].effects)
      if (std::find(best.effects.begin(), best.effects.end(), name) == best.effects.end() &&
          std::find(others.begin(), others.end(), name) == others.end())
        others.push_back(name);
  }
  if (!others.empty()) {
    const bool numerics_alone = std::all_of(others.begin(), others.end(), [](const std::string& name) { return find_effect(name)->site == EffectSite::numerics; });
    std::vector<std::string> group{open.front()};
    for (const std::string& name : others)
      if (group.size() < 3) group.push_back(name);
    verdict.indistinguishable.push_back(group);
    if (verdict.word != "numerics" || !numerics_alone) verdict.word = "ambiguous";
  }
  return verdict;
}

}  // namespace repose::diagnosis
