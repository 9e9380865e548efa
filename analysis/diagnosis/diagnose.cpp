#include "analysis/diagnosis/diagnose.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <numeric>
#include <optional>
#include <thread>

#include "analysis/diagnosis/combination.hpp"
#include "core/error.hpp"
#include "core/random.hpp"

namespace repose::diagnosis {
namespace {

constexpr int profile_points = 10;
constexpr double ninety = 1.645;            // standard errors of a 90 % interval
constexpr double gains_to_matter = 1e-3;    // of chi^2, absolute: below it two fits are the same

struct Split {
  std::vector<std::size_t> train, held;
};

/// At most `limit` of the list, evenly spread.
std::vector<std::size_t> thinned(const std::vector<std::size_t>& list, int limit) {
  const auto n = static_cast<std::size_t>(limit);
  if (list.size() <= n) return list;
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < n; ++i) result.push_back(list[i * list.size() / n]);
  return result;
}

Split split_runs(const Bundle& bundle, const DiagnoseOptions& options, std::vector<std::string>& notes) {
  Split split;
  if (bundle.split_given) {
    for (std::size_t i = 0; i < bundle.runs.size(); ++i) (bundle.runs[i].held_out ? split.held : split.train).push_back(i);
    if (split.train.empty()) throw Error("runs", "all runs are held out: nothing is left to fit", "let some runs have `held_out: false`");
  } else {
    std::vector<std::size_t> order(bundle.runs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    Random random(options.seed, 5);
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
    const std::size_t held = order.size() < 2 ? 0 : std::max<std::size_t>(1, order.size() / 3);
    split.held.assign(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(held));
    split.train.assign(order.begin() + static_cast<std::ptrdiff_t>(held), order.end());
    std::sort(split.held.begin(), split.held.end());
    std::sort(split.train.begin(), split.train.end());
    notes.push_back(fmt::format("No run says whether it is held out: {} of {} were, chosen by seed {}.", held, order.size(), options.seed));
  }
  const Split used{thinned(split.train, options.max_train_runs), thinned(split.held, options.max_held_out_runs)};
  if (used.train.size() < split.train.size() || used.held.size() < split.held.size())
    notes.push_back(fmt::format("Used {} of {} runs for fitting and {} of {} held-out ones, evenly spread over the list.", used.train.size(),
                                split.train.size(), used.held.size(), split.held.size()));
  if (used.held.empty()) notes.push_back("Nothing is held out: candidates are weighed on the data that they were fitted to, less what their parameters cost.");
  return used;
}

/// Calls task(i) for all i on some threads; the first exception is thrown again.
void side_by_side(std::size_t count, int threads, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) try {
        task(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = count;
      }
  };
  std::vector<std::jthread> crew;
  for (int t = 1; t < threads; ++t) crew.emplace_back(work);
  work();
  crew.clear();
  if (failure) std::rethrow_exception(failure);
}

class Diagnosing {
 public:
  Diagnosing(const Bundle& bundle, const Simulate& simulate, const DiagnoseOptions& options)
      : options_(options), split_(split_runs(bundle, options, result_.notes)), problem_(bundle, all_runs(), simulate) {
    for (std::size_t i = 0; i < problem_.runs().size(); ++i) {
      (i < split_.train.size() ? train_ : held_).push_back(i);
      result_.run_ids.push_back(problem_.runs()[i].run->id);
    }
    result_.train_runs = train_.size();
    result_.noise = problem_.noise();
    result_.replicas = options.replicas;
    fit_options_.threads = options.threads;
    fit_options_.interrupted = options.interrupted;
    note_horizons(bundle);
  }

  Diagnosis run() {
    calibrate();
    screen_candidates();
    if (!stopped()) fit_candidates();
    if (!stopped()) fit_pairs();
    if (!stopped()) try_numerics();
    guard_nominal();
    finish();
    return std::move(result_);
  }

 private:
  std::vector<std::size_t> all_runs() const {
    std::vector<std::size_t> all = split_.train;
    all.insert(all.end(), split_.held.begin(), split_.held.end());
    return all;
  }

  bool stopped() {
    if (options_.interrupted && options_.interrupted()) result_.interrupted = true;
    return result_.interrupted;
  }

