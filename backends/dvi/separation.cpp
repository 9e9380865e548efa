#include "backends/dvi/separation.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace repose::dvi {

namespace {

constexpr int max_sweeps = 60;

Vec3 multiply(const std::array<double, 6>& m, const Vec3& x) {
  return {m[0] * x.x() + m[1] * x.y() + m[2] * x.z(), m[1] * x.x() + m[3] * x.y() + m[4] * x.z(),
          m[2] * x.x() + m[4] * x.y() + m[5] * x.z()};
}

/// The contacts that a sweep has to visit, in their order. One that is added behind the place of the sweep waits for the next.
class ToVisit {
 public:
  explicit ToVisit(std::size_t contacts) : word_((contacts + 63) / 64, 0) {}

  void add(std::size_t contact) { word_[contact / 64] |= std::uint64_t{1} << contact % 64; }

  template <class Visit>
  void sweep(Visit&& visit) const {
    for (std::size_t w = 0; w < word_.size(); ++w) {
      std::uint64_t ahead = ~std::uint64_t{0};
      while (const std::uint64_t left = word_[w] & ahead) {
        const int bit = std::countr_zero(left);
        ahead = bit == 63 ? 0 : ~std::uint64_t{0} << (bit + 1);
        visit(64 * w + static_cast<std::size_t>(bit));
      }
    }
  }

 private:
  std::vector<std::uint64_t> word_;
};

/// The contacts of each body that can be moved.
class ContactsOfBodies {
 public:
  explicit ContactsOfBodies(const ConeProblem& problem) : end_(problem.velocity.size() + 1, 0) {
    const auto each = [&](auto&& visit) {
      for (std::size_t i = 0; i < problem.contacts.size(); ++i)
        for (const std::int32_t body : {problem.contacts[i].a, problem.contacts[i].b})
          if (problem.inverse_mass[static_cast<std::size_t>(body)].mass > 0) visit(static_cast<std::size_t>(body), i);
    };
    each([&](std::size_t body, std::size_t) { ++end_[body + 1]; });
    for (std::size_t body = 1; body < end_.size(); ++body) end_[body] += end_[body - 1];
    contact_.resize(end_.back());
    std::vector<std::uint32_t> next(end_.begin(), end_.end() - 1);
    each([&](std::size_t body, std::size_t i) { contact_[next[body]++] = static_cast<std::uint32_t>(i); });
  }

  std::span<const std::uint32_t> of(std::size_t body) const { return std::span(contact_).subspan(end_[body], end_[body + 1] - end_[body]); }

 private:
  std::vector<std::uint32_t> end_, contact_;
};

}  // namespace

int push_apart(const ConeProblem& problem, std::span<const double> gap, double slop, std::vector<Displacement>& out) {
  out.assign(problem.velocity.size(), {});
  const std::size_t n = problem.contacts.size();
  const auto deep = [&](std::size_t i) { return gap[i] < -slop * problem.contacts[i].arm; };
  // Only contacts that are deep, or whose bodies have been moved, can change anything.
  ToVisit to_visit(n);
  bool any = false;
  for (std::size_t i = 0; i < n; ++i) {
    if (!deep(i)) continue;
    to_visit.add(i);
    any = true;
  }
  if (!any) return 0;

  const ContactsOfBodies contacts(problem);
  std::vector<double> multiplier(n, 0.0);
  std::vector<char> moved(problem.velocity.size(), 0);
  const auto move = [&](std::size_t body, const Vec3& shift, const Vec3& turn) {
    if (!(problem.inverse_mass[body].mass > 0)) return;
    out[body].shift += shift;
    out[body].turn += turn;
    if (moved[body]) return;
    moved[body] = 1;
    for (const std::uint32_t i : contacts.of(body)) to_visit.add(i);
  };
  int sweep = 0;
  for (bool settled = false; !settled && sweep < max_sweeps; ++sweep) {
    settled = true;
    to_visit.sweep([&](std::size_t i) {
      const ConeContact& c = problem.contacts[i];
      const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
      const double target = -0.5 * slop * c.arm;
      const Vec3 turn_a = c.arm_a.cross(c.normal), turn_b = c.arm_b.cross(c.normal);
      const double now = gap[i] + c.normal.dot(out[b].shift - out[a].shift) + turn_b.dot(out[b].turn) -
                         turn_a.dot(out[a].turn);
      const Vec3 response_a = multiply(problem.inverse_mass[a].inertia, turn_a);
      const Vec3 response_b = multiply(problem.inverse_mass[b].inertia, turn_b);
      const double w = problem.inverse_mass[a].mass + problem.inverse_mass[b].mass + turn_a.dot(response_a) +
                       turn_b.dot(response_b);
      if (!(w > 0)) return;
      // Gaps that stand between target and zero are no reason to push; gaps that were deep go to the target.
      const double goal = std::min(target, deep(i) ? target : gap[i]);
      const double before = multiplier[i];
      multiplier[i] = std::max(0.0, before + (goal - now) / w);
      const double d = multiplier[i] - before;
      if (d == 0) return;
      if (now < -slop * c.arm) settled = false;
      move(a, -problem.inverse_mass[a].mass * d * c.normal, -d * response_a);
      move(b, problem.inverse_mass[b].mass * d * c.normal, d * response_b);
    });
  }
  return sweep;
}

}  // namespace repose::dvi
