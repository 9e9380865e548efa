#pragma once
/// What recorded packings say about the coefficients of one candidate, given what its emulator expects.
///
/// The mean of n recorded runs of a setting is normal about the expected one,
///   mean(y) ~ N(m(u), (S + M)/n + D R D),
/// S scatter between seeds, M known variance of the measurement, D the emulator's own uncertainty of each summary, R the correlations
/// of S. With a flat prior over the cube the posterior is summed over points that fill it: no optimiser that could fail, intervals
/// that may be lopsided or reach a bound.
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "analysis/diagnosis/bulk_summary.hpp"

namespace repose::diagnosis {

/// The recorded summaries of all runs with the same settings. Rows: runs.
struct BulkSetting {
  std::vector<Override> set;
  Eigen::MatrixXd train, held;
  std::vector<std::size_t> train_runs, held_runs;  ///< of the bundle
  std::vector<Observation> like = {};              ///< of its first run: at these times and places a simulation is seen
};

struct BulkData {
  std::vector<BulkSummary> summaries;   ///< columns
  std::vector<Eigen::Index> tested;     ///< the three that the lack of fit is tested on
  std::vector<BulkSetting> settings;
  Eigen::VectorXd extra;                ///< M: of a single recorded value that states its own error; 0 where replicates show it
  std::size_t first_fitted() const;     ///< the first setting of which not all runs are held out
};

/// What a model expects: one vector per setting. NaN: cannot be measured there.
struct BulkPrediction {
  std::vector<Eigen::VectorXd> mean, variance;  ///< variance of the mean
};
using Predict = std::function<BulkPrediction(const Eigen::VectorXd& point)>;

struct BulkPosterior {
  Eigen::MatrixXd points;                ///< rows
  Eigen::VectorXd weight;                ///< sums to 1
  Eigen::VectorXd best;                  ///< the likeliest point
  double best_log_likelihood = 0;        ///< of the training runs [nats]
  double held_log_likelihood = 0;        ///< of the means of the held-out runs, averaged over the posterior
  std::vector<double> held_of_run;       ///< of each held-out run alone, settings in order
  /// Weighted quantile along one axis.
  double quantile(Eigen::Index axis, double share) const;
  double sd(Eigen::Index axis) const;
  /// `count` points spread evenly over the weight: where to look next. One row each.
  Eigen::MatrixXd representatives(int count) const;
};

/// `points`: how many fill a cube of more than one axis; a line has its own, finer ones.
BulkPosterior posterior_of(const BulkData& data, const Predict& predict, const Eigen::MatrixXd& scatter, Eigen::Index axes, int points = 4096);

}  // namespace repose::diagnosis
