#include "analysis/diagnosis/search.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "analysis/diagnosis/verdict.hpp"
#include "analysis/side_by_side.hpp"
#include "core/error.hpp"

namespace repose::diagnosis {
namespace {

constexpr int profile_points = 10;
constexpr int short_fit = 4;              // iterations that tell which candidates deserve more
constexpr std::size_t stated_fits = 2;    // constants of the scene that are fitted to the end
constexpr std::size_t guard_starts = 6;   // of the nominal, from candidates
constexpr double poor_fit = 2, led_astray = 100;  // chi^2 per degree of freedom
constexpr std::size_t bases_of_pairs = 2, pairs_each = 3, pairs_foreseen = 6;
constexpr std::size_t pairs_parted = 3;

bool holds(const Hypothesis& hypothesis, const Term& term) {
  return std::any_of(hypothesis.terms.begin(), hypothesis.terms.end(), [&](const Term& t) { return t.row == term.row && t.place == term.place; });
}

bool same_as_one_of(const std::vector<Fit>& fits, const Hypothesis& hypothesis) {
  return std::any_of(fits.begin(), fits.end(), [&](const Fit& fit) {
    return fit.layout.hypothesis.terms.size() == hypothesis.terms.size() &&
           std::all_of(hypothesis.terms.begin(), hypothesis.terms.end(), [&](const Term& t) { return holds(fit.layout.hypothesis, t); });
  });
}

}  // namespace

Search::Search(const Problem& problem, std::vector<std::size_t> train, SearchOptions options)
    : problem_(problem), train_(std::move(train)), options_(std::move(options)) {
  fit_options_.threads = options_.threads;
  fit_options_.interrupted = options_.interrupted;
}

void Search::run_nominal() {
  calibrate();
  lack_ = lack_in(fits_.front());
}

std::size_t Search::best() const {
  return static_cast<std::size_t>(std::min_element(fits_.begin(), fits_.end(), [](const Fit& a, const Fit& b) { return a.worth() < b.worth(); }) -
                                  fits_.begin());
}

void Search::run() {
  run_nominal();
  constexpr int rounds = 3;
  for (int round = 0; round < rounds && !stopped(); ++round) {
    if (!stopped() && lack_.p <= level) fit_numerics();
    take_step_of_maker();
    choose_base();
    const bool numerics_suffice = base_ != 0 && !stopped() && left_by(base_).p > level;
    if (!stopped() && !numerics_suffice) fit_singles();
    const bool look_further = !numerics_suffice && lack_.p <= level;
    if (!stopped() && look_further) fit_stated();
    if (!stopped() && look_further) fit_as_made();
    if (!stopped() && look_further && !engine_suffices()) fit_pairs();
    if (!stopped() && base_ != 0) fit_without_numerics();
    if (!stopped()) fit_parts_of_pairs();
    if (stopped() || !guard()) return;
    left_.clear();
    lack_ = lack_in(fits_.front());
  }
}

bool Search::stopped() {
  if (options_.interrupted && options_.interrupted()) interrupted_ = true;
  return interrupted_;
}

void Search::tell(const std::string& stage, double done, double total) const {
  if (options_.progress) options_.progress(stage, done, total);
}

/// Step 2: from several starts of every constant that nobody measured.
void Search::calibrate() {
  const Layout layout = problem_.layout({});
  Fit best = improved(begun_anew(problem_, improved(start_of(problem_, layout, train_)), train_, fit_options_));
  for (std::size_t i = 0; i < layout.shared.size() && !stopped(); ++i) {
    tell("calibrating the nominal scene", static_cast<double>(i), static_cast<double>(layout.shared.size()));
    for (const double share : {0.05, 0.2, 0.6}) {
      Fit start = best;
      const Parameter& p = layout.shared[i];
      start.shared[static_cast<Eigen::Index>(i)] =
          p.logarithmic ? p.lower * std::pow(p.upper / p.lower, share)
                        : p.lower + share * (std::min(p.upper, p.lower + 10 * std::max(1.0, std::abs(p.start))) - p.lower);
      Fit other = improved(start);
      if (other.chi2 < best.chi2 - gains_to_matter) best = std::move(other);  // a constant that does nothing stays where it was
    }
  }
  fits_.assign(1, std::move(best));
  compare_as_given();
}

bool Search::wanted(const Term& term) const {
  const std::vector<std::string>& only = options_.candidates;
  return only.empty() || std::find(only.begin(), only.end(), term.row->name) != only.end();
}

/// Steps 4 and 5 about any fit.
LackOfFit Search::lack_in(const Fit& fit) {
  LackOfFit lack;
  if (stopped()) return lack;
  // Where the path jumps with the step, slopes tell nothing of what is left, but its size does.
  if (!fit.layout.numerics.backend.empty() && leaves_noise(fit)) return lack;
  const Nuisance nuisance(problem_, fit);
  std::vector<Term> terms;
  for (const Term& term : possible_terms(problem_.bundle(), problem_.scale()))
    if (!holds(fit.layout.hypothesis, term) && wanted(term)) terms.push_back(term);
  lack.screened = screen_about(fit, nuisance, terms);
  const std::vector<Probe> probes = probes_of(lack.screened);
  if (!probes.empty()) {  // what does nothing to these recordings tests nothing
    lack.deviate = -std::numeric_limits<double>::infinity();
    for (const Screened& s : lack.screened) lack.deviate = std::max(lack.deviate, s.deviate);
    lack.p_effects = null_of(probes, nuisance.residual(), options_.replicas, options_.seed).p(lack.deviate);
  }
  tell("locating the mismatch", 0, 1);
  try {
    lack.places = locate(problem_, fit, nuisance, options_.located_runs, options_.replicas, options_.seed);
  } catch (const Error&) {
    if (!stopped()) throw;
    return {};
  }
  const auto physical = [](const Screened& s) { return s.term.row->site != EffectSite::measurement && !s.probes.empty(); };
  lack.tested = !lack.places.pieces.empty() || std::any_of(lack.screened.begin(), lack.screened.end(), physical);
  const double p_where = lack.places.pieces.empty() ? 1 : lack.places.pieces.front().p;
  for (const Located& l : lack.places.pieces) lack.deviate = std::max(lack.deviate, l.deviate);
  lack.p = std::min(1.0, 2 * std::min(lack.p_effects, p_where));
  // Far beyond noise something is wrong, be it only the start values, though no probe points at it.
  if (lack.tested && fit.per_dof() > far_beyond_noise * far_beyond_noise) lack.p = std::min(lack.p, 1.0 / (1 + options_.replicas));
  if (!fit.layout.numerics.backend.empty()) lack.p = lack.p_effects = 1.0 / (1 + options_.replicas);
  return lack;
}

std::vector<Screened> Search::screen_about(const Fit& fit, const Nuisance& nuisance, const std::vector<Term>& terms) {
  std::vector<Screened> screened(terms.size());
  std::atomic<int> done{0};
  std::mutex mutex;
  const std::string stage = fit.layout.hypothesis.terms.empty() ? "screening candidates" : "screening a second effect";
  side_by_side(terms.size(), options_.threads, [&](std::size_t i) {
    screened[i] = screen(problem_, fit, nuisance, terms[i], profile_points);
    const std::lock_guard lock(mutex);
    tell(stage, ++done, static_cast<double>(terms.size()));
  });
  std::stable_sort(screened.begin(), screened.end(), [](const Screened& a, const Screened& b) { return a.reached < b.reached; });
  return screened;
}

/// The fit of `base` with more terms, begun where the screening reached most; where the base is poor also from the start values as
/// read off the data; and from nothing, so that it is never worse than `base` (step 3). What is then off by many sigma is followed from the beginning of the records.
Fit Search::extended(const Fit& base, const std::vector<const Screened*>& terms, int iterations) const {
  Hypothesis hypothesis = without_numerics(base.layout.hypothesis);
  for (const Screened* s : terms) hypothesis.terms.push_back(s->term);
  Layout layout = problem_.layout(hypothesis);
  layout.numerics = base.layout.numerics;
  FitOptions options = fit_options_;
  options.iterations = iterations;
  const auto begin = [&](bool at_screened, bool from_data) {
    Fit start = start_of(problem_, layout, train_);
    start.shared.head(base.shared.size()) = base.shared;
    Eigen::Index at = base.shared.size();
    for (const Screened* s : terms) {
      for (std::size_t i = 0; at_screened && i < s->shared_start.size(); ++i) start.shared[at + static_cast<Eigen::Index>(i)] = s->shared_start[i];
      at += static_cast<Eigen::Index>(s->shared_start.size());
    }
    for (std::size_t run = 0; run < start.own.size(); ++run)
      for (Eigen::Index i = 0; i < base.own[run].size(); ++i)
        start.own[run][i] = from_data ? layout.per_run[run][static_cast<std::size_t>(i)].begin() : base.own[run][i];
    // Start values first: those that suit the base do not suit the screened point, and would drive the fit away from it.
    if (at_screened) start = minimise_own(problem_, evaluated(problem_, std::move(start)), train_, options);
    return minimise(problem_, start, options);
  };
  Fit best = begin(true, false);
  if (base.per_dof() > poor_fit || terms.front()->from_data)
    if (Fit other = begin(true, true); other.chi2 < best.chi2) best = std::move(other);
  if (best.chi2 > base.chi2 - gains_to_matter)
    if (Fit other = begin(false, false); other.chi2 < best.chi2) best = std::move(other);
  if (best.per_dof() > led_astray && terms.size() == 1 && without_numerics(base.layout.hypothesis).terms.empty() && !terms.front()->tried.empty()) {
    Fit start = start_of(problem_, layout, train_);
    start.shared.head(base.shared.size()) = base.shared;
    for (std::size_t i = 0; i < terms.front()->shared_start.size(); ++i) start.shared[base.shared.size() + static_cast<Eigen::Index>(i)] = terms.front()->shared_start[i];
    for (std::size_t run = 0; run < start.own.size(); ++run)
      for (Eigen::Index i = 0; i < start.own[run].size(); ++i) start.own[run][i] = layout.per_run[run][static_cast<std::size_t>(i)].begin();
    if (Fit other = followed(problem_, start, terms.front()->tried, options); other.chi2 < best.chi2) best = std::move(other);
  }
  return best;
}

/// To the end together, and then each run by itself: one that is stuck behind an impact holds the others back no longer.
Fit Search::improved(const Fit& fit) const { return minimise_own(problem_, minimise(problem_, fit, fit_options_), train_, fit_options_); }

Fit* Search::find(const Hypothesis& hypothesis) {
  const auto found = std::find_if(fits_.begin(), fits_.end(), [&](const Fit& fit) { return same_as_one_of({fit}, hypothesis); });
  return found == fits_.end() ? nullptr : &*found;
}

void Search::keep(Fit fit) {
  if (std::isfinite(fit.chi2)) fits_.push_back(std::move(fit));
}

/// Step 7: a short fit of twice as many as are wanted, then the best of these to the end.
void Search::fit_singles() {
  const Fit nominal = fits_[base_];
  std::vector<const Screened*> chosen;
  for (const Screened& s : left_by(base_).screened)
    if (!s.probes.empty() && !find({{s.term}}) && chosen.size() < 2 * static_cast<std::size_t>(options_.joint_fits)) chosen.push_back(&s);
  std::vector<Fit> begun;
  for (std::size_t i = 0; i < chosen.size() && !stopped(); ++i) {
    tell("trying " + chosen[i]->term.row->name, static_cast<double>(i), static_cast<double>(chosen.size()));
    begun.push_back(extended(nominal, {chosen[i]}, short_fit));
  }
  std::stable_sort(begun.begin(), begun.end(), [](const Fit& a, const Fit& b) { return a.worth() < b.worth(); });
  if (begun.size() > static_cast<std::size_t>(options_.joint_fits)) begun.resize(static_cast<std::size_t>(options_.joint_fits));
  for (std::size_t i = 0; i < begun.size() && !stopped(); ++i) {
    tell("fitting " + begun[i].layout.hypothesis.label(), static_cast<double>(i), static_cast<double>(begun.size()));
    keep(improved(begun[i]));
  }
}

/// Constants that the scene states may be wrong, too. They are no reason for an alarm, and cost more (verdict.hpp).
void Search::fit_stated() {
  const Fit base = fits_[base_];
  std::vector<Term> terms = stated_terms(problem_.bundle(), problem_.scale());
  std::erase_if(terms, [&](const Term& term) { return !wanted(term) || find({{term}}); });
  if (terms.empty()) return;
  std::vector<Fit> begun;
  for (const Screened& s : screen_about(base, Nuisance(problem_, base), terms)) {
    if (s.probes.empty() || stopped()) continue;
    tell("trying another value of " + s.term.row->name, static_cast<double>(begun.size()), static_cast<double>(terms.size()));
    begun.push_back(extended(base, {&s}, short_fit));
  }
  std::stable_sort(begun.begin(), begun.end(), [](const Fit& a, const Fit& b) { return a.worth() < b.worth(); });
  for (std::size_t i = 0; i < std::min<std::size_t>(stated_fits, begun.size()) && !stopped(); ++i) keep(improved(begun[i]));
}

const LackOfFit& Search::left_by(std::size_t fit) {
  if (fit == 0) return lack_;
  const std::string label = fits_[fit].layout.hypothesis.label();
  const auto found = left_.find(label);
  return found != left_.end() ? found->second : left_.emplace(label, lack_in(fits_[fit])).first->second;
}

/// Beside every single that was fitted, however little it explains alone: a wrong ruler outweighs what two right effects leave.
std::vector<std::pair<std::size_t, std::size_t>> Search::foresee_pairs(const std::vector<std::size_t>& singles, const std::vector<Screened>& screened) {
  struct Foreseen {
    double reached;
    std::size_t first, second;
  };
  std::vector<Foreseen> all;
  for (const std::size_t first : singles) {
    const Nuisance nuisance(problem_, fits_[first]);
    for (std::size_t second = 0; second < screened.size() && !stopped(); ++second)
      if (!screened[second].probes.empty() && screened[second].term.row != fits_[first].layout.hypothesis.terms.front().row)
        all.push_back({reached_beside(nuisance, screened[second]), first, second});
  }
  std::stable_sort(all.begin(), all.end(), [](const Foreseen& a, const Foreseen& b) { return a.reached < b.reached; });
  std::vector<std::pair<std::size_t, std::size_t>> best;
  for (std::size_t i = 0; i < std::min(pairs_foreseen, all.size()); ++i) best.emplace_back(all[i].first, all[i].second);
  return best;
}

std::vector<std::size_t> Search::singles_by_worth() const {
  std::vector<std::size_t> order;
  for (std::size_t i = 1; i < fits_.size(); ++i)
    if (without_numerics(fits_[i].layout.hypothesis).terms.size() == 1) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return fits_[a].worth() < fits_[b].worth(); });
  return order;
}

