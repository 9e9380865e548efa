#pragma once
/// From held-out likelihoods to a verdict. Thresholds are constants of this file, the same for every recording.
#include <string>
#include <vector>

#include "analysis/diagnosis/hypothesis.hpp"

namespace repose::diagnosis {

/// One fitted hypothesis as the verdict sees it.
struct Evidence {
  std::vector<std::string> effects;   ///< none: nominal
  std::vector<EffectSite> sites;
  double held_out = 0;                ///< log likelihood [nats] with the uncertainty of what was fitted
  double held_out_as_fitted = 0;      ///< the same of the fitted values themselves
  std::vector<double> per_run;        ///< the same, run by run
  double train_gain = 0;              ///< over the nominal: twice the log likelihood ratio
  int parameters = 0;                 ///< beyond the nominal's
  int form_parameters = 0;            ///< that shape one run: those of a single run counted once
  int general = 0;                    ///< effects that have a plainer one for their limit
  int stated = 0;                     ///< effects that contradict a constant of the scene
  std::string solved;                 ///< physics beside numerics that are not the nominal's: these, by the name of their effect; as good as one effect more
  double lack_of_fit = 0;             ///< scale of its residuals on the training runs, in units of the noise
  double explained = 0;               ///< share of the nominal's excess chi^2 that it removes
  double error_left = 1;              ///< share of the nominal's rms error beyond noise that it leaves (explained.hpp)
  double accelerations = 1;           ///< share of the missing accelerations that it removes (explained.hpp)
};

struct Ranked {
  std::vector<std::string> effects;   ///< {"unknown"}: something outside the library
  double probability = 0;
  double held_out = 0;
  int model = -1;                     ///< index into the evidence
};

struct Verdict {
  std::string word;                   ///< missing, none, unknown, ambiguous, measurement, numerics
  std::vector<Ranked> ranked;         ///< sums to 1; always has {} and {"unknown"}
  std::vector<std::vector<std::string>> indistinguishable;
  int best = 0;                       ///< index into the evidence
  bool by_fitted_runs = false;        ///< the held-out ones do not show the mismatch
  std::vector<int> rivals;            ///< that cannot be told from the best, the nearest first: indices into the evidence
};

/// Nats that one more parameter costs, and one more effect.
inline constexpr double cost_of_parameter = 1.0, cost_of_effect = 2.0;
/// Nats that a law costs where its plain limit would do as well: what shows nothing beyond the limit is called by the limit's name.
inline constexpr double cost_of_generality = 0.5;
/// Nats that it costs, besides, to say that a constant which the scene states is wrong: whoever wrote it had a reason. And the share of what was left
/// over that it must explain.
inline constexpr double cost_of_stated = 5.0, least_explained_by_stated = 0.9;
/// Candidates closer than this to the best [nats, after the tempering of judge()] cannot be told apart.
inline constexpr double indistinguishable_within = 3.0;
/// Fits within so many nats of each other, on the fitted and on the held-out runs, are alike: a rival with one parameter more that these recordings hardly
/// determine (the third component of a force) is then dearer by that parameter alone, and not by its uncertainty as well.
inline constexpr double alike_within = 1.0;
/// Below this share of what was left over, the best candidate has not explained it; where what it leaves is plainly more than noise,
/// each of its parameters must have explained as much of what the ones before it had left, and the candidate as much of the missing
/// accelerations: in displacements a constant force imitates most of a push that passes.
inline constexpr double least_explained = 0.5;
/// What leaves more than so many times the noise must have brought the error to this share of what it was: any steady force does away
/// with half of what a push, a strip of rougher ground or a repulsion does.
inline constexpr double far_beyond_noise = 3, most_error_left = 0.25;
inline constexpr double level = 0.01;  ///< of the lack of fit
/// chi^2 per degree of freedom from which what a model leaves is systematic: its samples are no longer independent, its runs are.
inline constexpr double plainly_more_than_noise = 2;

/// `evidence[0]` is the nominal. Log likelihoods are divided by the square of the best model's scale (a model that leaves residuals
/// of twice the noise has a quarter of the evidence). Where the best leaves plainly more than noise, the odds against a rival of the
/// same size that explains at least half as much, on training and held-out runs, and four fifths of the share (or fits held-out runs better), are no longer than a paired t test over runs bears
/// out, p : 1 - p. Nested models are no rivals. `lack_of_fit_p` above `level`: none, whatever fits better by chance.
/// `remaining_p`: lack of fit of the best model. If it is not above `level` and the best has explained too little, the best of those that
/// have explained enough is named in its place: part of what is missing; if there is none, `unknown`. If it is above `level` and no held-out run speaks
/// for any model, none of them shows the mismatch (it is in a region where they do not go), and the fitted runs are counted as well. Without `any_held_out`
/// the fitted runs are what the likelihoods are of already.
Verdict judge(const std::vector<Evidence>& evidence, double lack_of_fit_p, double remaining_p, bool any_held_out = true);

}  // namespace repose::diagnosis
