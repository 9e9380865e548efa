#include "analysis/diagnosis/run_cost.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/side_by_side.hpp"

namespace repose::diagnosis {

double Coordinates::unit(std::size_t i) const {
  const Parameter& p = parameters[i];
  return p.logarithmic ? 1e-2 : 10 * p.step;
}

double Coordinates::to(std::size_t i, double v) const {
  const Parameter& p = parameters[i];
  return (p.logarithmic ? std::log(std::clamp(v, p.lower, p.upper)) : v) / unit(i);
}

double Coordinates::from(std::size_t i, double u) const {
  const Parameter& p = parameters[i];
  const double v = u * unit(i);
  return std::clamp(p.logarithmic ? std::exp(v) : v, p.lower, p.upper);
}

std::vector<double> Coordinates::to(const Values& v) const {
  std::vector<double> u;
  for (std::size_t i = 0; i < parameters.size(); ++i) u.push_back(to(i, v[static_cast<Eigen::Index>(i)]));
  return u;
}

Values Coordinates::from(const double* u) const {
  Values v(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) v[static_cast<Eigen::Index>(i)] = from(i, u[i]);
  return v;
}

RunCost::RunCost(const Problem& problem, const Layout& layout, std::size_t run, double until, std::vector<double*> blocks, bool shared_fixed)
    : problem_(problem), layout_(layout), run_(run), until_(until), blocks_(std::move(blocks)), shared_first_(!layout.shared.empty()), shared_fixed_(shared_fixed) {
  set_num_residuals(static_cast<int>(problem.runs()[run].size));
  if (shared_first_) coordinates_.emplace_back(layout.shared);
  if (!layout.per_run[run].empty()) coordinates_.emplace_back(layout.per_run[run]);
  for (const Coordinates& c : coordinates_) mutable_parameter_block_sizes()->push_back(static_cast<int>(c.parameters.size()));
}

std::vector<std::vector<double>> RunCost::values() const {
  std::vector<std::vector<double>> all;
  for (std::size_t b = 0; b < blocks_.size(); ++b) all.emplace_back(blocks_[b], blocks_[b] + coordinates_[b].parameters.size());
  return all;
}

Eigen::VectorXd RunCost::residual_at(const std::vector<std::vector<double>>& at) const {
  const auto of_block = [&](std::size_t b) { return coordinates_[b].from(at[b].data()); };
  const std::size_t own = shared_first_ ? 1 : 0;
  Eigen::VectorXd r = problem_.residual(layout_, run_, shared_first_ ? of_block(0) : Values(0), own < at.size() ? of_block(own) : Values(0));
  if (r.size() == 0) return r;
  for (const Channel& c : problem_.runs()[run_].channels)
    for (std::size_t i = 0; i < c.time.size(); ++i)
      if (c.time[i] > until_) r[c.first + static_cast<Eigen::Index>(i)] = 0;
  return r;
}

RunCost::Slopes RunCost::slopes(std::size_t block) const {
  const Coordinates& c = coordinates_[block];
  Slopes j(residual_.size(), static_cast<Eigen::Index>(c.parameters.size()));
  std::vector<std::vector<double>> at = at_;
  for (std::size_t i = 0; i < c.parameters.size(); ++i) {
    double& x = at[block][i];
    const double kept = x;
    // Away from a bound that is near, and from where the simulation fails.
    double delta = kept + nudge > c.to(i, c.parameters[i].upper) ? -nudge : nudge;
    x = kept + delta;
    Eigen::VectorXd moved = residual_at(at);
    if (moved.size() == 0) {
      delta = -delta;
      x = kept + delta;
      moved = residual_at(at);
    }
    // Where it fails on both sides the parameter stays, as in jacobian().
    if (moved.size() == 0)
      j.col(static_cast<Eigen::Index>(i)).setZero();
    else
      j.col(static_cast<Eigen::Index>(i)) = (moved - residual_) / delta;
    x = kept;
  }
  return j;
}

void RunCost::prepare(bool with_slopes) {
  if (std::vector<std::vector<double>> now = values(); now != at_) {
    at_ = std::move(now);
    residual_ = residual_at(at_);
    slopes_.clear();
  }
  if (!with_slopes || residual_.size() == 0 || !slopes_.empty()) return;
  for (std::size_t b = 0; b < blocks_.size(); ++b) slopes_.push_back(b == 0 && shared_first_ && shared_fixed_ ? Slopes() : slopes(b));
}

bool RunCost::Evaluate(double const* const*, double* residuals, double** jacobians) const {
  if (residual_.size() == 0) return false;  // the simulation failed: a step that Ceres takes back
  Eigen::Map<Eigen::VectorXd>(residuals, residual_.size()) = residual_;
  for (std::size_t b = 0; jacobians != nullptr && b < blocks_.size(); ++b)
    if (jacobians[b] != nullptr) Eigen::Map<Slopes>(jacobians[b], slopes_[b].rows(), slopes_[b].cols()) = slopes_[b];
  return true;
}

void CostsSideBySide::PrepareForEvaluation(bool with_slopes, bool) {
  side_by_side(costs_.size(), threads_, [&](std::size_t i) { costs_[i]->prepare(with_slopes); });
}

Prior::Prior(const std::vector<Parameter>& parameters) : own_(parameters) {
  set_num_residuals(static_cast<int>(parameters.size()));
  mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters.size()));
}

bool Prior::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const std::size_t n = own_.parameters.size();
  if (jacobians != nullptr && jacobians[0] != nullptr) std::fill(jacobians[0], jacobians[0] + n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const Parameter& p = own_.parameters[i];
    const double slope = p.prior_sd > 0 ? own_.unit(i) / p.prior_sd : 0;
    residuals[i] = slope * (blocks[0][i] - own_.to(i, p.begin()));
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][i * n + i] = slope;
  }
  return true;
}

}  // namespace repose::diagnosis
