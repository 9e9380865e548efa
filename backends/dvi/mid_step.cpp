#include "backends/dvi/mid_step.hpp"

#include <algorithm>
#include <cmath>

namespace repose::dvi {
namespace {

constexpr double stuck = 1e-5;        // velocity, in the world's units: a row that is slower does not slide
constexpr double smooth = 1e-4;       // of R*: a normal velocity that moves a contact by less in a step is none
constexpr double slides_on = 2;       // times what a step can change
constexpr double response_share = 4;  // of the tangential to the normal response to an impulse, at most: 3.5 for a ball
constexpr double kept = 0.25;         // of the slip before, along itself, that must be left

double size(const Impulse& u, std::size_t row) { return std::hypot(u[row], u[row + 1]); }

enum class Slide { none, on, changes };

/// Of a pair of rows against the friction `mu`; `pressed`: the normal velocity that the contact takes away.
Slide slide_of(const Impulse& before, const Impulse& free, std::size_t row, double mu, double pressed) {
  const double speed = size(before, row);
  if (mu == 0 || speed <= stuck) return Slide::none;
  const double change = std::hypot(free[row] - before[row], free[row + 1] - before[row + 1]) + response_share * mu * pressed;
  return speed > slides_on * change ? Slide::on : Slide::changes;
}

/// One step of solve_at_mid_step.
class MidStep {
 public:
  MidStep(ConeProblem& problem, std::span<ImpactData> impact, const VelocitiesBefore& before, double step)
      : problem_(problem), impact_(impact), before_(before), step_(step), added_(problem.inverse_mass.size(), 0) {
    for (const ConeContact& c : problem_.contacts) rows_before_.push_back(relative_velocity(c, before_.linear, before_.angular));
    choose();
  }

  bool any() const { return std::find(added_.begin(), added_.end(), 1) != added_.end(); }

  void add() {
    std::vector<Vec3> linear(added_.size(), Vec3::Zero()), angular = linear;
    for (std::size_t i = 0; i < added_.size(); ++i) {
      if (added_[i] == 0) continue;
      problem_.velocity[i] += linear[i] = before_.linear[i];
      problem_.angular_velocity[i] += angular[i] = before_.angular[i];
    }
    for (std::size_t i = 0; i < problem_.contacts.size(); ++i) impact_[i].gap = std::max(impact_[i].gap, 0.0) - step_ * relative_velocity(problem_.contacts[i], linear, angular)[0];
    problem_.slip_law.speed *= 2;
  }

  void take_away_from(std::vector<Vec3>& velocity, std::vector<Vec3>& angular_velocity) const {
    for (std::size_t i = 0; i < added_.size(); ++i) {
      if (added_[i] == 0) continue;
      velocity[i] -= before_.linear[i];
      angular_velocity[i] -= before_.angular[i];
    }
  }

  /// Does everything that was taken to slide or roll on do so after the step?
  bool confirmed(std::span<const Impulse> impulse, const std::vector<Vec3>& velocity, const std::vector<Vec3>& angular_velocity) const {
    for (std::size_t i = 0; i < problem_.contacts.size(); ++i) {
      const ConeContact& c = problem_.contacts[i];
      if (!(impulse[i][0] > 0) || (added_[index(c.a)] == 0 && added_[index(c.b)] == 0)) continue;
      const Impulse after = relative_velocity(c, velocity, angular_velocity);
      const Impulse& u = rows_before_[i];
      for (const std::size_t row : {std::size_t{1}, std::size_t{3}}) {
        const double speed = size(u, row);
        if ((row == 1 ? c.friction : c.rolling) == 0 || speed <= stuck) continue;
        if (u[row] * after[row] + u[row + 1] * after[row + 1] < kept * speed * speed) return false;
      }
      if (c.spinning > 0 && std::abs(u[5]) > stuck && u[5] * after[5] < kept * u[5] * u[5]) return false;
    }
    return true;
  }

 private:
  static std::size_t index(std::int32_t body) { return static_cast<std::size_t>(body); }
  bool moves(std::size_t body) const { return !before_.linear[body].isZero(0) || !before_.angular[body].isZero(0); }

