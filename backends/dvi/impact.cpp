#include "backends/dvi/impact.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

constexpr int activation_rounds = 4;
constexpr int energy_rounds = 9;  // of which seven halve, one sets to zero, and one looks

struct Bounce {
  bool may = false;      ///< rule 1
  bool active = false;   ///< its bias is that of restitution
  double share = 1;      ///< of the restitution that rule 4 has left
};

void merge(SolveReport& total, const SolveReport& again) {
  total.iterations += again.iterations;
  total.residual = again.residual;
  total.converged = again.converged;
  total.cycling = total.cycling || again.cycling;
  total.bytes = std::max(total.bytes, again.bytes);
}

}  // namespace

Impulse relative_velocity(const ConeContact& c, std::span<const Vec3> velocity, std::span<const Vec3> angular_velocity) {
  const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
  const Vec3 d = velocity[b] + angular_velocity[b].cross(c.arm_b) - velocity[a] - angular_velocity[a].cross(c.arm_a);
  const Vec3 w = c.arm * (angular_velocity[b] - angular_velocity[a]);
  Vec3 t1, t2;
  contact_frame(c, t1, t2);
  return {c.normal.dot(d), t1.dot(d), t2.dot(d), t1.dot(w), t2.dot(w), c.normal.dot(w)};
}

bool is_impact(const ImpactData& contact, double free) { return contact.before < 0 && -contact.before > 2 * std::abs(free - contact.before); }

SolveReport solve_with_impacts(ConeProblem& problem, std::span<const ImpactData> data, double step, double tolerance,
                               const ConeSolver& solver, std::span<Impulse> impulse, std::vector<Vec3>& velocity,
                               std::vector<Vec3>& angular_velocity, int threads) {
  const std::size_t n = problem.contacts.size();
  std::vector<Bounce> bounce(n);
  std::atomic<bool> any_may = false;
  for_each_index(threads, n, [&](std::size_t i) {
    ConeContact& c = problem.contacts[i];
    const ImpactData& d = data[i];
    if (c.compliance == 0) c.bias = std::max(d.gap, 0.0) / step;
    if (!(d.restitution > 0) || !(d.before < 0)) return;
    const double free = relative_velocity(c, problem.velocity, problem.angular_velocity)[0];
    bounce[i].may = is_impact(d, free);
    if (bounce[i].may) any_may.store(true, std::memory_order_relaxed);
    if (bounce[i].may && d.gap + step * free <= 0) {
      bounce[i].active = true;
      c.bias = d.restitution * d.before;
      c.compliance = 0;
    }
  });
  SolveReport report = solver(problem, impulse, velocity, angular_velocity);
  if (!any_may) return report;

  for (int round = 0; round < activation_rounds; ++round) {
    bool changed = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (!bounce[i].may || bounce[i].active || !(impulse[i][0] > 0)) continue;
      bounce[i].active = true;
      problem.contacts[i].bias = data[i].restitution * data[i].before;
      problem.contacts[i].compliance = 0;
      changed = true;
    }
    if (!changed) break;
    merge(report, solver(problem, impulse, velocity, angular_velocity));
  }

  for (int round = 0; round < energy_rounds; ++round) {
    bool changed = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (!bounce[i].active || bounce[i].share == 0 || !(impulse[i][0] > 0)) continue;
      const Impulse free = relative_velocity(problem.contacts[i], problem.velocity, problem.angular_velocity);
      const Impulse after = relative_velocity(problem.contacts[i], velocity, angular_velocity);
      double work = 0;
      for (std::size_t k = 0; k < 6; ++k) work += 0.5 * impulse[i][k] * (free[k] + after[k]);
      // The solver's tolerance is allowed for: e = 1 without friction does no work at all, up to it.
      if (work <= tolerance * impulse[i][0] * -data[i].before) continue;
      bounce[i].share = round + 1 < energy_rounds - 1 ? 0.5 * bounce[i].share : 0.0;
      problem.contacts[i].bias = bounce[i].share * data[i].restitution * data[i].before;
      changed = true;
    }
    if (!changed) break;
    merge(report, solver(problem, impulse, velocity, angular_velocity));
  }
  return report;
}

}  // namespace repose::dvi
