#pragma once
/// The search for hypotheses that explain the recordings: calibration, screening, joint fits, pairs, numerics, and the guard of the
/// nested optimum.
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/locate.hpp"
#include "analysis/diagnosis/screen.hpp"

namespace repose::diagnosis {

struct SearchOptions {
  int threads = 1;
  std::uint64_t seed = 1;
  int replicas = 499;
  int joint_fits = 6;       ///< candidates of the screening that are fitted to the end
  std::size_t located_runs = 4;  ///< the first so many are searched for the mismatch stretch by stretch
  std::vector<std::string> candidates;  ///< names of effects; empty: the whole library
  std::vector<std::string> other_backends;  ///< that may have made the recordings
  std::function<void(const std::string& stage, double done, double total)> progress;
  std::function<bool()> interrupted;
};

/// How badly a fit fails: the probe that stands out most, over all effects and over an unknown force in all segments.
struct LackOfFit {
  std::vector<Screened> screened;  ///< of the effects that the fit does not have, by `reached`
  Places places;
  double deviate = 0;              ///< the largest of both
  double p_effects = 1;            ///< of the screening alone
  double p = 1;                    ///< of both, corrected for being two
  bool tested = false;             ///< is there physics, an effect or a force, that these recordings would show?
};

class Search {
 public:
  /// `problem` must outlive the search; `train`: the runs that are fitted.
  Search(const Problem& problem, std::vector<std::size_t> train, SearchOptions options);

  /// All steps. After an interruption what was found so far is there.
  void run();
  /// The nominal alone: calibration and its lack of fit.
  void run_nominal();

  const std::vector<Fit>& fits() const { return fits_; }  ///< [0]: nominal; others in the order in which they were tried
  const LackOfFit& lack_of_fit() const { return lack_; }  ///< of the nominal
  /// The fit that hypotheses extend: the nominal, or the nominal solved more finely, if that removes a good part of the mismatch
  /// (numerics must not hide physics, nor pass for it).
  std::size_t base() const { return base_; }
  /// What the fit leaves; computed when it is first asked for.
  const LackOfFit& left_by(std::size_t fit);
  /// What any fit of the problem leaves in its runs.
  LackOfFit lack_in(const Fit& fit);
  /// The fit of smallest chi^2 + 2 parameters.
  std::size_t best() const;
  bool interrupted() const { return interrupted_; }
  /// By how much the nominal is missed, beyond what it is missed by anyway, if it is stepped as the scene says: rms, in units of the noise; 0 where it is.
  double scene_error() const { return scene_error_; }
  int nominal_improved() const { return improved_; }      ///< times that the guard found a better nominal fit

 private:
  static constexpr double promising = 1.2;         ///< times the chi^2 to beat, after a short fit
  static constexpr double pair_gain = 10;          ///< twice the nats that an effect with a parameter costs, and some
  static constexpr double gains_to_matter = 1e-3;  ///< of chi^2, absolute: below it two fits are the same
  bool stopped();
  void tell(const std::string& stage, double done, double total) const;
  void calibrate();
  void compare_as_given();
  void take_step_of_maker();
  std::vector<Screened> screen_about(const Fit& fit, const Nuisance& nuisance, const std::vector<Term>& terms);
  Fit extended(const Fit& base, const std::vector<const Screened*>& terms, int iterations) const;
  Fit improved(const Fit& fit) const;
  Fit solved_by(const Fit& start, double wanted) const;
  Fit at_step_of_maker(Fit fit) const;
  Fit improved_if_promising(const Fit& start, double wanted) const;
  void keep(Fit fit);
  Fit* find(const Hypothesis& hypothesis);  ///< none: nullptr
  void choose_base();
  bool wanted(const Term& term) const;
  void fit_singles();
  void fit_stated();
  static std::vector<Numerics> steps_of(const std::string& backend);
  static bool leaves_noise(const Fit& fit);
  bool engine_suffices();
  void fit_as_made();
  std::vector<std::size_t> singles_by_worth() const;
  void fit_pairs();
  void fit_parts_of_pairs();
  std::vector<std::pair<std::size_t, std::size_t>> foresee_pairs(const std::vector<std::size_t>& singles, const std::vector<Screened>& screened);
  void fit_numerics();
  void fit_numerics(const char* name, const std::vector<Numerics>& ways);
  void fit_without_numerics();
  bool guard();

  const Problem& problem_;
  std::vector<std::size_t> train_;
  SearchOptions options_;
  FitOptions fit_options_;
  std::vector<Fit> fits_;
  LackOfFit lack_;
  std::size_t base_ = 0;
  std::map<std::string, LackOfFit> left_;  ///< by the hypothesis' label
  bool interrupted_ = false;
  double scene_error_ = 0;
  int improved_ = 0;
};

}  // namespace repose::diagnosis