/// Second terms beside the best singles, while what these leave is more than noise; and pairs that help only together.
void Search::fit_pairs() {
  const std::vector<std::size_t> order = singles_by_worth();
  if (!order.empty() && left_by(order.front()).p > level) return;
  std::vector<Fit> begun;
  const auto try_pair = [&](const Fit& base, const std::vector<const Screened*>& terms) {
    Hypothesis pair = without_numerics(base.layout.hypothesis);
    for (const Screened* s : terms) pair.terms.push_back(s->term);
    if (same_as_one_of(begun, pair) || find(pair) || stopped()) return;
    tell("trying " + pair.label(), static_cast<double>(begun.size()), static_cast<double>((bases_of_pairs + 1) * pairs_each + pairs_foreseen));
    begun.push_back(extended(base, terms, short_fit));
  };
  std::size_t missing = 0;  // bases that are no stated constants: these take no one's place
  for (std::size_t n = 0; n < order.size() && missing < bases_of_pairs && !stopped(); ++n) {
    const Fit base = fits_[order[n]];
    if (stated_in(base.layout.hypothesis) == 0) ++missing;
    const LackOfFit& left = left_by(order[n]);
    std::size_t tried = 0;
    for (const Screened& s : left.screened) {
      if (tried == pairs_each || left.p_effects > level) break;
      if (s.probes.empty() || s.term.row == base.layout.hypothesis.terms.front().row) continue;
      try_pair(base, {&s});
      ++tried;
    }
  }
  const std::vector<Screened>& screened = left_by(base_).screened;
  for (const auto& [first, second] : foresee_pairs(order, screened)) try_pair(fits_[first], {&screened[second]});
  const Nuisance nuisance(problem_, fits_[base_]);
  const std::vector<ScreenedPair> together = screen_pairs(screened, nuisance.residual(), pair_gain);
  for (std::size_t i = 0; i < std::min(pairs_each, together.size()); ++i)
    try_pair(fits_[base_], {&screened[together[i].first], &screened[together[i].second]});
  std::stable_sort(begun.begin(), begun.end(), [](const Fit& a, const Fit& b) { return a.worth() < b.worth(); });
  for (std::size_t i = 0; i < std::min<std::size_t>(4, begun.size()) && !stopped(); ++i)
    if (!find(begun[i].layout.hypothesis)) keep(improved(begun[i]));
}

