#pragma once
/// The residual of one run as Ceres asks for it: all runs are evaluated side by side before Ceres looks at the first, so that sums are made in
/// one order and a fit is the same, bit by bit, at any number of threads.
#include <ceres/ceres.h>

#include <vector>

#include <Eigen/Core>

#include "analysis/diagnosis/problem.hpp"

namespace repose::diagnosis {

/// Parameters as the optimiser sees them: ln of logarithmic ones, all in units of ten differencing steps.
struct Coordinates {
  explicit Coordinates(const std::vector<Parameter>& p) : parameters(p) {}
  double unit(std::size_t i) const;
  double to(std::size_t i, double v) const;
  double from(std::size_t i, double u) const;
  std::vector<double> to(const Values& v) const;
  Values from(const double* u) const;
  const std::vector<Parameter>& parameters;
};

inline constexpr double nudge = 0.1;  ///< of differences, in units of Coordinates

/// Residual of a run until a time [s], and its slopes by differences. `blocks`: the optimiser's values, shared ones first, of what there is;
/// `shared_fixed`: nobody asks for slopes in the shared ones.
class RunCost final : public ceres::CostFunction {
 public:
  RunCost(const Problem& problem, const Layout& layout, std::size_t run, double until, std::vector<double*> blocks, bool shared_fixed);

  /// Evaluates at the values that the blocks have now.
  void prepare(bool with_slopes);
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  using Slopes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<std::vector<double>> values() const;
  Eigen::VectorXd residual_at(const std::vector<std::vector<double>>& at) const;
  Slopes slopes(std::size_t block) const;

  const Problem& problem_;
  const Layout& layout_;
  std::size_t run_;
  double until_;
  std::vector<double*> blocks_;
  std::vector<Coordinates> coordinates_;  ///< of each block
  bool shared_first_, shared_fixed_;
  std::vector<std::vector<double>> at_;   ///< where the rest was evaluated
  Eigen::VectorXd residual_;              ///< empty: the simulation failed
  std::vector<Slopes> slopes_;            ///< of each block; none: not asked for
};

/// Has all costs evaluated before Ceres reads them.
class CostsSideBySide final : public ceres::EvaluationCallback {
 public:
  explicit CostsSideBySide(int threads) : threads_(threads) {}
  void add(RunCost* cost) { costs_.push_back(cost); }
  void PrepareForEvaluation(bool with_slopes, bool new_point) override;

 private:
  int threads_;
  std::vector<RunCost*> costs_;
};

/// Keeps start values that a run hardly determines (a push into the floor on which a ball lies) near what was read off the data. It is no
/// part of chi^2.
class Prior final : public ceres::CostFunction {
 public:
  explicit Prior(const std::vector<Parameter>& parameters);
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  Coordinates own_;
};

}  // namespace repose::diagnosis