  void choose() {
    std::vector<char> gains(added_.size(), 0), fails(added_.size(), 0);
    std::vector<std::size_t> closing;
    for (std::size_t i = 0; i < problem_.contacts.size(); ++i) {
      const ConeContact& c = problem_.contacts[i];
      const Impulse free = relative_velocity(c, problem_.velocity, problem_.angular_velocity);
      const Impulse& u = rows_before_[i];
      const double pressed = std::max(0.0, -free[0] - std::max(0.0, impact_[i].gap) / step_);
      if (pressed == 0 && c.cohesion == 0) continue;  // it carries no impulse
      closing.push_back(i);
      const Slide slides = slide_of(u, free, 1, c.friction, pressed), rolls = slide_of(u, free, 3, c.rolling, pressed);
      const bool spin_changes = c.spinning > 0 && std::abs(u[5]) > stuck &&
                                std::abs(u[5]) <= slides_on * (std::abs(free[5] - u[5]) + response_share * c.spinning * pressed);
      // A blow has so short a step that it moves nothing; with the velocity before it added it would not be told from a contact that lies.
      const bool smoothly =
          step_ * std::abs(u[0]) <= smooth * c.arm && !is_impact(impact_[i], free[0]) && c.cohesion == 0 && c.compliance == 0;
      const bool on = slides == Slide::on || rolls == Slide::on;
      for (const std::int32_t body : {c.a, c.b}) {
        gains[index(body)] |= on;
        fails[index(body)] |= !smoothly || slides == Slide::changes || rolls == Slide::changes || spin_changes;
      }
    }
    for (std::size_t i = 0; i < added_.size(); ++i) added_[i] = gains[i] != 0 && fails[i] == 0 && moves(i);
    // What touches a body that moves and is left as it is, is left as it is.
    for (bool changed = true; changed;) {
      changed = false;
      for (const std::size_t i : closing) {
        const std::size_t a = index(problem_.contacts[i].a), b = index(problem_.contacts[i].b);
        if (added_[a] == added_[b] || !moves(a) || !moves(b)) continue;
        added_[a] = added_[b] = 0;
        changed = true;
      }
    }
    // One law of slip for all contacts: it is asked at twice the mean slip, or nowhere.
    if (problem_.slip_law.slope != 0)
      for (const std::size_t i : closing)
        if (added_[index(problem_.contacts[i].a)] == 0 && added_[index(problem_.contacts[i].b)] == 0) std::fill(added_.begin(), added_.end(), 0);
  }

  ConeProblem& problem_;
  std::span<ImpactData> impact_;
  const VelocitiesBefore& before_;
  double step_;
  std::vector<char> added_;           // by body: are its velocities before the step added?
  std::vector<Impulse> rows_before_;  // by contact
};

}  // namespace

SolveReport solve_at_mid_step(ConeProblem& problem, std::span<ImpactData> impact, const VelocitiesBefore& before, double step,
                              const std::function<SolveReport()>& solve, std::span<const Impulse> impulse, std::vector<Vec3>& velocity,
                              std::vector<Vec3>& angular_velocity) {
  MidStep mid(problem, impact, before, step);
  if (!mid.any()) return solve();
  const std::vector<ImpactData> kept_impact(impact.begin(), impact.end());
  const std::vector<Vec3> kept_velocity = problem.velocity, kept_angular = problem.angular_velocity;
  const double kept_speed = problem.slip_law.speed;
  mid.add();
  SolveReport report = solve();
  problem.slip_law.speed = kept_speed;
  std::copy(kept_impact.begin(), kept_impact.end(), impact.begin());
  problem.velocity = kept_velocity;
  problem.angular_velocity = kept_angular;
  mid.take_away_from(velocity, angular_velocity);
  if (mid.confirmed(impulse, velocity, angular_velocity)) return report;
  const int spent = report.iterations;
  report = solve();
  report.iterations += spent;
  return report;
}

}  // namespace repose::dvi