/// Each effect of the best pairs alone, begun where the pair ended: what the other one was needed for may only have been the way there.
void Search::fit_parts_of_pairs() {
  std::vector<Fit> pairs;
  double best_single = std::numeric_limits<double>::infinity();
  for (const Fit& fit : fits_) {
    const std::size_t terms = without_numerics(fit.layout.hypothesis).terms.size();
    if (terms == 1) best_single = std::min(best_single, fit.chi2);
    if (terms == 2) pairs.push_back(fit);
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Fit& a, const Fit& b) { return a.worth() < b.worth(); });
  for (std::size_t i = 0; i < std::min(pairs_parted, pairs.size()); ++i)
    for (const Term& term : pairs[i].layout.hypothesis.terms) {
      if (stopped()) return;
      const Hypothesis alone{{term}};
      Fit* const known = find(alone);
      const double wanted = known == nullptr ? best_single : known->chi2;
      tell(alone.label() + " from where " + pairs[i].layout.hypothesis.label() + " ended", static_cast<double>(i), static_cast<double>(pairs_parted));
      Layout layout = problem_.layout(alone);
      layout.numerics = pairs[i].layout.numerics;
      Fit again = improved_if_promising(evaluated(problem_, begun_within(problem_, layout, pairs[i])), wanted);
      if (!(again.chi2 < wanted - gains_to_matter)) continue;
      left_.erase(alone.label());  // what the fit before it left is no longer so
      if (known != nullptr && known->layout.numerics.backend != again.layout.numerics.backend && !(again.chi2 < wanted - pair_gain)) continue;  // an engine has its cost
      if (known == nullptr)
        keep(std::move(again));
      else
        *known = std::move(again);
    }
}

