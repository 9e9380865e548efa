#pragma once
/// Diagnosis of few-body recordings: from a mismatch to the missing physics, in twelve steps.
///
///   1 observation model   observation_model.hpp    2 calibration of the nominal scene   fit.hpp
///   3 nested-optimum guard   search.hpp             4 lack of fit   probe.hpp: noise alone; bootstrap.hpp: the whole fit
///   5 locate   locate.hpp                           6 shape   shape.hpp
///   7 candidates   screen.hpp, then search.hpp      8 verdict   verdict.hpp
///   9 confounding   confounding.hpp                10 uncertainty   uncertainty.hpp
///  11 before and after on held-out runs, score.hpp 12 write back: the extended scene
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/confounding.hpp"
#include "analysis/diagnosis/score.hpp"
#include "analysis/diagnosis/search.hpp"
#include "analysis/diagnosis/shape.hpp"
#include "analysis/diagnosis/shown_residuals.hpp"
#include "analysis/diagnosis/uncertainty.hpp"
#include "analysis/diagnosis/verdict.hpp"

namespace repose::diagnosis {

struct DiagnoseOptions {
  int threads = 1;
  std::uint64_t seed = 1;
  int max_train_runs = 8, max_held_out_runs = 8;
  int replicas = 499;       ///< of noise alone, for p values
  int bootstrap = 0;        ///< recordings that are simulated from the nominal fit and diagnosed anew, for its lack of fit
  int joint_fits = 6;       ///< candidates of the screening that are fitted jointly
  std::vector<std::string> candidates;  ///< names of effects; empty: the whole library
  std::vector<std::string> other_backends;  ///< that may have made the recordings: known to `simulate` by these names
  bool coarser_step = true;  ///< may a scene that is stepped far more finely than it was recorded be stepped more coarsely (Problem::numerics)?
  SimulationStore* store = nullptr;  ///< none: every simulation is run anew
  std::function<void(const std::string& stage, double done, double total)> progress;
  std::function<bool()> interrupted;
};

struct FittedHypothesis {
  Hypothesis hypothesis;
  Fit fit;                  ///< on the training runs
  Fit held_fit;             ///< physics frozen, start values fitted; no runs if nothing is held out
  double scale = 1;         ///< of the residuals on the training runs, in units of the noise, at least 1
  Score train, held_out;
  double predicted = 0;     ///< log likelihood of the held-out runs, for physics as well as the fitted runs determine it: what verdicts weigh
  int extra_parameters = 0; ///< beyond the nominal's
  int form_parameters = 0;  ///< of them, those that shape one run
  std::vector<ParameterEstimate> parameters;
};

/// How much of a run was compared: beyond `until` the noise of its start no longer acts linearly. [s], on the recording's clock.
struct Compared {
  std::string run;
  double until = 0, recorded_until = 0;
};

struct Diagnosis {
  Verdict verdict;
  std::vector<FittedHypothesis> models;   ///< [0]: nominal; then as fitted
  std::size_t best = 0;                   ///< the extended one; 0: nominal
  double lack_of_fit_p = 1; ///< of the nominal: by the bootstrap if there was one, else from noise alone
  bool tested = true;       ///< false: no effect and no force would show in these recordings, as with as many free values as samples; the verdict is `none`, and says nothing
  double remaining_p = 1;   ///< the same of the best model
  std::optional<double> held_out_p;  ///< of the nominal in runs that were not fitted, where these alone make the verdict `none`: what stood out was chance
  std::vector<std::string> only_held_out;  ///< runs that the nominal plainly misses though it explains those that were fitted
  double explained = 0;     ///< share of the nominal's excess chi^2 that the best model removes, on the runs (fitted or held out) where it removes less
  double accelerations = 1; ///< share of the missing accelerations that it removes (explained.hpp)
  int replicas = 0;         ///< behind lack_of_fit_p
  bool bootstrapped = false;
  std::vector<Located> where;
  std::vector<Dependence> depends_on;
  std::vector<SuggestedRecording> suggested;
  double paired_p = 1, effect_size = 0;
  std::vector<Compared> compared;         ///< of each run in run_ids
  std::vector<std::string> run_ids;       ///< of the problem: training runs, then those held out
  std::size_t train_runs = 0;
  std::vector<ResidualSample> residuals;  ///< of at most six runs
  std::string extended_scene;             ///< YAML
  std::map<std::string, NoiseModel> noise;
  std::map<std::string, double> sensor_noise, stated_noise;  ///< sd of the same before what the simulation's step may err by was added; as the bundle states it
  std::map<std::string, double> overstated;  ///< observables that differ from the best model by less than a tenth of the noise which the bundle states: the share
  std::map<std::string, double> understated; ///< observables whose samples scatter by more than the bundle states, and by how much [SI]: the noise that was used (stated_noise.hpp)
  std::vector<std::string> notes;         ///< subsets, splits, horizons: what was done and what was left out
  double scene_error = 0;   ///< rms, in units of the noise, of the nominal if it were stepped as the scene says; 0 where that is little, or the verdict
  std::size_t simulations = 0;
  bool interrupted = false;               ///< stages after the interruption are missing
  std::vector<Screened> screened;
};

/// Throws Error (Kind::input) if the bundle has nothing that few bodies can be compared with. On an interruption the result holds
/// what was found so far, with the verdict of that.
Diagnosis diagnose(const Bundle& bundle, const Simulate& simulate, const DiagnoseOptions& options);

}  // namespace repose::diagnosis
