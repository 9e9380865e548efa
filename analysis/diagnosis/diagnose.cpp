#include "analysis/diagnosis/diagnose.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "analysis/diagnosis/bootstrap.hpp"
#include "analysis/diagnosis/combination.hpp"
#include "analysis/diagnosis/explained.hpp"
#include "analysis/diagnosis/held_out.hpp"
#include "analysis/diagnosis/horizon.hpp"
#include "analysis/diagnosis/maker_step.hpp"
#include "analysis/diagnosis/quarter_turn.hpp"
#include "analysis/diagnosis/split.hpp"
#include "analysis/diagnosis/start_values.hpp"
#include "analysis/diagnosis/stated_noise.hpp"
#include "core/error.hpp"

namespace repose::diagnosis {
namespace {

constexpr double told_error = 0.3;  // of the noise
constexpr double told_step = 0.05;  // of the noise
constexpr double beyond_chance = 6;  // standard deviations: of a thousand probes of noise one in a million recordings has one that reaches it
constexpr double nothing_seen = 0.05;  // p

class Diagnosing {
 public:
  Diagnosing(const Bundle& bundle, const Simulate& simulate, const DiagnoseOptions& options)
      : options_(options),
        simulate_(simulate),
        split_(split_runs(bundle, options.max_train_runs, options.max_held_out_runs, options.seed, result_.notes)),
        problem_(bundle, all_runs(), simulate, options.store, options.coarser_step) {
    for (std::size_t i = 0; i < problem_.runs().size(); ++i) {
      (i < split_.train.size() ? train_ : held_).push_back(i);
      result_.run_ids.push_back(problem_.runs()[i].run->id);
    }
    result_.train_runs = train_.size();
    result_.noise = problem_.noise();
    result_.sensor_noise = problem_.sensor_noise();
    result_.stated_noise = bundle.noise;
    fit_options_.threads = options.threads;
    fit_options_.interrupted = options.interrupted;
    follow_further(problem_, fit_options_);
    note_horizons(bundle);
  }

  /// To be asked after run(): was the step too coarse for what was found?
  bool step_shows(const Diagnosis& found) const {
    for (const FittedHypothesis* model : {&found.models.front(), &found.models[found.best]})
      for (const Fit* fit : {&model->fit, &model->held_fit})
        if (moved_by_coarser_step(problem_, *fit) > told_step) return true;
    return false;
  }

  /// To be asked before run().
  std::map<std::string, double> understated() const { return understated_noise(problem_, train_, fit_options_); }

  Diagnosis run() {
    demand_candidates();
    demand_runnable();
    SearchOptions how;
    how.threads = options_.threads;
    how.seed = options_.seed;
    how.replicas = options_.replicas;
    how.joint_fits = options_.joint_fits;
    how.candidates = options_.candidates;
    how.other_backends = options_.other_backends;
    how.progress = options_.progress;
    how.interrupted = options_.interrupted;
    Search search(problem_, train_, how);
    search.run();
    take(search);
    if (options_.bootstrap > 0 && !result_.interrupted) repeat_nominal(how);
    finish(search);
    return std::move(result_);
  }

 private:
  std::vector<std::size_t> all_runs() const {
    std::vector<std::size_t> all = split_.train;
    all.insert(all.end(), split_.held.begin(), split_.held.end());
    return all;
  }

  void tell(const std::string& stage, double done, double total) const {
    if (options_.progress) options_.progress(stage, done, total);
  }

  void note_horizons(const Bundle& bundle) {
    for (const RunData& data : problem_.runs()) {
      double end = 0;
      for (const Observation& o : data.run->observations)
        if (!o.time.empty()) end = std::max(end, o.time.back());
      result_.compared.push_back({data.run->id, data.run->from + std::min(data.horizon, end), data.run->from + end});
      if (data.horizon < end)
        result_.notes.push_back(fmt::format("Run {} is compared up to {:.3g} s of {:.3g} s: beyond it the noise of its start no longer acts linearly.",
                                            data.run->id, data.run->from + data.horizon, data.run->from + end));
    }
    if (const double factor = problem_.numerics().step_factor; factor > 1)
      result_.notes.push_back(fmt::format("Simulated in second order at {:.0f} times the scene's step, which moves the readings of no run by more than a twentieth of their noise (rms).", factor));
    std::set<std::string> unused;
    for (const RunData& data : problem_.runs())
      for (const Observation& o : data.run->observations)
        if (o.kind != ObservableKind::trajectory && !is_simulated_series(o)) unused.insert(o.name);
    if (!unused.empty())
      result_.notes.push_back(fmt::format("Not compared: {}. Beside trajectories of bodies only what a sensor on one of them reads is simulated.", fmt::join(unused, ", ")));
    for (const std::string& warning : bundle.warnings) result_.notes.push_back(warning);
  }

