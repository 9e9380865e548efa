#pragma once
/// Diagnosis of recordings of many grains: the twelve steps where a simulation is dear and a packing random.
///
///   1 observation model   bulk_summary.hpp; scatter between seeds, bulk_statistics.hpp
///   2 calibration         on an emulator over the constants that nobody measured, bulk_emulator.hpp
///   3 nested optimum      every emulator knows the nominal runs, that of a pair those of its parts as well; one summed over points that fill its axes cannot fail
///   4 lack of fit         Hotelling's T^2 on at most three summaries chosen beforehand; several settings by Fisher; in doubt
///                         three times as many packings of the nominal scene decide. What a pair leaves: all summaries, shrunken covariance
///   5 locate              bulk_locate.hpp
///   7 candidates          bulk_candidate.hpp, bulk_recording_error.hpp: a profile of few runs each, then more runs where the posterior lies, for the best
///                         few; pairs where one effect is not enough; the nominal scene solved more finely and by other engines
///   8 verdict             verdict.hpp, on held-out runs, all summaries, shrunken covariance
///   9 confounding         bulk_separation.hpp
///  10 uncertainty         bulk_posterior.hpp
///  11 before and after    the fitted model is simulated directly and laid beside the held-out runs
///  12 write back          the extended scene holds the values that were simulated
#include <map>

#include "analysis/diagnosis/bulk_locate.hpp"
#include "analysis/diagnosis/bulk_model.hpp"
#include "analysis/diagnosis/bulk_separation.hpp"
#include "analysis/diagnosis/verdict.hpp"

namespace repose::diagnosis {

/// A bundle of many grains: its scene has grains and what was observed can be summarised.
bool is_bulk(const Bundle& bundle);

struct BulkOptions {
  std::uint64_t seed = 1;
  std::vector<std::string> effects;  ///< to try; empty: bulk_effects()
  int most_candidates = 8;           ///< of those, if none are named
  int nominal_seeds = 10, levels = 4, level_seeds = 2;
  int doubtful_seeds = 20;           ///< more of the nominal scene, where those neither reject it plainly nor fit it well
  int refined = 4, refined_points = 3, refined_seeds = 2;
  int direct_seeds = 8, numerics_seeds = 3;  ///< a finer step costs four times as much
  int pairs = 3, pair_points = 6;            ///< simulated, where one effect is not enough; points of each
  std::vector<std::string> other_backends;   ///< that may have made the recordings
};

struct BulkEstimate {
  std::string name, unit, effect;
  double value = 0, lower = 0, upper = 0;  ///< 90 %, of the posterior
};

struct BulkScore {
  std::vector<std::size_t> runs;           ///< of the bundle
  double chi2_per_dof = 0;                 ///< mean over runs of (y - m)^T S^-1 (y - m) / d
  std::map<std::string, double> rmse;      ///< by summary
};

struct BulkFitted {
  BulkModel model;
  std::vector<BulkEstimate> estimates;
  BulkScore train, held_out;
};

struct BulkDiagnosis {
  BulkData data;
  Verdict verdict;
  std::vector<BulkFitted> models;       ///< [0]: nominal; empty if it was interrupted before that
  std::size_t best = 0;
  double lack_of_fit_p = 1, remaining_p = 1, explained = 0;
  int tested_dimensions = 0;            ///< of the lack of fit; 0: it could not be tested
  std::vector<BulkLocated> where;
  std::vector<SuggestedRecording> suggested;
  double paired_p = 1, effect_size = 0;
  Eigen::MatrixXd scatter;              ///< S, of the summaries
  int scatter_dof = 0;
  std::vector<std::string> notes;
  std::string extended_scene;           ///< YAML
  std::size_t simulations = 0;
  bool interrupted = false;
};

/// Throws Error (Kind::input) if nothing recorded can be summarised, or if a candidate is asked for that does not exist.
BulkDiagnosis diagnose_bulk(const Bundle& bundle, const SimulateBulk& simulate, const BulkOptions& options);

}  // namespace repose::diagnosis
