#pragma once
/// The few-body problem: runs with their data, and the residuals of a hypothesis at given parameter values.
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "analysis/bundle/bundle.hpp"
#include "analysis/diagnosis/hypothesis.hpp"
#include "analysis/diagnosis/observation_model.hpp"
#include "analysis/history.hpp"

namespace repose::diagnosis {

/// One measured number sequence of a run: an axis of a position or orientation, or a series.
struct Channel {
  std::string observable;  ///< "position", "orientation", or the series' name
  std::string body;
  int axis = 0;
  double noise = 1;        ///< standard deviation of one sample
  double phi = 0;          ///< correlation of neighbours
  std::vector<double> time;
  Eigen::Index first = 0;  ///< of its residuals in the run's vector; as many as times
};

/// What is compared of one run.
struct RunData {
  const BundleRun* run = nullptr;
  YamlNode tree;                    ///< the nominal scene with the run's own settings
  std::vector<Parameter> start;     ///< free start values, begun from the data
  std::vector<Channel> channels;
  double horizon = 0;               ///< [s]: later samples are left out, for noise in the start grows beyond use
  Eigen::Index size = 0;
};

/// Values of one run under a hypothesis, in the order: calibrated, shared of the terms, start values, per run of the terms.
using Values = Eigen::VectorXd;

/// A hypothesis with its parameters laid out.
struct Layout {
  Hypothesis hypothesis;
  std::vector<Parameter> shared;                ///< calibrated constants, then shared parameters of the terms
  std::vector<std::vector<Parameter>> per_run;  ///< of each run of the problem
  double step_factor = 1;                       ///< of the time step
  double tolerance_factor = 1;
};

class Problem {
 public:
  /// `runs`: indices into the bundle's runs that are used. Estimates noise where it is not given, start values where they
  /// are free, and how far each run can be followed. `bundle` must outlive the problem.
  Problem(const Bundle& bundle, const std::vector<std::size_t>& runs, Simulate simulate);

  const std::vector<RunData>& runs() const { return runs_; }
  const Bundle& bundle() const { return bundle_; }
  const NaturalScale& scale() const { return scale_; }
  Layout layout(const Hypothesis& hypothesis) const;

  /// (simulated - recorded) / noise, whitened, all channels of the run. Large constant residuals if the simulation fails.
  Eigen::VectorXd residual(const Layout& layout, std::size_t run, const Values& shared, const Values& own,
                           const std::vector<WindowLoad>& loads = {}) const;
  /// The path that the hypothesis predicts, with contacts.
  History history(const Layout& layout, std::size_t run, const Values& shared, const Values& own) const;
  /// The scene of a run under the hypothesis, as YAML.
  YamlNode scene(const Layout& layout, std::size_t run, const Values& shared, const Values& own) const;

  /// The nominal scene with the terms and shared parameters of a fit, as YAML: no run's own settings.
  YamlNode extended_scene(const Layout& layout, const Values& shared) const;

  std::size_t simulations() const { return simulations_; }
  /// As residual(), not whitened.
  Eigen::VectorXd plain_residual(const Layout& layout, std::size_t run, const Values& shared, const Values& own,
                                 const std::vector<WindowLoad>& loads = {}) const;
  /// Noise by observable, as used: of the sensor, at least 1e-4 of the observable's range, and of the time step.
  const std::map<std::string, NoiseModel>& noise() const { return noise_; }

 private:
  void add_run(std::size_t index);
  void set_up_channels(RunData& data) const;
  void find_horizon(std::size_t run);
  void find_noise(const std::vector<std::size_t>& runs);
  /// Adds to the noise (in squares) how far runs at h and h/2 part: the step must not pass for physics.
  void add_numerics();

  const Bundle& bundle_;
  Simulate simulate_;
  NaturalScale scale_;
  std::vector<Parameter> calibrated_;
  std::map<std::string, NoiseModel> noise_;  ///< by observable
  std::vector<RunData> runs_;
  mutable std::mutex mutex_;
  mutable std::unordered_map<std::uint64_t, Eigen::VectorXd> cache_;
  mutable std::size_t simulations_ = 0;
};

/// Start values of a run from its own first samples: position and orientation of the first sample, velocity and spin from a
/// straight line through the first few. Only for the keys of `free` that can be seen; others start from `tree`, the
/// scene with the run's own settings. A key may name one component (`bodies.ball.velocity.2`), or a positive number.
std::vector<Parameter> start_values(const BundleRun& run, const YamlNode& tree, const std::map<std::string, double>& noise);

}  // namespace repose::diagnosis