  /// Not where it is the verdict.
  void note_scene_error(double error) {
    if (!result_.models.front().fit.layout.numerics.second_order || error < told_error) return;
    result_.scene_error = error;
    result_.notes.push_back(fmt::format("Stepped as the scene says, and fitted so, the recordings would be missed by {:.2g} of their noise; every hypothesis was solved to "
                                        "second order instead (solver.integration). Write `integration: second_order` under `solver`, or a smaller time_step.", error));
  }

  void demand_candidates() const {
    if (options_.candidates.empty()) return;
    std::set<std::string> known;
    for (const EffectRow& row : effect_library())
      if (row.site == EffectSite::numerics) known.insert(row.name);
    for (const auto& terms : {possible_terms(problem_.bundle(), problem_.scale()), stated_terms(problem_.bundle(), problem_.scale())})
      for (const Term& term : terms) known.insert(term.row->name);
    for (const std::string& name : options_.candidates)
      if (!known.contains(name))
        throw Error("--candidates " + name, "the scene cannot take it, or it is calibrated or set by the runs already", "leave it out, or mend the bundle");
  }

  /// A nominal scene that cannot be run is for the user to mend: the reason is thrown.
  void demand_runnable() const {
    const Fit start = start_of(problem_, problem_.layout({}), all_indices());
    for (const std::size_t run : start.runs) {
      if (start.residual[run].size() > 0 || (options_.interrupted && options_.interrupted())) continue;
      problem_.history(start.layout, run, start.shared, start.own[run]);
      throw Error("run " + problem_.runs()[run].run->id, "its simulation gives no finite numbers to compare",
                  "look at the scene with `repose run`", Error::Kind::simulation);
    }
  }

  std::vector<std::size_t> all_indices() const {
    std::vector<std::size_t> all = train_;
    all.insert(all.end(), held_.begin(), held_.end());
    return all;
  }

  void take(Search& search) {
    result_.interrupted = search.interrupted();
    for (const Fit& fit : search.fits()) {
      FittedHypothesis model;
      model.hypothesis = fit.layout.hypothesis;
      model.fit = nearer_to_the_scene(problem_, fit);
      result_.models.push_back(std::move(model));
    }
    note_scene_error(search.scene_error());
    const LackOfFit& lack = search.lack_of_fit();
    result_.screened = lack.screened;
    // Where numerics were a part of the mismatch and something is left, that is where the physics is.
    const LackOfFit& located = search.base() != 0 && !result_.interrupted && search.left_by(search.base()).p <= level
                                   ? search.left_by(search.base()) : lack;
    result_.where = located.places.stretches;
    result_.depends_on = dependence_of(located.places.pieces);
    if (const std::size_t fitted = result_.models.front().fit.runs.size(), looked_at = SearchOptions{}.located_runs; fitted > looked_at)
      result_.notes.push_back(fmt::format("Where the mismatch is was looked for in the first {} of {} fitted runs.", looked_at, fitted));
    result_.lack_of_fit_p = lack.p;
    result_.tested = lack.tested || result_.interrupted;
    deviate_ = lack.deviate;
    result_.replicas = options_.replicas;
    if (search.base() != 0)
      result_.notes.push_back(fmt::format("The scene's own numerics are a part of the mismatch ({}); all candidates were simulated without that error.",
                                          result_.models[search.base()].hypothesis.label()));
    if (search.nominal_improved() > 0)
      result_.notes.push_back("The nominal scene fitted better from where a candidate had ended; everything was judged anew from there.");
  }

  /// Step 4 with the whole fit repeated.
  void repeat_nominal(const SearchOptions& how) {
    const NullDistribution null = bootstrap(problem_, result_.models.front().fit, simulate_, options_.bootstrap, how, options_.coarser_step);
    if (interrupted() || null.largest.empty()) return;  // few replicas reach no small p, whatever is missing
    result_.lack_of_fit_p = null.p(deviate_);
    result_.replicas = static_cast<int>(null.largest.size());
    result_.bootstrapped = true;
  }

