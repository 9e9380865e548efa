#include "analysis/diagnosis/locate.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "analysis/diagnosis/probe.hpp"

namespace repose::diagnosis {
namespace {

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

/// Does `b` follow upon `a` in the same phase?
bool follows(const Segment& a, const Segment& b) { return a.body == b.body && a.phase == b.phase && std::abs(a.to - b.from) < 1e-9; }

/// The force is the mean over the time of both, p the smaller.
Located joined(Located a, const Located& b) {
  const double before = a.segment.to - a.segment.from, more = b.segment.to - b.segment.from, both = before + more;
  a.force = (before * a.force + more * b.force) / both;
  a.force_se = ((before * a.force_se).cwiseAbs2() + (more * b.force_se).cwiseAbs2()).cwiseSqrt() / both;
  a.p = std::min(a.p, b.p);
  a.segment = joined(a.segment, b.segment);
  return a;
}

/// Of one run and body: first and last piece, and how much a constant force from the one to the other stands out.
struct Window {
  std::size_t first, last;
  double deviate;
};

/// Those that stand out most and do not overlap.
std::vector<Window> disjoint(std::vector<Window> windows) {
  std::sort(windows.begin(), windows.end(), [](const Window& a, const Window& b) { return a.deviate > b.deviate; });
  std::vector<Window> taken;
  for (const Window& w : windows)
    if (std::none_of(taken.begin(), taken.end(), [&](const Window& t) { return w.first <= t.last && t.first <= w.last; })) taken.push_back(w);
  return taken;
}

}  // namespace

Places locate(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, std::size_t max_runs, int replicas, std::uint64_t seed) {
  std::vector<Located> entries;
  std::vector<Window> windows;
  std::vector<Probe> probes;
  const Fit& fit = nominal;
  for (std::size_t i = 0; i < std::min(fit.runs.size(), max_runs); ++i) {
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
      std::vector<Eigen::MatrixXd> responses;  // of the pieces since the phase began
      std::size_t begun = entries.size();
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
        if (probe.basis.cols() == 0) {
          responses.clear();
          begun = entries.size();
          continue;
        }
        entry.deviate = deviate(gain_of(probe, nuisance.residual()), probe.basis.cols());
        all.conservativeResize(Eigen::NoChange, all.cols() + 3);
        all.rightCols(3) = columns.middleRows(first, size);
        probes.push_back(std::move(probe));
        of_run.push_back(entries.size());
        if (!responses.empty() && !follows(entries.back().segment, segment)) responses.clear();
        if (responses.empty()) begun = entries.size();
        entries.push_back(entry);
        windows.push_back({entries.size() - 1, entries.size() - 1, entry.deviate});
        // The last few pieces together: responses add.
        for (std::size_t n = responses.size(); n-- > 0;) {
          columns.middleRows(first, size) += responses[n];
          const Probe together{nuisance.left_of(columns), false};
          windows.push_back({begun + n, entries.size() - 1, deviate(gain_of(together, nuisance.residual()), together.basis.cols())});
        }
        responses.push_back(all.rightCols(3).eval());
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
  if (entries.empty()) return {};
  const NullDistribution null = null_of(probes, nuisance.residual(), replicas, seed);
  for (Located& e : entries) e.p = null.p(e.deviate);
  Places places;
  for (const Window& w : disjoint(std::move(windows))) {
    Located stretch = entries[w.first];
    for (std::size_t n = w.first + 1; n <= w.last; ++n) stretch = joined(std::move(stretch), entries[n]);
    stretch.deviate = w.deviate;
    places.stretches.push_back(stretch);
  }
  sort_by_p(places.stretches);
  sort_by_p(entries);
  places.pieces = std::move(entries);
  return places;
}

}  // namespace repose::diagnosis
