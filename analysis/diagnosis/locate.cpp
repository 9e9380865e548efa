#include "analysis/diagnosis/locate.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "analysis/diagnosis/probe.hpp"

namespace repose::diagnosis {
namespace {

constexpr double visible = 1;         // sigma: a component whose whole weight moves the record by less cannot be estimated
constexpr double stands_out_alike = 0.5;  // in strengths (probe.hpp): what a force that stays the same from piece to piece may lack of what acts
constexpr std::size_t most_together = 12;  // pieces: a body that chatters has hundreds
constexpr double near_enough = 1.5;        // times the sum of the radii of equal volume, for bodies that are no balls
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
  std::stable_sort(entries.begin(), entries.end(), [](const Located& a, const Located& b) { return a.p != b.p ? a.p < b.p : a.strength > b.strength; });
}

/// Pieces of two bodies, in which both are hit at the same time.
bool hit_together(const Segment& a, const Segment& b) {
  return a.phase == Phase::impact && b.phase == Phase::impact && a.body < b.body && a.from < b.to && b.from < a.to;
}

/// An impact is seen no more exactly than the samples beside it: its window is wider by one of them on either side. The force stays the mean over it.
Located as_seen(Located impact, const RunData& data) {
  double sample = 0;
  for (const Channel& c : data.channels)
    if (c.observable == impact.observable && c.body == impact.segment.body && c.time.size() > 1)
      sample = (c.time.back() - c.time.front()) / static_cast<double>(c.time.size() - 1);
  const double before = impact.segment.to - impact.segment.from;
  impact.segment.from = std::max(0.0, impact.segment.from - sample);
  impact.segment.to = std::min(data.horizon, impact.segment.to + sample);
  const double share = before / std::max(impact.segment.to - impact.segment.from, before);
  for (int k = 0; k < 3; ++k)
    if (impact.force[k] != 0) {  // a component that cannot be seen stays as unknown as it was
      impact.force[k] *= share;
      impact.force_se[k] *= share;
    }
  return impact;
}

/// Of one run and body: first and last piece, alike in phase, with nothing but impacts between, and how much one force in all of them stands out.
struct Window {
  std::size_t first, last;
  Phase phase;
  double strength;
  double lasts;  ///< from the beginning of the first to the end of the last [s]

  bool overlaps(const Window& other) const { return phase == other.phase && first <= other.last && other.first <= last; }
  bool contains(const Window& other) const { return phase == other.phase && first <= other.first && other.last <= last; }
};

/// Those that stand out most and do not overlap. What acts does so all along a phase more often than in a part of it, and forces that stay the same
/// from piece to piece are only nearly what acts: of windows that stand out alike, the longest.
std::vector<Window> disjoint(std::vector<Window> windows) {
  std::stable_sort(windows.begin(), windows.end(), [](const Window& a, const Window& b) { return a.strength > b.strength; });
  std::vector<Window> taken;
  const auto is_free = [&](const Window& w) { return std::none_of(taken.begin(), taken.end(), [&](const Window& t) { return t.overlaps(w); }); };
  for (const Window& most : windows) {
    if (!is_free(most)) continue;
    Window longest = most;
    for (const Window& w : windows)
      if (w.contains(most) && w.strength > most.strength - stands_out_alike && w.lasts > longest.lasts && is_free(w)) longest = w;
    taken.push_back(longest);
  }
  return taken;
}

/// The pieces of all runs that are looked at, each tested by a constant force.
class Locating {
 public:
  Locating(const Problem& problem, const Fit& fit, const Nuisance& nuisance) : problem_(problem), fit_(fit), nuisance_(nuisance) {}

  void look_at(std::size_t i) {
    run_ = fit_.runs[i];
    residual_ = &fit_.residual[i];
    first_ = nuisance_.first()[i];
    size_ = nuisance_.first()[i + 1] - first_;
    first_entry_ = entries_.size();
    first_window_ = windows_.size();
    responses_.resize(size_, 0);
    const History history = problem_.history(fit_.layout, run_, fit_.shared, fit_.own[run_]);
    gravity_ = gravity_scale(history);
    const RunData& data = problem_.runs()[run_];
    for (const auto& [body, track] : history.bodies)
      if (std::any_of(data.channels.begin(), data.channels.end(), [&, name = body](const Channel& c) { return c.body == name; }))
        test_pieces(history, body);
    test_contact_impulses(history);
    estimate_forces();
  }

  Places places(int replicas, std::uint64_t seed) {
    if (entries_.empty()) return {};
    const NullDistribution null = null_of(probes_, nuisance_.residual(), replicas, seed);
    for (Located& e : entries_) e.p = null.p(e.deviate);
    Places places;
    for (const Window& w : disjoint(std::move(windows_))) {
      Located stretch = stretch_of(w);
      if (stretch.segment.phase == Phase::impact) stretch = as_seen(std::move(stretch), problem_.runs()[stretch.run]);
      places.stretches.push_back(stretch);
    }
    sort_by_p(places.stretches);
    sort_by_p(entries_);
    places.pieces = std::move(entries_);
    return places;
  }

