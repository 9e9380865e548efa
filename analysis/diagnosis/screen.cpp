#include "analysis/diagnosis/screen.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Dense>

namespace repose::diagnosis {
namespace {

constexpr double poor_fit = 2;  // chi^2 per degree of freedom
constexpr double shares[] = {-0.3, -0.1, -0.03, -0.01, -0.003, 0.003, 0.01, 0.03, 0.1, 0.3, 0.6, 0.9};  // of the range, from nothing
constexpr double small_share = 0.03;
constexpr int further_points = 8;
constexpr std::size_t weaker_points = 3;

double at_log(const Parameter& p, double share) { return p.lower * std::pow(p.upper / p.lower, share); }

/// How many of the first parameters say how strong the effect is: the components of one quantity, a vector or the two angles of a tilt.
std::size_t strengths_of(const std::vector<Parameter>& parameters) {
  std::size_t count = 1;
  while (count < parameters.size() && (parameters[count].component > 0 || parameters[count].unit == "deg") && !parameters[0].logarithmic) ++count;
  return count;
}

double nothing_of(const Parameter& p) { return std::isfinite(p.null) ? p.null : p.start; }

bool is_wave(const std::vector<Parameter>& parameters) {
  return std::any_of(parameters.begin(), parameters.end(), [](const Parameter& p) { return p.key.ends_with(".phase"); });
}

/// Points between those that are tried of a frequency, on either side of `point`; none for what has no phase.
std::vector<Values> between(const std::vector<Parameter>& parameters, const Values& point) {
  std::vector<Values> points;
  if (!is_wave(parameters)) return points;
  for (std::size_t j = strengths_of(parameters); j < parameters.size(); ++j) {
    if (!parameters[j].logarithmic) continue;
    for (const double part : {-0.5, -0.25, 0.25, 0.5}) {
      points.push_back(point);
      double& value = points.back()[static_cast<Eigen::Index>(j)];
      value = std::clamp(value * std::pow(parameters[j].upper / parameters[j].lower, part / (2 * further_points)), parameters[j].lower, parameters[j].upper);
    }
  }
  return points;
}

/// Values of the term's shared parameters that are tried.
std::vector<Values> tried_points(const std::vector<Parameter>& parameters, int points) {
  Values first(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) first[static_cast<Eigen::Index>(i)] = parameters[i].start;
  std::vector<Values> tried;
  const auto add = [&](Values base, std::size_t k, double value) {
    base[static_cast<Eigen::Index>(k)] = value;
    tried.push_back(std::move(base));
  };
  const std::size_t components = strengths_of(parameters);
  const auto linear = [&](const Values& base, std::size_t k, double share) {
    const Parameter& p = parameters[k];
    const double value = nothing_of(p) + share * (p.upper - p.lower);
    if (value >= p.lower && value <= p.upper) add(base, k, value);
  };
  if (parameters[0].logarithmic) {
    for (int i = 0; i < points; ++i) add(first, 0, at_log(parameters[0], (i + 0.5) / points));
  } else {
    for (std::size_t k = 0; k < components; ++k)
      for (const double share : shares) linear(first, k, share);
  }
  // A wave is found by its direction only near its frequency, and as a sum of two, a quarter of a period apart.
  const auto phase = std::find_if(parameters.begin(), parameters.end(), [](const Parameter& p) { return p.key.ends_with(".phase"); });
  const int quarters = is_wave(parameters) ? 2 : 1, count = quarters * further_points;
  for (std::size_t j = components; j < parameters.size(); ++j) {
    if (!parameters[j].logarithmic) continue;
    for (int i = 0; i < count * quarters; ++i) {
      Values base = first;
      base[static_cast<Eigen::Index>(j)] = at_log(parameters[j], (i / quarters + 0.5) / count);
      if (phase != parameters.end()) base[phase - parameters.begin()] += 0.5 * std::numbers::pi * (i % quarters);
      if (parameters[0].logarithmic)
        for (const double share : {0.25, 0.5, 0.75}) add(base, 0, at_log(parameters[0], share));
      else
        for (std::size_t k = 0; k < components; ++k) linear(base, k, small_share);
    }
  }
  return tried;
}

class Screening {
 public:
  Screening(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, const Term& term)
      : problem_(problem), nominal_(nominal), nuisance_(nuisance) {
    Hypothesis hypothesis = nominal.layout.hypothesis;
    hypothesis.terms.push_back(term);
    layout_ = problem.layout(hypothesis);
    layout_.numerics = nominal.layout.numerics;
    best_.term = term;
    left_ = nuisance.left_of_vector(nuisance.residual());
    best_.reached = left_.squaredNorm();
  }

