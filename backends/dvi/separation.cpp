#include "backends/dvi/separation.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace repose::dvi {

namespace {

constexpr int max_sweeps = 60;
constexpr double unnoticed = 0.1;  // of the slop: how far a body moves before its contacts are looked at again

Vec3 multiply(const std::array<double, 6>& m, const Vec3& x) {
  return {m[0] * x.x() + m[1] * x.y() + m[2] * x.z(), m[1] * x.x() + m[3] * x.y() + m[4] * x.z(),
          m[2] * x.x() + m[4] * x.y() + m[5] * x.z()};
}

/// The contacts that are to be visited, in their order. One that is added behind the place of the sweep waits for the next.
class ToVisit {
 public:
  explicit ToVisit(std::size_t contacts) : word_((contacts + 63) / 64, 0) {}

  void add(std::size_t contact) {
    std::uint64_t& word = word_[contact / 64];
    const std::uint64_t bit = std::uint64_t{1} << contact % 64;
    waiting_ += (word & bit) == 0;
    word |= bit;
  }
  bool any() const { return waiting_ > 0; }

  /// Once through those that wait; what is visited is taken out before.
  template <class Visit>
  void sweep(Visit&& visit) {
    for (std::size_t w = 0; w < word_.size(); ++w) {
      std::uint64_t ahead = ~std::uint64_t{0};
      while (const std::uint64_t left = word_[w] & ahead) {
        const int bit = std::countr_zero(left);
        ahead = bit == 63 ? 0 : ~std::uint64_t{0} << (bit + 1);
        word_[w] &= ~(std::uint64_t{1} << bit);
        --waiting_;
        visit(64 * w + static_cast<std::size_t>(bit));
      }
    }
  }

 private:
  std::vector<std::uint64_t> word_;
  std::size_t waiting_ = 0;
};

/// The contacts of each body, in chains.
class ContactsOfBodies {
 public:
  explicit ContactsOfBodies(const ConeProblem& problem) : first_(problem.velocity.size(), none), next_(2 * problem.contacts.size()) {
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      add(problem.contacts[i].a, 2 * i);
      add(problem.contacts[i].b, 2 * i + 1);
    }
  }

  template <class Visit>
  void each_of(std::size_t body, Visit&& visit) const {
    for (std::uint32_t end = first_[body]; end != none; end = next_[end]) visit(end / 2);
  }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  void add(std::int32_t body, std::size_t end) {
    std::uint32_t& first = first_[static_cast<std::size_t>(body)];
    next_[end] = first;
    first = static_cast<std::uint32_t>(end);
  }

  std::vector<std::uint32_t> first_;  ///< by body: an end of a contact; contact i has the ends 2 i and 2 i + 1
  std::vector<std::uint32_t> next_;   ///< by end: the next one at the same body
};

}  // namespace

int push_apart(const ConeProblem& problem, std::span<const double> gap, double slop, std::vector<Displacement>& out) {
  out.assign(problem.velocity.size(), {});
  const std::size_t n = problem.contacts.size();
  const auto deep = [&](std::size_t i) { return gap[i] < -slop * problem.contacts[i].arm; };
  // Only contacts that are deep, or whose bodies have moved since they were looked at, can change anything.
  ToVisit to_visit(n);
  for (std::size_t i = 0; i < n; ++i)
    if (deep(i)) to_visit.add(i);
  if (!to_visit.any()) return 0;

  const ContactsOfBodies contacts(problem);
  std::vector<double> multiplier(n, 0.0);
  std::vector<double> moved(problem.velocity.size(), 0.0);  // since its contacts were told
  const auto move = [&](std::size_t body, const Vec3& shift, const Vec3& turn, const ConeContact& by, const Vec3& arm) {
    if (!(problem.inverse_mass[body].mass > 0)) return;
    out[body].shift += shift;
    out[body].turn += turn;
    moved[body] += shift.norm() + turn.norm() * arm.norm();
    if (moved[body] <= unnoticed * slop * by.arm) return;
    moved[body] = 0;
    contacts.each_of(body, [&](std::size_t i) { to_visit.add(i); });
  };
  int sweep = 0;
  for (; to_visit.any() && sweep < max_sweeps; ++sweep) {
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
      move(a, -problem.inverse_mass[a].mass * d * c.normal, -d * response_a, c, c.arm_a);
      move(b, problem.inverse_mass[b].mass * d * c.normal, d * response_b, c, c.arm_b);
    });
  }
  return sweep;
}

}  // namespace repose::dvi