 private:
  /// The force is the mean over the time in the phase, p and deviate those of the piece that stands out most.
  Located stretch_of(const Window& window) const {
    Located stretch = entries_[window.first];
    Vec3 impulse = Vec3::Zero(), variance = Vec3::Zero();
    double lasts = 0;
    for (std::size_t n = window.first; n <= window.last; ++n) {
      const Located& piece = entries_[n];
      if (piece.segment.phase != stretch.segment.phase) continue;
      if (n > window.first) stretch.segment = joined(stretch.segment, piece.segment);
      const double time = piece.segment.to - piece.segment.from;
      impulse += time * piece.force;
      variance += (time * piece.force_se).cwiseAbs2();
      lasts += time;
      stretch.p = std::min(stretch.p, piece.p);
      stretch.deviate = std::max(stretch.deviate, piece.deviate);
    }
    stretch.strength = window.strength;
    stretch.force = impulse / lasts;
    stretch.force_se = variance.cwiseSqrt() / lasts;
    return stretch;
  }

  /// What a force during the segment does to the residual of the run, along x, y and z; with a torque: what that does.
  Eigen::MatrixXd response(const Segment& segment, double force, double torque = 0) const {
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(size_, 3);
    for (int k = 0; k < 3; ++k) {
      const WindowLoad load{segment.body, segment.from, segment.to, trial_share * force * Vec3::Unit(k), trial_share * torque * Vec3::Unit(k)};
      const Eigen::VectorXd r = problem_.residual(fit_.layout, run_, fit_.shared, fit_.own[run_], {load});
      if (r.size() > 0) columns.col(k) = (r - *residual_) / trial_share;
    }
    return columns;
  }

  Probe probe_of(const Eigen::MatrixXd& columns) const {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(nuisance_.size(), columns.cols());
    all.middleRows(first_, size_) = columns;
    return {nuisance_.left_of(all), false};
  }

  double deviate_of(const Probe& probe) const { return deviate(gain_of(probe, nuisance_.residual()), probe.basis.cols()); }
  double strength_of(const Probe& probe) const { return strength(gain_of(probe, nuisance_.residual()), probe.basis.cols()); }

  bool is_seen_to_turn(const std::string& body) const {
    const std::vector<Channel>& channels = problem_.runs()[run_].channels;
    return std::any_of(channels.begin(), channels.end(), [&](const Channel& c) { return c.body == body && c.observable == "orientation"; });
  }

  void test_pieces(const History& history, const std::string& body) {
    std::vector<std::size_t> alike;  // entries of the phase that lasts, but for impacts
    for (const Segment& segment : segments_of(history, body, problem_.runs()[run_].horizon, 8)) {
      Located entry;
      entry.run = run_;
      entry.segment = segment;
      entry.mass = history.mass.at(body);
      const Eigen::MatrixXd columns = response(segment, entry.mass * gravity_);
      entry.observable = most_moved(problem_.runs()[run_], columns.rowwise().sum());
      Probe probe = probe_of(columns);
      if (probe.basis.cols() == 0) {
        alike.clear();
        continue;
      }
      entry.deviate = deviate_of(probe);
      double alone = strength_of(probe);
      entry.strength = alone;
      probes_.push_back(std::move(probe));
      // A blow turns, too, and an inertia that is wrong shows in that. While a body flies or rolls the turn that a torque makes is too large for slopes.
      if (segment.phase == Phase::impact && is_seen_to_turn(body)) {
        Eigen::MatrixXd wrench(size_, 6);
        wrench << columns, response(segment, 0, entry.mass * gravity_ * history.radius.at(body));
        Probe with_torque = probe_of(wrench);
        if (with_torque.basis.cols() > 0) {
          entry.deviate = std::max(entry.deviate, deviate_of(with_torque));
          entry.strength = alone = std::max(alone, strength_of(with_torque));
          probes_.push_back(std::move(with_torque));
        }
      }
      responses_.conservativeResize(Eigen::NoChange, responses_.cols() + 3);
      responses_.rightCols(3) = columns;
      const std::size_t place = entries_.size();
      entries_.push_back(entry);
      if (segment.phase == Phase::impact) {
        windows_.push_back({place, place, segment.phase, alone, segment.to - segment.from});
        continue;
      }
      if (!alike.empty() && entries_[alike.back()].segment.phase != segment.phase) alike.clear();
      alike.push_back(place);
      if (alike.size() > most_together) alike.erase(alike.begin());
      test_together(alike);
    }
  }

