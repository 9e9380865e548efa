#include "analysis/diagnosis/screen.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "analysis/bundle/sensor.hpp"
#include "core/random.hpp"

namespace repose::diagnosis {
namespace {

constexpr double negligible = 1e-6;  // share of a direction that must be left, else it is imitated wholly

/// Orthonormal basis of the columns; those that are linear combinations of others are dropped.
Eigen::MatrixXd basis_of(const Eigen::MatrixXd& columns) {
  if (columns.cols() == 0) return columns;
  Eigen::MatrixXd scaled = columns;
  for (Eigen::Index i = 0; i < scaled.cols(); ++i)
    if (const double size = scaled.col(i).norm(); size > 0) scaled.col(i) /= size;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  qr.setThreshold(1e-9);
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
}

}  // namespace

Nuisance::Nuisance(const Problem& problem, const Fit& fit) {
  Eigen::Index total = 0;
  std::vector<RunJacobian> jacobians;
  for (std::size_t i = 0; i < fit.runs.size(); ++i) {
    first_.push_back(total);
    total += fit.residual[i].size();
    jacobians.push_back(jacobian(problem, fit, fit.runs[i]));
  }
  first_.push_back(total);
  residual_.resize(total);
  Eigen::MatrixXd shared(total, static_cast<Eigen::Index>(fit.layout.shared.size()));
  for (std::size_t i = 0; i < fit.runs.size(); ++i) {
    residual_.segment(first_[i], fit.residual[i].size()) = fit.residual[i];
    own_.push_back(basis_of(jacobians[i].own));
    shared.middleRows(first_[i], fit.residual[i].size()) = jacobians[i].shared;
  }
  shared_ = basis_of(without_own(shared));
}

Eigen::MatrixXd Nuisance::without_own(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd left = columns;
  for (std::size_t i = 0; i < own_.size(); ++i) {
    auto block = left.middleRows(first_[i], first_[i + 1] - first_[i]);
    if (own_[i].cols() > 0) block -= own_[i] * (own_[i].transpose() * block).eval();
  }
  return left;
}

Eigen::MatrixXd Nuisance::left_of(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd left = without_own(columns);
  if (shared_.cols() > 0) left -= shared_ * (shared_.transpose() * left).eval();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < left.cols(); ++i)
    if (left.col(i).norm() > std::max(negligible * columns.col(i).norm(), 1e-9)) kept.push_back(i);
  Eigen::MatrixXd result(left.rows(), static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = left.col(kept[i]);
  return basis_of(result);
}

Eigen::VectorXd Nuisance::left_of_vector(const Eigen::VectorXd& stacked) const {
  Eigen::MatrixXd left = without_own(stacked);
  if (shared_.cols() > 0) left -= shared_ * (shared_.transpose() * left).eval();
  return left.col(0);
}

Screened screen(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, const Term& term, int points) {
  Screened best;
  best.term = term;
  Hypothesis hypothesis = nominal.layout.hypothesis;
  hypothesis.terms.push_back(term);
  const Layout layout = problem.layout(hypothesis);
  const std::size_t shared_before = nominal.layout.shared.size();
  const std::size_t shared_new = layout.shared.size() - shared_before;
  const bool own_only = shared_new == 0;
  const std::size_t own_before = nominal.layout.per_run.front().size();
  const std::size_t count = own_only ? layout.per_run.front().size() - own_before : shared_new;
  if (count == 0) return best;

  Values shared(static_cast<Eigen::Index>(layout.shared.size()));
  for (std::size_t i = 0; i < layout.shared.size(); ++i)
    shared[static_cast<Eigen::Index>(i)] = i < shared_before ? nominal.shared[static_cast<Eigen::Index>(i)] : layout.shared[i].start;
  const auto own_of = [&](std::size_t run) {
    Values own(static_cast<Eigen::Index>(layout.per_run[run].size()));
    for (std::size_t i = 0; i < layout.per_run[run].size(); ++i)
      own[static_cast<Eigen::Index>(i)] = i < nominal.layout.per_run[run].size() ? nominal.own[run][static_cast<Eigen::Index>(i)] : layout.per_run[run][i].start;
    return own;
  };
  const auto stacked = [&](const Values& s, std::size_t own_changed, double own_value) {
    Eigen::VectorXd r(nuisance.size());
    for (std::size_t i = 0; i < nominal.runs.size(); ++i) {
      const std::size_t run = nominal.runs[i];
      Values own = own_of(run);
      if (own_only) own[static_cast<Eigen::Index>(nominal.layout.per_run[run].size() + own_changed)] = own_value;
      r.segment(nuisance.first()[i], nuisance.first()[i + 1] - nuisance.first()[i]) = problem.residual(layout, run, s, own);
    }
    return r;
  };

  // Directions: the first parameter by a profile; vectors by their components; per-run ones by a column for each run.
  const double chi2_before = nuisance.left_of_vector(nuisance.residual()).squaredNorm();
  if (own_only) {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(nuisance.size(), static_cast<Eigen::Index>(count * nominal.runs.size()));
    std::vector<double> moved(count);
    for (std::size_t k = 0; k < count; ++k) {
      const Parameter& p = layout.per_run[nominal.runs.front()][nominal.layout.per_run[nominal.runs.front()].size() + k];
      moved[k] = 10 * p.step;
      const Eigen::VectorXd d = (stacked(shared, k, p.null + moved[k]) - nuisance.residual()) / moved[k];
      for (std::size_t i = 0; i < nominal.runs.size(); ++i)
        columns.col(static_cast<Eigen::Index>(k * nominal.runs.size() + i)).segment(nuisance.first()[i], nuisance.first()[i + 1] - nuisance.first()[i]) =
            d.segment(nuisance.first()[i], nuisance.first()[i + 1] - nuisance.first()[i]);
    }
    best.basis = nuisance.left_of(columns);
    best.gain = (best.basis.transpose() * nuisance.residual()).squaredNorm();
    return best;
  }

  std::vector<std::pair<Values, double>> tried;  // shared values, and the step from nothing
  const auto add = [&](std::size_t k, double value) {
    Values s = shared;
    s[static_cast<Eigen::Index>(shared_before + k)] = value;
    tried.emplace_back(s, value);
  };
  const Parameter& p = layout.shared[shared_before];
  if (p.component >= 0 || !p.logarithmic) {
    const std::size_t components = p.component >= 0 ? std::min<std::size_t>(3, count) : (p.use == Parameter::Use::tilt_x || term.row->name == "gravity_tilt" ? 2 : 1);
    for (std::size_t k = 0; k < components; ++k)
      for (const double share : {-0.3, -0.03, -0.003, 0.003, 0.03, 0.1, 0.3}) {
        const Parameter& q = layout.shared[shared_before + k];
        const double null = std::isfinite(q.null) ? q.null : q.start;
        const double value = null + share * (q.upper - q.lower);
        if (value > q.lower - 1e-12 && value < q.upper) add(k, value);
      }
  } else {
    for (int i = 0; i < points; ++i) {
      const double value = p.lower * std::pow(p.upper / p.lower, (i + 0.5) / points);
      add(0, value);
    }
  }
  Eigen::MatrixXd directions(nuisance.size(), static_cast<Eigen::Index>(tried.size()));
  std::size_t best_index = tried.size();
  double best_chi2 = chi2_before;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const Eigen::VectorXd r = stacked(tried[i].first, 0, 0);
    directions.col(static_cast<Eigen::Index>(i)) = r - nuisance.residual();
    const double chi2 = nuisance.left_of_vector(r).squaredNorm();
    if (chi2 < best_chi2) {
      best_chi2 = chi2;
      best_index = i;
    }
  }
  // One direction per component: the step that gained most, or the smallest one with an effect.
  std::size_t chosen = best_index;
  double largest_ratio = 0;
  for (std::size_t i = 0; i < tried.size(); ++i) {
    const Eigen::MatrixXd q = nuisance.left_of(directions.col(static_cast<Eigen::Index>(i)));
    if (q.cols() == 0) continue;
    const double projected = (q.transpose() * nuisance.residual()).squaredNorm();
    if (best_index == tried.size() && projected > largest_ratio && directions.col(static_cast<Eigen::Index>(i)).norm() < 1e3 * std::sqrt(static_cast<double>(nuisance.size()))) {
      largest_ratio = projected;
      chosen = i;
    }
  }
  if (chosen == tried.size()) return best;
  best.basis = nuisance.left_of(directions.col(static_cast<Eigen::Index>(chosen)));
  best.gain = chi2_before - best_chi2;
  for (std::size_t k = 0; k < shared_new; ++k) best.shared_start.push_back(tried[chosen].first[static_cast<Eigen::Index>(shared_before + k)]);
  return best;
}

double NullDistribution::p(double gain) const {
  const auto reached = static_cast<double>(largest.end() - std::lower_bound(largest.begin(), largest.end(), gain));
  return (1 + reached) / (1 + static_cast<double>(largest.size()));
}

double NullDistribution::quantile(double share) const {
  if (largest.empty()) return 0;
  return largest[std::min(largest.size() - 1, static_cast<std::size_t>(share * static_cast<double>(largest.size())))];
}

NullDistribution largest_gains(const std::vector<Eigen::MatrixXd>& bases, Eigen::Index size, int replicas, std::uint64_t seed) {
  NullDistribution null;
  Random random(seed, 77);
  Eigen::VectorXd e(size);
  for (int b = 0; b < replicas; ++b) {
    for (Eigen::Index i = 0; i < size; ++i) e[i] = normal(random);
    double largest = 0;
    for (const Eigen::MatrixXd& q : bases)
      if (q.cols() > 0) largest = std::max(largest, (q.transpose() * e).squaredNorm());
    null.largest.push_back(largest);
  }
  std::sort(null.largest.begin(), null.largest.end());
  return null;
}

}  // namespace repose::diagnosis