  void tell(const std::string& stage, double done, double total) const {
    if (options_.progress) options_.progress(stage, done, total);
  }

  void note_horizons(const Bundle& bundle) {
    for (std::size_t i = 0; i < problem_.runs().size(); ++i) {
      const RunData& data = problem_.runs()[i];
      double end = 0;
      for (const Observation& o : data.run->observations)
        if (!o.time.empty()) end = std::max(end, o.time.back());
      if (data.horizon < end)
        result_.notes.push_back(fmt::format("Run {} is compared up to {:.3g} s of {:.3g} s: beyond it the noise of its start no longer acts linearly.",
                                            data.run->id, data.run->from + data.horizon, data.run->from + end));
    }
    for (const std::string& warning : bundle.warnings) result_.notes.push_back(warning);
  }

  /// Step 2: from several starts of every constant that nobody measured.
  void calibrate() {
    const Layout layout = problem_.layout({});
    Fit best = minimise(problem_, start_of(problem_, layout, train_), fit_options_);
    for (std::size_t i = 0; i < layout.shared.size() && !stopped(); ++i)
      for (const double share : {0.05, 0.2, 0.6}) {
        tell("calibrating the nominal scene", static_cast<double>(i), static_cast<double>(layout.shared.size()));
        Fit start = best;
        const Parameter& p = layout.shared[i];
        start.shared[static_cast<Eigen::Index>(i)] = p.lower + share * (std::min(p.upper, p.lower + 10 * std::max(1.0, std::abs(p.start))) - p.lower);
        const Fit other = minimise(problem_, start, fit_options_);
        if (other.chi2 < best.chi2 - gains_to_matter) best = other;  // a constant that does nothing stays where it was
      }
    result_.models.clear();
    result_.models.emplace_back();
    result_.models.back().fit = best;
    nominal_.emplace(problem_, best);
  }

  const Fit& nominal_fit() const { return result_.models.front().fit; }

  /// Steps 4 to 7: what each effect could explain at first order; where an unknown force would help.
  void screen_candidates() {
    std::vector<Term> terms = possible_terms(problem_.bundle().scene, problem_.bundle().calibrate, problem_.scale());
    if (const auto& only = options_.candidates; !only.empty())
      std::erase_if(terms, [&](const Term& term) { return std::find(only.begin(), only.end(), term.row->name) == only.end(); });
    result_.screened = screen_about(nominal_fit(), *nominal_, terms, "screening candidates");
    screen_null_ = null_of(result_.screened, *nominal_);
    double largest = 0;
    for (const Screened& s : result_.screened) largest = std::max(largest, s.gain);
    const double p_screen = screen_null_.p(largest);
    tell("locating the mismatch", 0, 1);
    result_.where = locate(problem_, nominal_fit(), *nominal_, 4, options_.replicas, options_.seed);
    result_.depends_on = dependence_of(result_.where);
    const double p_where = result_.where.empty() ? 1 : result_.where.front().p;
    result_.lack_of_fit_p = std::min(1.0, 2 * std::min(p_screen, p_where));
  }

  std::vector<Screened> screen_about(const Fit& fit, const Nuisance& nuisance, const std::vector<Term>& terms, const std::string& stage) {
    std::vector<Screened> screened(terms.size());
    std::atomic<int> done{0};
    std::mutex mutex;
    side_by_side(terms.size(), options_.threads, [&](std::size_t i) {
      screened[i] = screen(problem_, fit, nuisance, terms[i], profile_points);
      const std::lock_guard lock(mutex);
      tell(stage, ++done, static_cast<double>(terms.size()));
    });
    std::stable_sort(screened.begin(), screened.end(), [](const Screened& a, const Screened& b) { return a.gain > b.gain; });
    return screened;
  }

  NullDistribution null_of(const std::vector<Screened>& screened, const Nuisance& nuisance) const {
    std::vector<Eigen::MatrixXd> bases;
    for (const Screened& s : screened) bases.push_back(s.basis);
    return largest_gains(bases, nuisance.size(), options_.replicas, options_.seed);
  }