  /// The last few of `alike`, down to the last alone, under one force, which stays as it is or is against the motion, as friction and drag are:
  /// responses add.
  void test_together(const std::vector<std::size_t>& alike) {
    Eigen::MatrixXd constant = Eigen::MatrixXd::Zero(size_, 3), friction = Eigen::MatrixXd::Zero(size_, 1), drag = friction;
    const Segment& last = entries_[alike.back()].segment;
    for (std::size_t n = alike.size(); n-- > 0;) {
      const Eigen::MatrixXd columns = response_of(alike[n]);
      const Segment& segment = entries_[alike[n]].segment;
      const Vec3 along = segment.velocity.normalized();
      constant += columns;
      friction -= columns * along;
      drag -= columns * segment.velocity.squaredNorm() * along;
      double most = strength_of(probe_of(constant));
      for (const Eigen::MatrixXd& against : {friction, drag}) most = std::max(most, strength_of(probe_of(against)));
      windows_.push_back({alike[n], alike.back(), segment.phase, most, last.to - segment.from});
    }
  }

  Eigen::MatrixXd response_of(std::size_t entry) const { return responses_.middleCols(static_cast<Eigen::Index>(3 * (entry - first_entry_)), 3); }

  /// What a contact does to one body in an impact it does to the other the other way round: a wrong law of contact shows in both.
  void test_contact_impulses(const History& history) {
    const auto touch = [&](const Segment& a, const Segment& b) {
      const Vec3 apart = sample(history, history.bodies.at(a.body), a.from).position - sample(history, history.bodies.at(b.body), a.from).position;
      return apart.norm() < near_enough * (history.radius.at(a.body) + history.radius.at(b.body));
    };
    for (std::size_t m = first_entry_; m < entries_.size(); ++m)
      for (std::size_t n = first_entry_; n < entries_.size(); ++n) {
        if (!hit_together(entries_[m].segment, entries_[n].segment) || !touch(entries_[m].segment, entries_[n].segment)) continue;
        const auto impulse = [&](std::size_t e) -> Eigen::MatrixXd {  // responses are those to the weight of the body for the time of the piece
          const Located& l = entries_[e];
          return response_of(e) / (l.mass * (l.segment.to - l.segment.from));
        };
        Probe probe = probe_of(impulse(m) - impulse(n));
        if (probe.basis.cols() == 0) continue;
        for (const std::size_t e : {m, n}) {
          entries_[e].deviate = std::max(entries_[e].deviate, deviate_of(probe));
          entries_[e].strength = std::max(entries_[e].strength, strength_of(probe));
          for (std::size_t w = first_window_; w < windows_.size(); ++w)
            if (windows_[w].first == e) windows_[w].strength = std::max(windows_[w].strength, strength_of(probe));
        }
        probes_.push_back(std::move(probe));
      }
  }

  /// All segments of the run together, so that none speaks for its neighbours; in units of the weight, a little stiff.
  void estimate_forces() {
    if (responses_.cols() == 0) return;
    const RunJacobian j = jacobian(problem_, fit_, run_);
    Eigen::MatrixXd a(size_, responses_.cols() + j.own.cols());
    a << responses_, j.own;
    for (Eigen::Index c = 0; c < responses_.cols(); ++c)
      if (a.col(c).norm() < visible) a.col(c).setZero();
    Eigen::VectorXd column_size = a.colwise().norm().transpose();
    for (double& size_of : column_size) size_of = size_of > 0 ? size_of : 1;
    const Eigen::MatrixXd scaled = a * column_size.cwiseInverse().asDiagonal();
    Eigen::MatrixXd normal = scaled.transpose() * scaled;
    normal.diagonal().array() += 1e-6;
    const Eigen::MatrixXd inverse = normal.inverse();
    const Eigen::VectorXd solution = column_size.cwiseInverse().asDiagonal() * (inverse * (scaled.transpose() * -*residual_));
    for (std::size_t e = first_entry_; e < entries_.size(); ++e)
      for (int k = 0; k < 3; ++k) {
        const auto c = static_cast<Eigen::Index>(3 * (e - first_entry_)) + k;
        const double weight = entries_[e].mass * gravity_;
        entries_[e].force[k] = weight * solution[c];
        entries_[e].force_se[k] = a.col(c).isZero(0) ? weight : weight * std::sqrt(inverse(c, c)) / column_size[c];
      }
  }

  const Problem& problem_;
  const Fit& fit_;
  const Nuisance& nuisance_;
  std::vector<Located> entries_;
  std::vector<Window> windows_;
  std::vector<Probe> probes_;
  // Of the run that is looked at: its place in the stacked residual, where its entries and windows begin, and three columns of responses for each entry.
  std::size_t run_ = 0, first_entry_ = 0, first_window_ = 0;
  const Eigen::VectorXd* residual_ = nullptr;
  Eigen::Index first_ = 0, size_ = 0;
  double gravity_ = 9.81;
  Eigen::MatrixXd responses_;
};

}  // namespace

Places locate(const Problem& problem, const Fit& nominal, const Nuisance& nuisance, std::size_t max_runs, int replicas, std::uint64_t seed) {
  Locating locating(problem, nominal, nuisance);
  for (std::size_t i = 0; i < std::min(nominal.runs.size(), max_runs); ++i) locating.look_at(i);
  return locating.places(replicas, seed);
}

}  // namespace repose::diagnosis
