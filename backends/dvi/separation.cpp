#include "backends/dvi/separation.hpp"

#include <algorithm>

namespace repose::dvi {

namespace {

constexpr int max_sweeps = 60;

Vec3 multiply(const std::array<double, 6>& m, const Vec3& x) {
  return {m[0] * x.x() + m[1] * x.y() + m[2] * x.z(), m[1] * x.x() + m[3] * x.y() + m[4] * x.z(),
          m[2] * x.x() + m[4] * x.y() + m[5] * x.z()};
}

}  // namespace

int push_apart(const ConeProblem& problem, std::span<const double> gap, double slop, std::vector<Displacement>& out) {
  out.assign(problem.velocity.size(), {});
  const std::size_t n = problem.contacts.size();
  const auto deep = [&](std::size_t i) { return gap[i] < -slop * problem.contacts[i].arm; };
  bool any = false;
  for (std::size_t i = 0; i < n && !any; ++i) any = deep(i);
  if (!any) return 0;

  std::vector<double> multiplier(n, 0.0);
  // Only contacts that are deep, or whose bodies have been moved, can change anything.
  std::vector<char> moved(problem.velocity.size(), 0);
  const auto dynamic = [&](std::int32_t body) { return body < problem.dynamic_bodies; };
  int sweep = 0;
  for (bool settled = false; !settled && sweep < max_sweeps; ++sweep) {
    settled = true;
    for (std::size_t i = 0; i < n; ++i) {
      const ConeContact& c = problem.contacts[i];
      const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
      if (!moved[a] && !moved[b] && !deep(i)) continue;
      const double target = -0.5 * slop * c.arm;
      const Vec3 turn_a = c.arm_a.cross(c.normal), turn_b = c.arm_b.cross(c.normal);
      const double now = gap[i] + c.normal.dot(out[b].shift - out[a].shift) + turn_b.dot(out[b].turn) -
                         turn_a.dot(out[a].turn);
      const Vec3 response_a = multiply(problem.inverse_mass[a].inertia, turn_a);
      const Vec3 response_b = multiply(problem.inverse_mass[b].inertia, turn_b);
      const double w = problem.inverse_mass[a].mass + problem.inverse_mass[b].mass + turn_a.dot(response_a) +
                       turn_b.dot(response_b);
      if (!(w > 0)) continue;
      // Gaps that stand between target and zero are no reason to push; gaps that were deep go to the target.
      const double goal = std::min(target, deep(i) ? target : gap[i]);
      const double before = multiplier[i];
      multiplier[i] = std::max(0.0, before + (goal - now) / w);
      const double d = multiplier[i] - before;
      if (d == 0) continue;
      if (now < -slop * c.arm) settled = false;
      if (dynamic(c.a)) {
        out[a].shift -= problem.inverse_mass[a].mass * d * c.normal;
        out[a].turn -= d * response_a;
        moved[a] = 1;
      }
      if (dynamic(c.b)) {
        out[b].shift += problem.inverse_mass[b].mass * d * c.normal;
        out[b].turn += d * response_b;
        moved[b] = 1;
      }
    }
  }
  return sweep;
}

}  // namespace repose::dvi