  Screened shared(int points) {
    const auto before = static_cast<Eigen::Index>(nominal_.layout.shared.size());
    const std::vector<Parameter> parameters(layout_.shared.begin() + before, layout_.shared.end());
    Values values(static_cast<Eigen::Index>(layout_.shared.size()));
    values.head(before) = nominal_.shared;
    const bool poor = nominal_.per_dof() > poor_fit;
    std::vector<Eigen::VectorXd> directions;
    for (const Values& point : tried_points(parameters, points)) {
      values.tail(point.size()) = point;
      best_.tried.emplace_back(point.begin(), point.end());
      const Eigen::VectorXd near = stacked(values, false);
      if (near.size() > 0) {
        Probe probe{nuisance_.left_of(near - nuisance_.residual()), true};
        if (probe.basis.cols() > 0) {
          // The basis is a direction up to its sign.
          if (probe.basis.col(0).dot(near - nuisance_.residual()) < 0) probe.basis = -probe.basis;
          directions.push_back(probe.basis.col(0));
          keep(std::move(probe));
        }
        foresee(near, point);
        consider(near, point, false);
      }
      if (poor) consider(stacked(values, true), point, true);
    }
    try_weaker(parameters, values);
    best_.reached = std::min(best_.reached, reached_together(directions));
    return std::move(best_);
  }