  /// The fit of `base` with one term more, from the screened start and from nothing: never worse than `base` (step 3).
  FittedHypothesis extended(const Fit& base, const Screened& screened) {
    FittedHypothesis model;
    model.hypothesis = base.layout.hypothesis;
    model.hypothesis.terms.push_back(screened.term);
    const Layout layout = problem_.layout(model.hypothesis);
    const auto begin = [&](bool at_screened) {
      Fit start = start_of(problem_, layout, train_);
      start.shared.head(base.shared.size()) = base.shared;
      for (std::size_t i = 0; at_screened && i < screened.shared_start.size(); ++i)
        start.shared[base.shared.size() + static_cast<Eigen::Index>(i)] = screened.shared_start[i];
      for (std::size_t run = 0; run < start.own.size(); ++run) start.own[run].head(base.own[run].size()) = base.own[run];
      return minimise(problem_, start, fit_options_);
    };
    model.fit = begin(true);
    if (model.fit.chi2 > base.chi2 - gains_to_matter) {
      const Fit other = begin(false);
      if (other.chi2 < model.fit.chi2) model.fit = other;
    }
    return model;
  }

  void fit_candidates() {
    const auto count = std::min<std::size_t>(result_.screened.size(), static_cast<std::size_t>(options_.joint_fits));
    for (std::size_t i = 0; i < count && !stopped(); ++i) {
      const Screened& s = result_.screened[i];
      if (!(s.gain > 0)) continue;
      tell("fitting candidates: " + s.term.row->name, static_cast<double>(i), static_cast<double>(count));
      result_.models.push_back(extended(nominal_fit(), s));
    }
  }

