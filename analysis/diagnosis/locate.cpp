#include "analysis/diagnosis/locate.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "analysis/diagnosis/probe.hpp"

namespace repose::diagnosis {
namespace {

constexpr double significant = 0.01;
constexpr double visible = 1;         // sigma: a component whose whole weight moves the record by less cannot be estimated
constexpr double trial_share = 0.02;  // of a body's weight: small against what matters, large against rounding

/// The observable of the run that moves most with the direction d.
std::string most_moved(const RunData& data, const Eigen::VectorXd& d) {
  std::string best = "position";
  double largest = -1;
  for (const Channel& c : data.channels) {
    const double size = d.segment(c.first, static_cast<Eigen::Index>(c.time.size())).squaredNorm();
    if (size > largest) {
      largest = size;
      best = c.observable;
    }
  }
  return best;
}

void sort_by_p(std::vector<Located>& entries) {
  std::sort(entries.begin(), entries.end(), [](const Located& a, const Located& b) { return a.p != b.p ? a.p < b.p : a.deviate > b.deviate; });
}

bool one_stretch(const Located& a, const Located& b) {
  return a.run == b.run && a.segment.body == b.segment.body && a.segment.phase == b.segment.phase &&
         std::abs(a.segment.to - b.segment.from) < 1e-9 && a.p <= significant && b.p <= significant && a.force.dot(b.force) > 0;
}

}  // namespace

std::vector<Located> locate(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, int max_runs, int replicas,
                            std::uint64_t seed) {
  std::vector<Located> entries;
  std::vector<Probe> probes;
  const Fit& fit = nominal;
  for (std::size_t i = 0; i < std::min<std::size_t>(fit.runs.size(), static_cast<std::size_t>(max_runs)); ++i) {
    const std::size_t run = fit.runs[i];
    const RunData& data = problem.runs()[run];
    const History history = problem.history(fit.layout, run, fit.shared, fit.own[run]);
    const Eigen::Index first = nuisance.first()[i], size = nuisance.first()[i + 1] - first;
    std::vector<std::size_t> of_run;
    Eigen::MatrixXd all(size, 0);
    for (const auto& [body, track] : history.bodies) {
      const bool observed = std::any_of(data.channels.begin(), data.channels.end(), [&, name = body](const Channel& c) { return c.body == name; });
      if (!observed) continue;
      const double weight = history.mass.at(body) * gravity_scale(history);
      for (const Segment& segment : segments_of(history, body, data.horizon, 8)) {
        Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(nuisance.size(), 3);
        for (int k = 0; k < 3; ++k) {
          WindowLoad load{body, segment.from, segment.to, trial_share * weight * Vec3::Unit(k), Vec3::Zero()};
          const Eigen::VectorXd r = problem.residual(fit.layout, run, fit.shared, fit.own[run], {load});
          if (r.size() > 0) columns.col(k).segment(first, size) = (r - fit.residual[i]) / trial_share;
        }
        Located entry;
        entry.run = run;
        entry.segment = segment;
        entry.mass = history.mass.at(body);
        entry.observable = most_moved(data, columns.rowwise().sum().segment(first, size));
        Probe probe{nuisance.left_of(columns), false};
        if (probe.basis.cols() == 0) continue;
        entry.deviate = deviate(gain_of(probe, nuisance.residual()), probe.basis.cols());
        all.conservativeResize(Eigen::NoChange, all.cols() + 3);
        all.rightCols(3) = columns.middleRows(first, size);
        probes.push_back(std::move(probe));
        of_run.push_back(entries.size());
        entries.push_back(entry);
      }
      // The forces of all segments together, so that none speaks for its neighbours; in units of the weight, a little stiff.
      if (all.cols() == 0) continue;
      const RunJacobian j = jacobian(problem, fit, run);
      Eigen::MatrixXd a(size, all.cols() + j.own.cols());
      a << all, j.own;
      for (Eigen::Index c = 0; c < all.cols(); ++c)
        if (a.col(c).norm() < visible) a.col(c).setZero();
      Eigen::VectorXd column_size = a.colwise().norm().transpose();
      for (double& size_of : column_size) size_of = size_of > 0 ? size_of : 1;
      Eigen::MatrixXd scaled = a * column_size.cwiseInverse().asDiagonal();
      Eigen::MatrixXd normal = scaled.transpose() * scaled;
      normal.diagonal().array() += 1e-6;
      const Eigen::MatrixXd inverse = normal.inverse();
      const Eigen::VectorXd solution = column_size.cwiseInverse().asDiagonal() * (inverse * (scaled.transpose() * -fit.residual[i]));
      for (std::size_t n = 0; n < of_run.size() && static_cast<Eigen::Index>(3 * n + 2) < all.cols(); ++n)
        for (int k = 0; k < 3; ++k) {
          const auto c = static_cast<Eigen::Index>(3 * n) + k;
          entries[of_run[n]].force[k] = weight * solution[c];
          entries[of_run[n]].force_se[k] = a.col(c).isZero(0) ? weight : weight * std::sqrt(inverse(c, c)) / column_size[c];
        }
    }
  }
  if (entries.empty()) return entries;
  const NullDistribution null = null_of(probes, nuisance.size(), replicas, seed);
  for (Located& e : entries) e.p = null.p(e.deviate);
  sort_by_p(entries);
  return entries;
}

std::vector<Located> join_neighbours(std::vector<Located> entries) {
  std::sort(entries.begin(), entries.end(), [](const Located& a, const Located& b) {
    return std::tie(a.run, a.segment.body, a.segment.from) < std::tie(b.run, b.segment.body, b.segment.from);
  });
  std::vector<Located> result;
  for (const Located& e : entries) {
    if (result.empty() || !one_stretch(result.back(), e)) {
      result.push_back(e);
      continue;
    }
    Located& last = result.back();
    const double before = last.segment.to - last.segment.from, more = e.segment.to - e.segment.from, both = before + more;
    last.force = (before * last.force + more * e.force) / both;
    last.force_se = ((before * last.force_se).cwiseAbs2() + (more * e.force_se).cwiseAbs2()).cwiseSqrt() / both;
    last.segment.to = e.segment.to;
    last.deviate = std::max(last.deviate, e.deviate);
    last.p = std::min(last.p, e.p);
  }
  sort_by_p(result);
  return result;
}

}  // namespace repose::diagnosis
