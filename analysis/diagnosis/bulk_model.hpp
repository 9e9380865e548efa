#pragma once
/// One candidate with the simulations made for it, and what they lead to expect elsewhere.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analysis/diagnosis/bulk_candidate.hpp"
#include "analysis/diagnosis/bulk_posterior.hpp"

namespace repose::diagnosis {

/// One simulation that is asked for.
struct BulkRequest {
  std::string scene;  ///< YAML
  std::uint64_t seed = 1;
  std::string backend = {};  ///< empty: the own one
};

/// What it gave, in the form of a recording: all that can be observed of such a scene, asked for or not.
struct BulkOutcome {
  std::vector<Observation> observations;
  std::string failure;  ///< not empty: the simulation failed, nothing is known
};

/// Runs a batch, in any order, side by side; answers in the order of the requests. nullopt: interrupted (what was finished is kept by
/// whoever runs it, so that the same batch goes on from there). `stage`: for the progress.
using SimulateBulk = std::function<std::optional<std::vector<BulkOutcome>>(const std::string& stage, const std::vector<BulkRequest>&)>;

/// A point of the cube with its replicates.
struct DesignPoint {
  Eigen::VectorXd at;
  std::vector<std::vector<BulkOutcome>> outcomes;  ///< of each setting, of each seed, as the simulation shows them, whatever a recording saw of it
  std::vector<Eigen::MatrixXd> rows;               ///< of each setting: one row of summaries per seed, as recorded
};

struct BulkModel {
  BulkCandidate candidate;
  std::vector<const BulkModel*> parts;  ///< of a pair: what is known of each effect alone is known of it
  std::vector<DesignPoint> design;
  int direct = -1;                ///< index of the design point that stands for the fitted model; -1: none yet
  Eigen::VectorXd error_at_fit;   ///< of the recording's axes, likeliest where `direct` was simulated
  BulkPosterior posterior;
  std::size_t fitted_designs = 0; ///< length of `design` that the posterior knows
};

/// Seen at the times and places of the setting's recordings.
std::vector<BulkOutcome> as_recorded(std::vector<BulkOutcome> outcomes, const BulkSetting& setting);

/// Summaries of outcomes, NaN where there are none. One row each.
Eigen::MatrixXd rows_of(const std::vector<BulkOutcome>& outcomes, const std::vector<BulkSummary>& summaries);

/// Where the model was fitted: the scene's axes as simulated, the recording's as they are likeliest there.
Eigen::VectorXd fitted_point(const BulkModel& model);

/// What the model expects. Without axes in the scene: the means of its replicates, or of the nominal's. Else one emulator for each summary and setting,
/// which knows where the nominal scene and the parts of a pair lie as well. An error of the recording shifts that by what it does to the outcomes at the
/// fit; of two the shifts are added. `nominal` and the parts must outlive the result; `scatter` S between seeds.
Predict predictor(const BulkModel& model, const BulkModel& nominal, const BulkData& data, const Eigen::MatrixXd& scatter);

/// A model and what it expects.
struct Predicted {
  const BulkModel* model;
  Predict predict;
};

/// What `pair`, a candidate of the two models together, would be expected to do if each did what it does alone: a + b - nominal. For foresight. An error of
/// the recording adds no uncertainty to what was simulated. What `a`, `b` and `nominal` point to, and `pair`, must outlive the result.
Predict superposed(const BulkCandidate& pair, const Predicted& a, const Predicted& b, const Predicted& nominal);

/// The replicates that stand for the fitted model, of one setting, as recorded; no rows if it was not simulated.
Eigen::MatrixXd rows_at_fit(const BulkModel& model, const BulkModel& nominal, const BulkData& data, std::size_t setting);
std::vector<BulkOutcome> outcomes_at_fit(const BulkModel& model, const BulkModel& nominal, const BulkData& data, std::size_t setting);

}  // namespace repose::diagnosis
