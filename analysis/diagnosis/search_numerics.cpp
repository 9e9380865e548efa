/// The part of the search that asks how the recordings may have been solved: step, tolerance, contact law, engine.
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "analysis/diagnosis/search.hpp"
#include "analysis/diagnosis/verdict.hpp"

namespace repose::diagnosis {
namespace {

constexpr std::size_t solved_again = 4;  // hypotheses that are solved in another way as well
constexpr std::size_t asked_first = 2;   // of these; the others where nothing was found and much is left
constexpr double coarse_scene = 10;      // of the noise, rms. A ball that bounces in steps of a millisecond errs by 3 to 5; that is told beside the verdict
constexpr double beside_the_step = 25;   // chi^2 per degree of freedom: what is farther off has another reason than how it was stepped
constexpr double much_nearer = 0.5;      // of chi^2, before anything is fitted
constexpr double noise_may_err = 1.1;    // in squares: a reading in steps of the noise adds a twelfth to what the recording states
constexpr double near_step = 3, finest_step = 0.08;  // around a step that fits, and of the scene's: a finer one costs more and errs hardly at all
constexpr int bits_of_step = 8;
constexpr std::uintmax_t looks_at_steps = 7;
constexpr double share_of_numerics = 0.05, gain_of_numerics = 20;  // of the excess chi^2, and absolute: from there on they count

}  // namespace

/// Where the scene's own way to solve it is wrong by more than a small multiple of the noise, and that is the larger part of the
/// mismatch, the nominal is the scene as given, and what it is measured against, as `time_step`, the scene in second order.
void Search::compare_as_given() {
  if (!problem_.numerics().second_order || stopped()) return;
  Fit given = fits_.front();
  given.layout.numerics = {};
  given = improved(given);
  if (!std::isfinite(given.chi2)) return;
  const double gain = given.chi2 - fits_.front().chi2;
  scene_error_ = std::sqrt(std::max(0.0, gain) / static_cast<double>(given.samples));
  if (gain < coarse_scene * coarse_scene * static_cast<double>(given.samples) || gain < 0.5 * given.excess()) return;
  Fit finer = std::move(fits_.front());
  finer.layout.hypothesis.terms = {{find_effect("time_step"), ""}};
  fits_ = {std::move(given), std::move(finer)};
}

/// Recordings that another simulation made, stepped as the scene says or more finely, bear the errors of that step. Where these are all that the
/// nominal leaves, nothing is missing: the nominal is then solved as they were.
void Search::take_step_of_maker() {
  const Fit* const made = find({{{find_effect("time_step"), ""}}});
  if (made == nullptr || !problem_.numerics().second_order || stopped()) return;
  const Numerics& how = made->layout.numerics;
  if (how.second_order || !how.backend.empty() || how.step_factor > 1 || !leaves_noise(*made)) return;
  LackOfFit left = lack_in(*made);
  if (left.p <= level || stopped()) return;
  Fit nominal = *made;
  nominal.layout.hypothesis.terms.clear();
  fits_.assign(1, std::move(nominal));
  lack_ = std::move(left);
  left_.clear();
}

/// A fit begun with other numerics than it had, whose chi^2 `start` still tells. An engine that lacks something of the scene gives no finite
/// chi^2. One meets impacts in other steps than the next, which sets a fit off by little: what is far off has another reason, unless the
/// engine that made the recordings shows it at once; and to fit it in every engine would cost more than all the rest of the search.
Fit Search::solved_by(const Fit& start, double wanted) const {
  Fit fit = evaluated(problem_, start);
  const bool by_engine = !fit.layout.numerics.backend.empty();
  if (by_engine && start.per_dof() > beside_the_step && fit.chi2 > much_nearer * start.chi2) return fit;
  fit = improved_if_promising(fit, wanted);
  if (!by_engine || !(fit.per_dof() < beside_the_step) || leaves_noise(fit)) return fit;
  fit = improved_if_promising(begun_anew(problem_, fit, train_, fit_options_), wanted);
  return fit.chi2 < promising * wanted && !leaves_noise(fit) ? improved(shaken(problem_, fit, train_, fit_options_)) : fit;
}

/// Stepped nearly as the maker did: an error in proportion to the step is left, which grows with time as a small force does. The step that fits best,
/// near that of the fit; where paths jump with the step, the best of those that were looked at.
Fit Search::at_step_of_maker(Fit fit) const {
  const double from = std::max(finest_step, fit.layout.numerics.step_factor / near_step), to = std::min(1.0, fit.layout.numerics.step_factor * near_step);
  const auto left = [&](double step) {
    if (options_.interrupted && options_.interrupted()) return fit.chi2;
    tell("the step of the recordings", 0, 1);
    Fit start = fit;
    start.layout.numerics.step_factor = step;
    Fit other = solved_by(start, fit.chi2);
    const double chi2 = other.chi2;
    if (chi2 < fit.chi2) fit = std::move(other);
    return chi2;
  };
  std::uintmax_t looks = looks_at_steps;
  boost::math::tools::brent_find_minima(left, from, to, bits_of_step, looks);
  return fit;
}

bool Search::leaves_noise(const Fit& fit) {
  return p_of_chi2(fit.chi2 / noise_may_err, std::max<Eigen::Index>(1, fit.samples - fit.parameters)) > level;
}

/// Does the mismatch go away with another step, with a tenth of the tolerance, with the other contact law, or in another engine?
void Search::fit_numerics() {
  const Numerics own = fits_.front().layout.numerics;
  const auto varied = [&](const auto& change) {
    Numerics numerics = own;
    change(numerics);
    return numerics;
  };
  std::vector<Numerics> steps{varied([](Numerics& n) { n.step_factor = 0.25; })};
  // Recordings that were simulated bear the step of their maker: one that is stepped as the scene says.
  if (own.second_order)
    for (Numerics& way : steps_of("")) steps.push_back(std::move(way));
  fit_numerics("time_step", steps);
  fit_numerics("solver_tolerance", {varied([](Numerics& n) { n.tolerance_factor = 0.1; })});
  std::vector<Numerics> laws{varied([](Numerics& n) { n.other_law = true; })};
  for (const std::string& backend : options_.other_backends)
    for (Numerics& way : steps_of(backend)) laws.push_back(std::move(way));
  fit_numerics("engine_law", laws);
}

void Search::fit_numerics(const char* name, const std::vector<Numerics>& ways) {
  Hypothesis hypothesis{{{find_effect(name), ""}}};
  Fit best;
  best.chi2 = std::numeric_limits<double>::infinity();
  const double least = find(hypothesis) == nullptr ? fits_.front().chi2 : std::min(find(hypothesis)->chi2, fits_.front().chi2);
  for (const Numerics& numerics : ways) {
    if (stopped()) return;
    const double wanted = std::min(best.chi2, least);
    tell("another way to solve it", 0, 1);
    Fit fit = fits_.front();
    fit.layout.hypothesis = hypothesis;
    fit.layout.numerics = numerics;
    if (fit = solved_by(fit, wanted); fit.chi2 < best.chi2) best = std::move(fit);
  }
  Fit* const known = find(hypothesis);
  // Of a coarse scene the finer one may err by as much as the nearest step.
  const bool like_a_finer = known != nullptr && known->layout.numerics.second_order && best.chi2 < promising * least;
  const bool other_step = !best.layout.numerics.second_order && !best.layout.numerics.other_law && best.per_dof() < beside_the_step &&
                          (like_a_finer || best.chi2 < least - gain_of_numerics);
  // To look for what another engine's paths leave would take longer than all the rest; their size tells enough.
  const auto leaves_nothing = [&](const Fit& fit) {
    return leaves_noise(fit) && (!fit.layout.numerics.backend.empty() || (!stopped() && lack_in(fit).p > level));
  };
  bool nothing_left = other_step && leaves_nothing(best);
  if (other_step && !nothing_left && !stopped()) {
    best = at_step_of_maker(std::move(best));
    nothing_left = leaves_nothing(best);
  }
  if (known == nullptr) return keep(std::move(best));
  if (!(best.chi2 < known->chi2 - gain_of_numerics)) return;
  // A finer scene stays finer, unless the step of the recordings is all that is left.
  if (best.layout.numerics.backend.empty() && known->layout.numerics.second_order && !best.layout.numerics.second_order && !nothing_left) return;
  left_.erase(hypothesis.label());
  *known = std::move(best);
}

/// The finer solution becomes the base where it removes more than a little of what the nominal leaves. Another contact law or engine
/// is no finer solution: it stays a rival of the candidates.
void Search::choose_base() {
  base_ = 0;
  const Fit& nominal = fits_.front();
  double least = std::max(gain_of_numerics, share_of_numerics * nominal.excess());
  for (std::size_t m = 1; m < fits_.size(); ++m) {
    const Hypothesis& h = fits_[m].layout.hypothesis;
    if (h.terms.size() != 1 || !without_numerics(h).terms.empty() || fits_[m].layout.numerics.other_law || !fits_[m].layout.numerics.backend.empty()) continue;
    if (nominal.chi2 - fits_[m].chi2 < least) continue;
    least = nominal.chi2 - fits_[m].chi2;
    base_ = m;
  }
}

/// As the scene says and at a quarter of that, solved by one backend (empty: the own one) of first order.
std::vector<Numerics> Search::steps_of(const std::string& backend) {
  std::vector<Numerics> steps(2);
  steps[0].step_factor = step_of_makers;
  for (Numerics& step : steps) step.backend = backend;
  return steps;
}

/// Does another engine leave nothing by itself, so that no physics beside it gains more than a second effect must?
bool Search::engine_suffices() {
  const Fit* const engine = find({{{find_effect("engine_law"), ""}}});
  if (engine == nullptr || engine->layout.numerics.backend.empty() || !leaves_noise(*engine)) return false;
  return std::none_of(fits_.begin(), fits_.end(), [&](const Fit& fit) { return fit.worth() < engine->worth() - pair_gain; });
}

/// All that the best singles leave may be the way in which an engine made the recordings, too small beside the physics to be seen before: its
/// step, or its impacts. A second effect would only imitate it. A way is an answer where it leaves nothing beside one of the best (or by
/// itself); the one that fits best is then the way for all.
void Search::fit_as_made() {
  std::vector<std::size_t> order = singles_by_worth();
  if (order.empty() || left_by(order.front()).p > level) return;
  if (order.size() > solved_again) order.resize(solved_again);
  std::map<std::size_t, Fit> made;  // by the place in fits_
  const auto solve = [&](std::size_t place, const Numerics& way) {
    tell(fits_[place].layout.hypothesis.label() + " as engines solve it", static_cast<double>(made.size()), static_cast<double>(solved_again));
    Fit start = fits_[place];
    start.layout.numerics = way;
    return solved_by(start, fits_[place].chi2);
  };
  const Fit* const engine = find({{{find_effect("engine_law"), ""}}});
  std::optional<Numerics> found;
  if (engine != nullptr && !engine->layout.numerics.backend.empty() && leaves_noise(*engine)) found = engine->layout.numerics;
  std::vector<Numerics> ways;
  if (fits_.front().layout.numerics.second_order) ways = steps_of("");
  for (const std::string& backend : options_.other_backends)
    for (Numerics& way : steps_of(backend)) ways.push_back(std::move(way));
  const bool as_engine = found.has_value();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < order.size() && !as_engine; ++i) {
    if (i >= asked_first && (found || fits_[order[i]].per_dof() < plainly_more_than_noise)) break;
    const auto accept = [&](Fit fit) {
      if (!(fit.chi2 < std::min(least, fits_[order[i]].chi2 - gain_of_numerics)) || !leaves_noise(fit) || lack_in(fit).p <= level) return;
      least = fit.chi2;
      found = fit.layout.numerics;
      made.insert_or_assign(order[i], std::move(fit));
    };
    std::optional<Fit> nearest;
    for (const Numerics& way : ways) {
      if (stopped()) return;
      Fit fit = solve(order[i], way);
      if (!nearest || fit.chi2 < nearest->chi2) nearest = fit;
      accept(std::move(fit));
    }
    if (!found && nearest && nearest->chi2 < fits_[order[i]].chi2 - gain_of_numerics && !stopped()) accept(at_step_of_maker(std::move(*nearest)));
  }
  if (!found) return;
  for (const std::size_t place : order) {
    if (stopped()) return;
    auto fit = made.find(place);
    const auto as_found = [&](const Numerics& way) { return way.backend == found->backend && way.step_factor == found->step_factor; };
    if (fit == made.end() || !as_found(fit->second.layout.numerics)) fit = made.insert_or_assign(place, solve(place, *found)).first;
    if (!(fit->second.chi2 < fits_[place].chi2 - gain_of_numerics)) continue;
    left_.erase(fits_[place].layout.hypothesis.label());  // what the fit before it left is no longer so
    fits_[place] = std::move(fit->second);
  }
}

/// Physics that was found beside other numerics may not need them: the best hypotheses once more as the nominal is solved.
void Search::fit_without_numerics() {
  const Numerics own = fits_.front().layout.numerics;
  std::vector<std::size_t> order;
  for (std::size_t m = 1; m < fits_.size(); ++m)
    if (m != base_ && !without_numerics(fits_[m].layout.hypothesis).terms.empty()) order.push_back(m);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return fits_[a].worth() < fits_[b].worth(); });
  for (std::size_t i = 0; i < std::min(solved_again, order.size()) && !stopped(); ++i) {
    Fit& fit = fits_[order[i]];
    tell("the best as the scene is solved", static_cast<double>(i), static_cast<double>(solved_again));
    Fit start = fit;
    start.layout.numerics = own;
    Fit again = improved_if_promising(evaluated(problem_, std::move(start)), fit.chi2);
    if (again.chi2 >= fit.chi2) continue;
    fit = std::move(again);
    left_.erase(fit.layout.hypothesis.label());  // what the fit before it left is no longer so
  }
}

}  // namespace repose::diagnosis