  /// Since the flag was set simulations give nothing: what comes after the last complete stage is left out.
  bool interrupted() {
    result_.interrupted = result_.interrupted || (options_.interrupted && options_.interrupted());
    return result_.interrupted;
  }

  void weigh(FittedHypothesis& model) {
    model.scale = std::max(1.0, std::sqrt(model.fit.per_dof()));
    model.train = score_of(problem_, model.fit);
    const Layout plain = problem_.layout({});
    model.extra_parameters = seen_parameters(problem_, model.fit, plain.shared.size());
    std::size_t in_a_run = 0;
    for (const std::size_t run : train_) in_a_run = std::max(in_a_run, model.fit.layout.per_run[run].size() - plain.per_run[run].size());
    model.form_parameters = model.extra_parameters + static_cast<int>(in_a_run);
    const std::vector<std::size_t>& judged = held_.empty() ? train_ : held_;
    for (const std::size_t run : judged)
      model.extra_parameters += static_cast<int>(model.fit.layout.per_run[run].size() - plain.per_run[run].size());
    model.held_out = held_.empty() ? model.train : score_of(problem_, model.held_fit);
    model.predicted = model.held_out.log_likelihood;
    // Where a model leaves plainly more than noise, its slopes say nothing of what another value would be worth.
    // The same holds where paths jump with an engine's step.
    const bool poor = !model.fit.layout.numerics.backend.empty() || model.fit.per_dof() > plainly_more_than_noise || model.held_fit.per_dof() > plainly_more_than_noise;
    if (!held_.empty() && !poor && !interrupted()) model.predicted += worth_of_uncertainty(problem_, model.fit, model.held_fit, model.scale, fit_options_);
  }

  void weigh_all() {
    for (FittedHypothesis& model : result_.models) weigh(model);
    if (interrupted())
      for (FittedHypothesis& model : result_.models) model.predicted = model.held_out.log_likelihood;
  }