/// A short fit, and to the end only what thereby comes below `wanted`, or close to it.
Fit Search::improved_if_promising(const Fit& start, double wanted) const {
  FitOptions options = fit_options_;
  options.iterations = short_fit;
  Fit begun = minimise(problem_, start, options);
  return begun.chi2 < promising * wanted ? improved(begun) : begun;
}

/// Step 3, the other way: the nominal begun where candidates ended, those first that it fits best as they are. If that gains, all
/// fits are begun again from there.
bool Search::guard() {
  bool gained = false;
  std::vector<std::size_t> plain{0};
  if (base_ != 0) plain.push_back(base_);
  for (const std::size_t n : plain) {
    const Fit before = fits_[n];
    std::vector<Fit> starts;
    for (std::size_t m = 1; m < fits_.size() && !stopped(); ++m) {
      if (m == n) continue;
      Fit start = before;
      start.shared = fits_[m].shared.head(before.shared.size());
      for (std::size_t run = 0; run < start.own.size(); ++run) start.own[run] = fits_[m].own[run].head(before.own[run].size());
      starts.push_back(evaluated(problem_, std::move(start)));
    }
    std::stable_sort(starts.begin(), starts.end(), [](const Fit& a, const Fit& b) { return a.chi2 < b.chi2; });
    if (starts.size() > guard_starts) starts.resize(guard_starts);
    for (std::size_t i = 0; i < starts.size() && !stopped(); ++i) {
      tell("the nominal scene from where candidates ended", static_cast<double>(i), static_cast<double>(starts.size()));
      if (Fit again = improved_if_promising(starts[i], fits_[n].chi2); again.chi2 < fits_[n].chi2) fits_[n] = std::move(again);
    }
    // Less than this changes no verdict.
    gained = gained || fits_[n].chi2 < before.chi2 - std::max(gains_to_matter, 1e-3 * before.chi2);
  }
  if (!gained) return false;
  ++improved_;
  const Fit& nominal = fits_[base_];
  for (std::size_t m = 1; m < fits_.size() && !stopped(); ++m) {
    if (m == base_) continue;
    tell("candidates from where the nominal scene ended", static_cast<double>(m), static_cast<double>(fits_.size()));
    Fit start = fits_[m];
    start.shared.head(nominal.shared.size()) = nominal.shared;
    for (std::size_t run = 0; run < start.own.size(); ++run) start.own[run].head(nominal.own[run].size()) = nominal.own[run];
    if (Fit again = improved_if_promising(start, fits_[m].chi2); again.chi2 < fits_[m].chi2) fits_[m] = std::move(again);
  }
  return true;
}

}  // namespace repose::diagnosis