  /// Greedy second terms, only where what the best single leaves is more than noise.
  void fit_pairs() {
    const std::size_t best = best_by_gain();
    if (best == 0 || result_.lack_of_fit_p > level) return;
    const Fit base = result_.models[best].fit;
    const Nuisance left(problem_, base);
    std::vector<Term> terms;
    for (const Screened& s : result_.screened)
      if (s.term.row != base.layout.hypothesis.terms.front().row) terms.push_back(s.term);
    const std::vector<Screened> second = screen_about(base, left, terms, "screening a second effect");
    if (second.empty()) return;
    const double p_screen = null_of(second, left).p(second.front().gain);
    const std::vector<Located> where = locate(problem_, base, left, 4, options_.replicas, options_.seed);
    result_.remaining_p = std::min(1.0, 2 * std::min(p_screen, where.empty() ? 1 : where.front().p));
    remaining_of_ = best;
    if (p_screen > level) return;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, second.size()) && !stopped(); ++i) {
      tell("fitting pairs: " + second[i].term.row->name, static_cast<double>(i), 3);
      result_.models.push_back(extended(base, second[i]));
    }
  }

  std::size_t best_by_gain() const {
    std::size_t best = 0;
    const auto worth = [&](std::size_t i) {
      const Fit& fit = result_.models[i].fit;
      return fit.chi2 + 2 * static_cast<double>(fit.parameters);
    };
    for (std::size_t i = 1; i < result_.models.size(); ++i)
      if (worth(i) < worth(best)) best = i;
    return best;
  }

  /// Does the mismatch go away with a quarter of the step and a tenth of the tolerance?
  void try_numerics() {
    if (result_.lack_of_fit_p > level) return;
    tell("a finer step", 0, 1);
    FittedHypothesis model;
    model.hypothesis.terms.push_back({find_effect("time_step"), ""});
    Fit start = nominal_fit();
    start.layout.hypothesis = model.hypothesis;
    start.layout.step_factor = 0.25;
    start.layout.tolerance_factor = 0.1;
    model.fit = minimise(problem_, start, fit_options_);
    result_.models.push_back(std::move(model));
  }

  /// Step 3, the other way: the nominal begun where each candidate ended, until nothing gains.
  void guard_nominal() {
    bool gained = false;
    const Fit before = nominal_fit();
    for (std::size_t m = 1; m < result_.models.size() && !stopped(); ++m) {
      const Fit& other = result_.models[m].fit;
      Fit start = before;
      start.shared = other.shared.head(before.shared.size());
      for (std::size_t run = 0; run < start.own.size(); ++run) start.own[run] = other.own[run].head(before.own[run].size());
      const Fit again = minimise(problem_, start, fit_options_);
      if (again.chi2 < nominal_fit().chi2 - gains_to_matter) {
        result_.models.front().fit = again;
        gained = true;
      }
    }
    if (!gained || guarded_++ >= 2) return;
    result_.notes.push_back("The nominal scene fitted better from where a candidate had ended; everything was judged anew from there.");
    const Fit better = nominal_fit();
    result_.models.resize(1);
    result_.models.front().fit = better;
    nominal_.emplace(problem_, better);
    remaining_of_ = 0;
    screen_candidates();
    if (!stopped()) fit_candidates();
    if (!stopped()) fit_pairs();
    if (!stopped()) try_numerics();
    guard_nominal();
  }

  void weigh(FittedHypothesis& model) {
    model.scale = std::max(1.0, std::sqrt(model.fit.per_dof()));
    model.train = score_of(problem_, model.fit);
    const Layout plain = problem_.layout({});
    model.extra_parameters = static_cast<int>(model.fit.layout.shared.size() - plain.shared.size());
    const std::vector<std::size_t>& judged = held_.empty() ? train_ : held_;
    for (const std::size_t run : judged)
      model.extra_parameters += static_cast<int>(model.fit.layout.per_run[run].size() - plain.per_run[run].size());
    if (held_.empty()) {
      model.held_out = model.train;
    } else {
      model.held_fit = minimise_own(problem_, model.fit, held_, fit_options_);
      model.held_out = score_of(problem_, model.held_fit);
    }
  }

  void estimate(FittedHypothesis& model) const {
    const Eigen::VectorXd se = standard_errors(problem_, model.fit, model.scale);
    for (std::size_t i = 0; i < model.fit.layout.shared.size(); ++i) {
      const Parameter& p = model.fit.layout.shared[i];
      const auto k = static_cast<Eigen::Index>(i);
      ParameterEstimate e;
      e.name = p.component < 0 ? p.key : fmt::format("{}.{}", p.key, p.component);
      e.unit = p.unit;
      e.effect = p.effect;
      e.value = model.fit.shared[k];
      e.lower = std::max(p.lower, e.value - ninety * se[k]);
      e.upper = std::min(p.upper, e.value + ninety * se[k]);
      model.parameters.push_back(e);
    }
  }

  /// Parameters that are determined only together: said in words, for their intervals alone look like ignorance.
  void note_combinations(const FittedHypothesis& model) {
    for (const std::vector<std::size_t>& group : only_together(information_of(problem_, model.fit))) {
      std::vector<std::string> names;
      for (const std::size_t i : group) names.push_back(model.fit.layout.shared[i].key);
      result_.notes.push_back(fmt::format("Only a combination of {} is determined by these recordings, not each of them: give one of them to know the others.",
                                          fmt::join(names, ", ")));
    }
  }

  void finish() {
    std::vector<Evidence> evidence;
    for (std::size_t i = 0; i < result_.models.size(); ++i) {
      tell("runs that were held out", static_cast<double>(i), static_cast<double>(result_.models.size()));
      FittedHypothesis& m = result_.models[i];
      weigh(m);
      Evidence e;
      e.effects = m.hypothesis.names();
      for (const Term& term : m.hypothesis.terms) e.sites.push_back(term.row->site);
      e.held_out = m.held_out.log_likelihood;
      e.train_gain = nominal_fit().chi2 - m.fit.chi2;
      e.parameters = m.extra_parameters;
      e.lack_of_fit = m.scale;
      evidence.push_back(e);
    }
    const std::size_t leading = best_by_gain();
    const auto excess = [&](const Fit& fit) { return std::max(0.0, fit.chi2 - static_cast<double>(fit.samples - fit.parameters)); };
    const double before = excess(nominal_fit());
    result_.explained = before > 0 ? 1 - excess(result_.models[leading].fit) / before : 0;
    if (leading != remaining_of_) result_.remaining_p = result_.models[leading].scale > 1.2 ? 1.0 / (options_.replicas + 1) : 1;
    result_.verdict = judge(evidence, result_.lack_of_fit_p, result_.remaining_p, result_.explained);
    result_.best = static_cast<std::size_t>(result_.verdict.best);
    FittedHypothesis& best = result_.models[result_.best];
    estimate(result_.models.front());
    if (result_.best != 0) estimate(best);
    note_combinations(best);
    const PairedGain gain = paired_gain(result_.models.front().held_out, best.held_out);
    result_.paired_p = gain.p;
    result_.effect_size = gain.effect_size;
    suggest();
    keep_residuals();
    tell_recorded_times();
    result_.extended_scene = emit_yaml(problem_.extended_scene(best.fit.layout, best.fit.shared));
    result_.simulations = problem_.simulations();
  }

  /// Step 9: the best against its nearest rival of the same size, or against nothing missing.
  void suggest() {
    if (result_.best == 0 || stopped()) return;
    std::size_t rival = 0;
    for (const Ranked& r : result_.verdict.ranked)
      if (r.model > 0 && static_cast<std::size_t>(r.model) != result_.best) {
        rival = static_cast<std::size_t>(r.model);
        break;
      }
    tell("a recording that would tell more", 0, 1);
    result_.suggested.push_back(recording_that_parts(problem_, result_.models[result_.best].fit, result_.models[rival].fit));
  }

  void keep_residuals() {
    const FittedHypothesis& nominal = result_.models.front();
    const FittedHypothesis& best = result_.models[result_.best];
    const auto keep = [&](const Fit& plain, const Fit& full) {
      for (const std::size_t run : plain.runs) {
        if (kept_ >= 6) return;
        ++kept_;
        const Eigen::VectorXd a = problem_.plain_residual(plain.layout, run, plain.shared, plain.own[run]);
        const Eigen::VectorXd b = problem_.plain_residual(full.layout, run, full.shared, full.own[run]);
        for (const Channel& c : problem_.runs()[run].channels) {
          const auto n = static_cast<Eigen::Index>(c.time.size());
          if (n == 0) continue;
          ResidualSample s{result_.run_ids[run], c.observable, c.time, {}, {}};
          for (double& t : s.time) t += problem_.runs()[run].run->from;
          if (c.observable == "position") s.channel += std::string(" ") + "xyz"[c.axis];
          if (c.observable == "orientation") s.channel += std::string(" about ") + "xyz"[c.axis];
          if (!c.body.empty()) s.channel = c.body + ": " + s.channel;
          s.nominal.assign(a.data() + c.first, a.data() + c.first + n);
          s.extended.assign(b.data() + c.first, b.data() + c.first + n);
          result_.residuals.push_back(std::move(s));
        }
      }
    };
    // The runs where the mismatch was located come first: the report shades it.
    Fit fitted = nominal.fit;
    const auto located_in = [&](std::size_t run) {
      return std::any_of(result_.where.begin(), result_.where.end(), [&](const Located& l) { return l.run == run && l.p <= level; });
    };
    std::stable_partition(fitted.runs.begin(), fitted.runs.end(), located_in);
    if (!result_.where.empty())
      std::stable_partition(fitted.runs.begin(), fitted.runs.end(), [&](std::size_t run) { return run == result_.where.front().run; });
    if (!held_.empty() && fitted.runs.size() > 3) fitted.runs.resize(3);
    keep(fitted, best.fit);
    if (!held_.empty()) keep(nominal.held_fit, best.held_fit);
  }

  /// Simulated time begins where a run does; what is told is on the recording's own clock.
  void tell_recorded_times() {
    for (Located& l : result_.where) {
      const double from = problem_.runs()[l.run].run->from;
      l.segment.from += from;
      l.segment.to += from;
    }
  }

  DiagnoseOptions options_;
  Diagnosis result_;
  Split split_;
  Problem problem_;
  FitOptions fit_options_;
  std::vector<std::size_t> train_, held_;
  std::optional<Nuisance> nominal_;
  NullDistribution screen_null_;
  std::size_t remaining_of_ = 0;
  int guarded_ = 0, kept_ = 0;
};

}  // namespace

Diagnosis diagnose(const Bundle& bundle, const Simulate& simulate, const DiagnoseOptions& options) {
  return Diagnosing(bundle, simulate, options).run();
}

}  // namespace repose::diagnosis