  void fit_held_out() {
    if (held_.empty()) return;
    std::vector<const Fit*> trained;
    for (const FittedHypothesis& model : result_.models) trained.push_back(&model.fit);
    const auto told = [&](std::size_t done) { tell("runs that were held out", static_cast<double>(done), static_cast<double>(trained.size())); };
    std::vector<Fit> fits = held_out_fits(problem_, trained, held_, fit_options_, told);
    if (interrupted()) return held_.clear();  // half of them fitted: judged by the fitted runs
    for (std::size_t i = 0; i < fits.size(); ++i) result_.models[i].held_fit = std::move(fits[i]);
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

  /// Runs that a model cannot even simulate count as off by the most.
  void note_failures() {
    std::vector<std::size_t> asked{0};
    if (result_.best != 0) asked.push_back(result_.best);
    for (const std::size_t m : asked)
      for (const Fit* fit : {&result_.models[m].fit, &result_.models[m].held_fit})
        for (std::size_t i = 0; i < fit->residual.size(); ++i)
          if (fit->residual[i].size() == 0)
            result_.notes.push_back(fmt::format("Run {} cannot be simulated as {} was fitted: every sample of it counts as wrong.", result_.run_ids[fit->runs[i]],
                                                m == 0 ? "the nominal scene" : result_.models[m].hypothesis.label()));
  }

  /// A run whose data begin with another velocity than the bundle says, by half of it: axes were exchanged, or runs.
  void note_starts() {
    for (const RunData& run : problem_.runs())
      for (const StartContradiction& c : contradictions(run.start))
        result_.notes.push_back(fmt::format("Run {} begins with {} = ({:.3g}, {:.3g}, {:.3g}) by its samples, where the bundle says ({:.3g}, {:.3g}, {:.3g}): are these the axes, "
                                            "and the run, that are meant?", run.run->id, c.key, c.read.x(), c.read.y(), c.read.z(), c.told.x(), c.told.y(), c.told.z()));
  }

  void note_quarter_turn(const FittedHypothesis& model) {
    if (turned_by_a_quarter(problem_, model.fit))
      result_.notes.push_back("Anisotropic friction has two forms that no recording tells apart while friction is calibrated: 1/ratio, with the direction turned by 90 degrees "
                              "and friction times ratio, is the same law. Told is the form whose friction is nearer to the scene's.");
  }

  /// What would do as well as the best if the scene's own word were not worth more.
  void note_stated(const std::vector<Evidence>& evidence) {
    const Evidence& best = evidence[result_.best];
    for (std::size_t i = 1; i < evidence.size(); ++i) {
      const FittedHypothesis& m = result_.models[i];
      if (i == result_.best || result_.best == 0 || evidence[i].stated == 0 || best.stated > 0 || !best.solved.empty() || !evidence[i].solved.empty() || m.hypothesis.terms.size() > 1) continue;
      const double cost = cost_of_parameter * (evidence[i].parameters - best.parameters) + cost_of_effect * (1 - static_cast<double>(best.effects.size()));
      if (evidence[i].held_out - best.held_out - cost < -indistinguishable_within) continue;
      const Parameter& p = m.fit.layout.shared.back();
      result_.notes.push_back(fmt::format("{} = {:.4g} would explain the recordings as well, if the {:.4g} that the scene states is not to be trusted.", p.key,
                                          m.fit.shared[m.fit.shared.size() - 1], p.null));
    }
  }

  /// Physics is measured against the scene as finely as it was solved with it. What fits the training runs and leaves the held-out
  /// ones as they were has explained nothing.
  double explained_by(std::size_t model, std::size_t finer) const {
    const FittedHypothesis& m = result_.models[model];
    const FittedHypothesis& plain = result_.models[model == finer || model == 0 ? 0 : finer];
    const double fitted = share_explained(plain.fit, m.fit, noise_left_);
    if (held_.empty() || m.held_fit.per_dof() <= plainly_more_than_noise) return fitted;
    return std::min(fitted, share_explained(plain.held_fit, m.held_fit));
  }

  bool within_a_step(const Fit& leading) {
    if (result_.lack_of_fit_p > level) return false;
    std::vector<const Fit*> numerics;
    for (const FittedHypothesis& m : result_.models)
      if (!m.hypothesis.terms.empty() && without_numerics(m.hypothesis).terms.empty()) numerics.push_back(&m.fit);
    const StepMismatch mismatch = step_mismatch(problem_, result_.models.front().fit, leading, numerics, fit_options_);
    if (mismatch.may_be_one)
      result_.notes.push_back(fmt::format("What stands out amounts to {:.2g} of the noise: a quarter of the scene's step errs by {:.2g}, so recordings of another "
                                          "simulation may differ by that, and it is not called physics. If these are no simulation's, write "
                                          "`integration: second_order` under `solver`.", mismatch.size, mismatch.allowed));
    return mismatch.may_be_one;
  }

  void finish(Search& search) {
    fit_held_out();
    weigh_all();
    noise_left_ = noise_left(problem_, result_.models[search.best()].fit);
    std::vector<Evidence> evidence;
    for (std::size_t i = 0; i < result_.models.size(); ++i) {
      const FittedHypothesis& m = result_.models[i];
      Evidence e;
      e.effects = m.hypothesis.names();
      for (const Term& term : m.hypothesis.terms) e.sites.push_back(term.row->site);
      e.general = static_cast<int>(std::count_if(m.hypothesis.terms.begin(), m.hypothesis.terms.end(), [](const Term& t) { return !t.row->limit.empty(); }));
      e.held_out = m.predicted;
      e.held_out_as_fitted = m.held_out.log_likelihood;
      e.per_run = m.held_out.per_run;
      e.train_gain = result_.models.front().fit.chi2 - m.fit.chi2;
      e.parameters = m.extra_parameters;
      e.form_parameters = m.form_parameters;
      e.stated = stated_in(m.hypothesis);
      e.explained = explained_by(i, search.base());
      const Fit& plain = result_.models[i == 0 || i == search.base() ? 0 : search.base()].fit;
      e.error_left = error_left(plain, m.fit);
      e.accelerations = share_of_accelerations(problem_, plain, m.fit);
      if (std::any_of(e.sites.begin(), e.sites.end(), [](EffectSite s) { return s != EffectSite::numerics; })) e.solved = other_numerics(m.fit.layout.numerics);
      e.lack_of_fit = m.scale;
      evidence.push_back(e);
    }
    reach_verdict(search, evidence);
    result_.best = static_cast<std::size_t>(result_.verdict.best);
    result_.explained = evidence[result_.best].explained;
    result_.accelerations = evidence[result_.best].accelerations;
    note_stated(evidence);
    note_starts();
    if (result_.verdict.by_fitted_runs)
      result_.notes.push_back("The runs that were held out do not show the mismatch: candidates were weighed on the fitted runs as well, and no prediction proves the verdict.");
    FittedHypothesis& best = result_.models[result_.best];
    tell("intervals of the parameters", 0, 1);
    FittedHypothesis& nominal = result_.models.front();
    nominal.parameters = estimates(problem_, nominal.fit, nominal.scale, result_.best == 0 && !interrupted(), options_.seed, fit_options_);
    if (result_.best != 0) best.parameters = estimates(problem_, best.fit, best.scale, !interrupted() && best.fit.layout.numerics.backend.empty(), options_.seed, fit_options_);
    note_failures();
    result_.overstated = overstated_noise(problem_, best.fit);
    note_combinations(best);
    note_quarter_turn(best);
    note_numerics(search.base(), best.fit.layout.numerics);
    if (!held_.empty()) {  // the fitted runs prove nothing about the fit
      result_.paired_p = p_of_smaller_errors(nominal.held_out.error_per_run, best.held_out.error_per_run);
      result_.effect_size = paired_gain(nominal.held_out.per_run, best.held_out.per_run).effect_size;
    }
    suggest();
    result_.residuals = shown_residuals(problem_, nominal, best, result_.where);
    tell_recorded_times();
    result_.extended_scene = emit_yaml(problem_.extended_scene(best.fit.layout, best.fit.shared));
    result_.simulations = problem_.simulations();
    interrupted();
  }

  /// Lack of fit of a model on the runs that were fitted, or plainly on those that were not.
  double remaining_p_of(Search& search, std::size_t model) {
    double p = result_.lack_of_fit_p;
    if (model != 0 && p <= level && !interrupted()) p = search.left_by(model).p;
    const Fit& held = result_.models[model].held_fit;
    return !held_.empty() && held.per_dof() > plainly_more_than_noise ? std::min(p, least_p()) : p;
  }

  double least_p() const { return 1 / (1 + static_cast<double>(options_.replicas)); }

  /// Held-out runs that the nominal plainly misses though it explains the fitted ones: something was misread, or acts there alone. The place is then
  /// looked for in them.
  std::vector<std::string> only_held_out_part(Search& search) {
    const Fit& held = result_.models.front().held_fit;
    if (held_.empty() || result_.lack_of_fit_p <= level || !(held.per_dof() > plainly_more_than_noise) || interrupted()) return {};
    const std::vector<std::size_t> beyond = runs_beyond_noise(held);
    Fit of_these = held;
    of_these.runs = beyond;
    std::vector<std::string> runs;
    for (const std::size_t run : beyond) runs.push_back(result_.run_ids[run]);
    if (!beyond.empty() && std::isfinite(held.chi2)) result_.where = search.lack_in(evaluated(problem_, std::move(of_these))).places.stretches;
    return runs;
  }

  void reach_verdict(Search& search, const std::vector<Evidence>& evidence) {
    std::size_t leading = search.best();
    const bool small = search.base() == 0 && within_a_step(result_.models[leading].fit);
    result_.only_held_out = only_held_out_part(search);
    const double p = small ? 1 : result_.only_held_out.empty() ? result_.lack_of_fit_p : least_p();
    for (int pass = 0; pass < 2; ++pass) {  // held-out runs may speak for another one than the fitted did
      result_.remaining_p = remaining_p_of(search, leading);
      result_.verdict = judge(evidence, p, result_.remaining_p, !held_.empty());
      const auto best = static_cast<std::size_t>(result_.verdict.best);
      if (best == 0 || best == leading) break;
      leading = best;
    }
    if (result_.verdict.word != "none" && result_.only_held_out.empty() && by_chance(search)) result_.verdict = judge(evidence, 1, result_.remaining_p, !held_.empty());
    if (!result_.tested)
      for (Ranked& r : result_.verdict.ranked) r.probability = r.model == 0 || r.model < 0 ? 0.5 : 0;
  }

  /// One in a hundred recordings without a mismatch has a lack of fit at the level. It is believed if runs that were not fitted show a lack as well, or are
  /// met better by what was found, or if it is beyond chance.
  bool by_chance(Search& search) {
    const Fit& held = result_.models.front().held_fit;
    if (held.runs.empty() || deviate_ >= beyond_chance || interrupted() || !std::isfinite(held.chi2)) return false;
    const std::vector<double>& before = result_.models.front().held_out.error_per_run;
    if (p_of_smaller_errors(before, result_.models[static_cast<std::size_t>(result_.verdict.best)].held_out.error_per_run) <= nothing_seen) return false;
    const double p = search.lack_in(held).p;
    if (p <= nothing_seen) return false;
    result_.held_out_p = p;
    return true;
  }

  /// The effect that stands for numerics which are not the nominal's; empty for the nominal's own.
  std::string other_numerics(const Numerics& numerics) const {
    const Numerics& nominal = result_.models.front().fit.layout.numerics;
    if (numerics.backend != nominal.backend || numerics.other_law != nominal.other_law) return "engine_law";
    if (numerics.step_factor != nominal.step_factor || numerics.second_order != nominal.second_order) return "time_step";
    return numerics.tolerance_factor != nominal.tolerance_factor ? "solver_tolerance" : "";
  }

  void note_numerics(std::size_t base, const Numerics& best) {
    const Numerics& nominal = result_.models.front().fit.layout.numerics;
    if (problem_.numerics().second_order && !nominal.second_order && result_.verdict.word != "numerics") {
      result_.notes.push_back(fmt::format("The recordings bear the step of a simulation: they are fitted best when stepped as the scene says, at {:.2g} of its step, and so are all "
                                          "hypotheses. That is how they were made, and no physics.", nominal.step_factor));
      return;
    }
    if (!best.backend.empty()) {
      result_.notes.push_back(fmt::format("The recordings bear the marks of an engine: they are fitted best as {0} solves the scene, at {1:.2g} of its step. So is the extended scene: "
                                          "run it with `--backend {0}`.", best.backend, best.step_factor));
      return;
    }
    if (base != 0 || result_.verdict.word == "numerics" || result_.verdict.word == "unknown" || best.second_order == result_.models.front().fit.layout.numerics.second_order) return;
    result_.notes.push_back(fmt::format("The recordings bear the step of an engine: beside what is missing they are fitted best when stepped as the scene says, at {:.2g} of its "
                                        "step, and so is the extended scene.", best.step_factor));
  }

  /// Step 9: the best against its nearest rival of the same size, or against nothing missing.
  void suggest() {
    if (result_.best == 0 || interrupted()) return;
    std::size_t rival = 0;
    for (const Ranked& r : result_.verdict.ranked)
      if (r.model > 0 && static_cast<std::size_t>(r.model) != result_.best) {
        rival = static_cast<std::size_t>(r.model);
        break;
      }
    tell("a recording that would tell more", 0, 1);
    result_.suggested.push_back(recording_that_parts(problem_, result_.models[result_.best].fit, result_.models[rival].fit));
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
  const Simulate& simulate_;
  Diagnosis result_;
  Split split_;
  Problem problem_;
  FitOptions fit_options_;
  std::vector<std::size_t> train_, held_;
  double noise_left_ = 1;  ///< per degree of freedom, by the fit that leaves least
  double deviate_ = 0;  ///< of the nominal's lack of fit
};

}  // namespace

Diagnosis diagnose(const Bundle& bundle, const Simulate& simulate, const DiagnoseOptions& options) {
  const auto diagnosed = [&](Diagnosing& diagnosing, const Bundle& of) {
    Diagnosis found = diagnosing.run();
    if (found.interrupted || !diagnosing.step_shows(found)) return found;
    DiagnoseOptions finely = options;
    finely.coarser_step = false;
    return Diagnosing(of, simulate, finely).run();
  };
  Diagnosing as_stated(bundle, simulate, options);
  const std::map<std::string, double> understated = as_stated.understated();
  if (understated.empty()) return diagnosed(as_stated, bundle);
  Bundle as_it_scatters = bundle;
  for (const auto& [name, scatter] : understated) as_it_scatters.noise[name] = scatter;
  Diagnosing again(as_it_scatters, simulate, options);
  Diagnosis result = diagnosed(again, as_it_scatters);
  result.stated_noise = bundle.noise;
  result.understated = understated;
  return result;
}

}  // namespace repose::diagnosis
