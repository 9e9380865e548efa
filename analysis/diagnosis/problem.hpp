#pragma once
/// The few-body problem: runs with their data, and the residuals of a hypothesis at given parameter values.
#include <atomic>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "analysis/bundle/bundle.hpp"
#include "analysis/diagnosis/hypothesis.hpp"
#include "analysis/diagnosis/measurement.hpp"
#include "analysis/diagnosis/observation_model.hpp"
#include "analysis/diagnosis/simulation_store.hpp"
#include "analysis/history.hpp"

namespace repose::diagnosis {

/// Of the scene's step: recordings may themselves be simulated, by a maker who took a finer step but no exact one.
inline constexpr double step_of_makers = 0.25;

/// A sample counts as off by no more, in units of the noise; one that cannot be simulated as off by this.
inline constexpr double largest_residual = 1e6;

/// What is compared of one run.
struct RunData {
  const BundleRun* run = nullptr;
  YamlNode tree;                    ///< the nominal scene with the run's own settings
  std::vector<Parameter> start;     ///< free start values, begun from the data
  std::vector<Channel> channels;
  double recorded = 0;              ///< [s]: the last sample
  double horizon = 0;               ///< [s]: later samples are left out, for noise in the start grows beyond use
  bool hits = false;                ///< bodies come into contact at speed: the path jumps with the step in which an engine of first order sees that
  Eigen::Index size = 0;
  std::uint64_t fingerprint = 0;    ///< of the recorded numbers
};

/// Values of one run under a hypothesis, in the order: calibrated, shared of the terms, start values, per run of the terms.
using Values = Eigen::VectorXd;

/// How the scene is solved under a hypothesis, beside the scene's own settings.
struct Numerics {
  double step_factor = 1;       ///< of the time step; above 1 only where that does not show in the readings
  double tolerance_factor = 1;
  bool other_law = false;       ///< the relaxed contact law where the scene has the exact one, and the other way round
  bool second_order = false;    ///< Integration::second_order, whatever the scene says
  std::string backend;          ///< that solves it, by its name; empty: the diagnosis's own
};

/// A hypothesis with its parameters laid out.
struct Layout {
  Hypothesis hypothesis;
  std::vector<Parameter> shared;                ///< calibrated constants, then shared parameters of the terms
  std::vector<std::vector<Parameter>> per_run;  ///< of each run of the problem
  Numerics numerics;
};

class Problem {
 public:
  /// `runs`: indices into the bundle's runs that are used. Estimates noise where it is not given, start values where they
  /// are free, and how far each run can be followed. `bundle` and `store` (none: one of its own) must outlive the problem. `coarser_step`: see numerics().
  Problem(const Bundle& bundle, const std::vector<std::size_t>& runs, Simulate simulate, SimulationStore* store = nullptr, bool coarser_step = true);

  const std::vector<RunData>& runs() const { return runs_; }
  const Bundle& bundle() const { return bundle_; }
  const NaturalScale& scale() const { return scale_; }
  Layout layout(const Hypothesis& hypothesis) const;

  /// (simulated - recorded) / noise, whitened, all channels of the run. Empty if the simulation fails: not a feasible point.
  Eigen::VectorXd residual(const Layout& layout, std::size_t run, const Values& shared, const Values& own,
                           const std::vector<WindowLoad>& loads = {}) const;
  /// The path that the hypothesis predicts, with contacts.
  History history(const Layout& layout, std::size_t run, const Values& shared, const Values& own) const;
  /// The scene of a run under the hypothesis, as YAML.
  YamlNode scene(const Layout& layout, std::size_t run, const Values& shared, const Values& own) const;

  /// The nominal scene with the terms and shared parameters of a fit, as YAML: no run's own settings.
  YamlNode extended_scene(const Layout& layout, const Values& shared) const;

  /// Begins the run's start values at `own` and follows it for as long as changes of them by the columns of `spread`, with any signs,
  /// act linearly; never for less than before. Changes what the run is compared with: only before anything is fitted.
  void follow(std::size_t run, const Values& own, const Eigen::MatrixXd& spread);

  std::size_t simulations() const { return simulations_; }
  /// As residual(), not whitened.
  Eigen::VectorXd plain_residual(const Layout& layout, std::size_t run, const Values& shared, const Values& own,
                                 const std::vector<WindowLoad>& loads = {}) const;
  /// Noise by observable, as used: of the sensor, at least 1e-4 of the observable's range, and of the time step.
  const std::map<std::string, NoiseModel>& noise() const { return noise_; }
  /// The same before what the step may be wrong by was added, in squares.
  const std::map<std::string, double>& sensor_noise() const { return sensor_noise_; }
  /// How hypotheses are solved: in second order where the backend can, otherwise as the scene is given. A scene that is stepped far more finely than it was
  /// recorded is stepped more coarsely (up to eight times its step, at most a tenth of the time between samples), as long as the nominal's readings move in no
  /// run by a fiftieth of their noise, rms, beyond what start values imitate. Whoever fits it asks again (moved_by_coarser_step).
  const Numerics& numerics() const { return numerics_; }
  /// What the scene's own way to solve it is wrong by, beyond what start values imitate: by observable, in units of noise(), rms of
  /// the run in the middle. Empty where second order is not to be had.
  const std::map<std::string, double>& scene_error() const { return scene_error_; }

 private:
  void add_run(std::size_t index);
  bool hits(std::size_t run) const;
  void see_periods(Parameter& frequency) const;
  void set_up_channels(RunData& data) const;
  double linear_until(std::size_t run, const Values& own, const Eigen::MatrixXd& spread) const;
  YamlNode solved_by(YamlNode tree, const Layout& layout) const;
  void choose_numerics(bool coarser_step);
  void coarsen_step();
  bool simulated_by(const Numerics& numerics) const;
  /// Adds to the noise (in squares) what the step may be wrong by: it must not pass for physics.
  void add_numerics();
  /// How far the simulations of two ways to solve part, without what start values imitate: by observable, rms in units of the
  /// noise, the quantile `share` of all runs. Empty if one of them fails.
  std::map<std::string, double> parting(const Numerics& one, const Numerics& other, double share = 0.5) const;
  /// `of` without what changes of the start values do to first order.
  Eigen::VectorXd beyond_start_values(const Layout& layout, std::size_t run, const Values& shared, Eigen::VectorXd of) const;

  const Bundle& bundle_;
  Simulate simulate_;
  NaturalScale scale_;
  std::vector<Parameter> calibrated_;
  std::map<std::string, NoiseModel> noise_;  ///< by observable
  std::map<std::string, double> sensor_noise_;
  std::vector<RunData> runs_;
  Numerics numerics_;
  std::map<std::string, double> scene_error_;
  mutable SimulationStore own_store_;
  SimulationStore* store_;
  mutable std::atomic<std::size_t> simulations_{0};
};

}  // namespace repose::diagnosis