  /// Parameters that each run has for itself: all runs and parameters at once.
  Screened own() {
    std::vector<Eigen::VectorXd> columns;
    for (std::size_t i = 0; i < nominal_.runs.size(); ++i) {
      const std::size_t run = nominal_.runs[i], known = nominal_.layout.per_run[run].size();
      for (std::size_t k = known; k < layout_.per_run[run].size(); ++k) {
        Values values = own_of(run, false);
        const double moved = 10 * layout_.per_run[run][k].step;
        values[static_cast<Eigen::Index>(k)] += moved;
        const Eigen::VectorXd r = problem_.residual(layout_, run, nominal_.shared, values);
        if (r.size() == 0) continue;
        columns.push_back(Eigen::VectorXd::Zero(nuisance_.size()));
        columns.back().segment(nuisance_.first()[i], r.size()) = (r - nominal_.residual[i]) / moved;
      }
    }
    Eigen::MatrixXd all(nuisance_.size(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = columns[i];
    Probe probe{nuisance_.left_of(all), false};
    if (probe.basis.cols() > 0) {
      best_.reached -= gain_of(probe, nuisance_.residual());
      keep(std::move(probe));
    }
    return std::move(best_);
  }

  bool has_shared() const { return layout_.shared.size() > nominal_.layout.shared.size(); }

 private:
  Values own_of(std::size_t run, bool from_data) const {
    Values own(static_cast<Eigen::Index>(layout_.per_run[run].size()));
    for (Eigen::Index i = 0; i < own.size(); ++i)
      own[i] = !from_data && i < nominal_.own[run].size() ? nominal_.own[run][i] : layout_.per_run[run][static_cast<std::size_t>(i)].begin();
    return own;
  }

  /// Of a weak effect the points that are tried are all too far, and of a vector they are tried along its axes alone: what the
  /// strongest few directions promise together where the residual is linear. At most as many as a vector has components.
  double reached_together(const std::vector<Eigen::VectorXd>& directions) const {
    double reached = left_.squaredNorm();
    std::vector<Eigen::VectorXd> taken;
    Eigen::VectorXd rest = left_;
    for (int k = 0; k < 3 && !nominal_.residual.empty(); ++k) {
      double most = 0;
      Eigen::VectorXd best;
      for (Eigen::VectorXd d : directions) {
        for (const Eigen::VectorXd& t : taken) d -= t.dot(d) * t;
        if (d.norm() < 0.1) continue;
        d.normalize();
        const double along = d.dot(rest);
        if (along < 0 && along * along > most) most = along * along, best = d;  // against the residual, as in a one-sided probe
      }
      if (best.size() == 0) break;
      reached -= most;
      rest -= best.dot(rest) * best;
      taken.push_back(best);
    }
    return reached;
  }

  /// Empty if any run fails.
  Eigen::VectorXd stacked(const Values& shared, bool from_data) const {
    Eigen::VectorXd all(nuisance_.size());
    for (std::size_t i = 0; i < nominal_.runs.size(); ++i) {
      const Eigen::VectorXd r = problem_.residual(layout_, nominal_.runs[i], shared, own_of(nominal_.runs[i], from_data));
      if (r.size() == 0) return {};
      all.segment(nuisance_.first()[i], r.size()) = r;
    }
    return all;
  }

  void keep(Probe probe) {
    best_.deviate = std::max(best_.deviate, deviate(gain_of(probe, nuisance_.residual()), probe.basis.cols()));
    best_.probes.push_back(std::move(probe));
  }

  /// A point may lie in the right direction and far too far, or just opposite: a wave of the right frequency and too large an
  /// amplitude leads a fit astray, and one half a period late promises nothing as it is.
  struct Foreseen {
    double chi2;   ///< least along the straight line from nothing to the point
    double share;  ///< of the way, where that is; negative: on the other side of nothing
    Values point;
  };

  void foresee(const Eigen::VectorXd& r, const Values& point) {
    const Eigen::VectorXd way = nuisance_.left_of_vector(r - nuisance_.residual());
    const double along = -way.dot(left_), length = way.squaredNorm();
    if (along != 0 && std::abs(along) < length) foreseen_.push_back({left_.squaredNorm() - along * along / length, along / length, point});
  }

  void try_weaker(const std::vector<Parameter>& parameters, Values values) {
    const auto best_first = [&] {
      std::stable_sort(foreseen_.begin(), foreseen_.end(), [](const Foreseen& a, const Foreseen& b) { return a.chi2 < b.chi2; });
    };
    best_first();
    std::vector<Values> closer;
    for (std::size_t i = 0; i < std::min(weaker_points, foreseen_.size()); ++i)
      for (Values& point : between(parameters, foreseen_[i].point)) closer.push_back(std::move(point));
    for (const Values& point : closer) {
      values.tail(point.size()) = point;
      if (const Eigen::VectorXd near = stacked(values, false); near.size() > 0) foresee(near, point);
    }
    best_first();
    for (std::size_t i = 0; i < std::min(weaker_points, foreseen_.size()); ++i) {
      Values point = foreseen_[i].point;
      for (std::size_t k = 0; k < strengths_of(parameters); ++k) {
        double& value = point[static_cast<Eigen::Index>(k)];
        const double nothing = nothing_of(parameters[k]);
        value = std::clamp(nothing + foreseen_[i].share * (value - nothing), parameters[k].lower, parameters[k].upper);
      }
      values.tail(point.size()) = point;
      consider(stacked(values, false), point, false);
    }
  }

  void consider(const Eigen::VectorXd& r, const Values& point, bool from_data) {
    if (r.size() == 0) return;
    const double chi2 = nuisance_.left_of_vector(r).squaredNorm();
    if (!best_.shared_start.empty() && chi2 >= smallest_) return;
    smallest_ = chi2;
    best_.reached = std::min(best_.reached, chi2);
    best_.shared_start.assign(point.begin(), point.end());
    best_.from_data = from_data;
  }

  const Problem& problem_;
  const Fit& nominal_;
  const Nuisance& nuisance_;
  Layout layout_;
  Eigen::VectorXd left_;  // of the nominal's residual, nuisance taken out
  Screened best_;
  std::vector<Foreseen> foreseen_;
  double smallest_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Screened screen(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, const Term& term, int points) {
  Screening screening(problem, nominal, nuisance, term);
  return screening.has_shared() ? screening.shared(points) : screening.own();
}

std::vector<Probe> probes_of(const std::vector<Screened>& screened) {
  std::vector<Probe> probes;
  for (const Screened& s : screened) probes.insert(probes.end(), s.probes.begin(), s.probes.end());
  return probes;
}

double reached_beside(const Nuisance& first, const Screened& second) {
  double gain = 0;
  for (const Probe& probe : second.probes) {
    Probe beside{first.left_of(probe.basis), probe.one_sided};
    if (beside.basis.cols() == 0) continue;
    if (beside.one_sided && beside.basis.col(0).dot(probe.basis.col(0)) < 0) beside.basis = -beside.basis;
    gain = std::max(gain, gain_of(beside, first.residual()));
  }
  return first.left_of_vector(first.residual()).squaredNorm() - gain;
}

std::vector<ScreenedPair> screen_pairs(const std::vector<Screened>& screened, const Eigen::VectorXd& residual, double least) {
  const Eigen::VectorXd& r = residual;
  std::vector<ScreenedPair> pairs;
  const auto gain = [&](const Probe& a, const Probe& b) {
    // Amplitudes of both directions by least squares; both must have the sign that exists.
    const double c = a.basis.col(0).dot(b.basis.col(0)), p = -a.basis.col(0).dot(r), q = -b.basis.col(0).dot(r), s = 1 - c * c;
    if (s < 1e-4) return 0.0;
    const double x = (p - c * q) / s, y = (q - c * p) / s;
    return x > 0 && y > 0 ? x * p + y * q : 0.0;
  };
  for (std::size_t i = 0; i < screened.size(); ++i)
    for (std::size_t j = i + 1; j < screened.size(); ++j) {
      if (screened[i].term.row == screened[j].term.row) continue;
      ScreenedPair pair{i, j, 0};
      double alone = 0;
      for (const Probe& a : screened[i].probes) alone = std::max(alone, gain_of(a, r));
      for (const Probe& b : screened[j].probes) alone = std::max(alone, gain_of(b, r));
      for (const Probe& a : screened[i].probes)
        for (const Probe& b : screened[j].probes)
          if (a.one_sided && b.one_sided) pair.gain = std::max(pair.gain, gain(a, b));
      if (pair.gain > alone + least) pairs.push_back(pair);
    }
  std::sort(pairs.begin(), pairs.end(), [](const ScreenedPair& a, const ScreenedPair& b) { return a.gain > b.gain; });
  return pairs;
}

}  // namespace repose::diagnosis
