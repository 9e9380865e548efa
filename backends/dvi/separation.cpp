#include "backends/dvi/separation.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>

#include "backends/dvi/contacts_by_block.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

constexpr int max_sweeps = 60;
constexpr double unnoticed = 0.1;  // of the slop: how far a body moves before its contacts are looked at again
constexpr int plain_sweeps = 3;     // pairs by themselves are done after one, exactly
constexpr double relaxation = 1.6;  // of later sweeps over many bodies: what they hand on from one to the next takes half as many

Vec3 multiply(const std::array<double, 6>& m, const Vec3& x) {
  return {m[0] * x.x() + m[1] * x.y() + m[2] * x.z(), m[1] * x.x() + m[3] * x.y() + m[4] * x.z(),
          m[2] * x.x() + m[4] * x.y() + m[5] * x.z()};
}

/// The places of contacts that are to be visited, in their order. One that is added behind the place of the sweep waits for the next.
class ToVisit {
 public:
  explicit ToVisit(std::size_t places) : word_((places + per_word - 1) / per_word, 0) {}

  static constexpr std::size_t per_word = 64;

  void add(std::size_t place) { word_[place / per_word] |= bit_of(place); }
  /// For places that several threads may add at once, while none visits them.
  void add_together(std::size_t place) { std::atomic_ref(word_[place / per_word]).fetch_or(bit_of(place), std::memory_order_relaxed); }
  bool any() const {
    return std::any_of(word_.begin(), word_.end(), [](std::uint64_t word) { return word != 0; });
  }

  /// Once through those that wait from `first`, at the start of a word, to before `last`, at one or at the end; what is visited is taken out before.
  template <class Visit>
  void sweep(std::size_t first, std::size_t last, Visit&& visit) {
    for (std::size_t w = first / per_word; w < (last + per_word - 1) / per_word; ++w) {
      std::uint64_t ahead = ~std::uint64_t{0};
      while (const std::uint64_t left = word_[w] & ahead) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(left));
        ahead = bit == per_word - 1 ? 0 : ~std::uint64_t{0} << (bit + 1);
        word_[w] &= ~(std::uint64_t{1} << bit);
        visit(per_word * w + bit);
      }
    }
  }

 private:
  static std::uint64_t bit_of(std::size_t place) { return std::uint64_t{1} << place % per_word; }

  std::vector<std::uint64_t> word_;
};

/// The places of the contacts of each body that can move, in chains.
class PlacesOfBodies {
 public:
  PlacesOfBodies(const ConeProblem& problem, const ContactsByBlock& places, int threads)
      : first_(static_cast<std::size_t>(problem.dynamic_bodies), none), next_(2 * places.size()) {
    const auto add_all = [&](std::size_t block) {
      for (std::size_t p = places.start[block]; p < places.start[block + 1]; ++p) {
        if (places.contact[p] == ContactsByBlock::none) continue;
        const ConeContact& c = problem.contacts[static_cast<std::size_t>(places.contact[p])];
        if (c.a < problem.dynamic_bodies) add(c.a, 2 * p);
        if (c.b < problem.dynamic_bodies) add(c.b, 2 * p + 1);
      }
    };
    for_each_index_as_it_comes(threads, places.blocks(), add_all);  // a block's chains are its own until here
    add_all(places.blocks());
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

  std::vector<std::uint32_t> first_;  ///< by body: an end of a contact; the one at place p has the ends 2 p and 2 p + 1
  std::vector<std::uint32_t> next_;   ///< by end: the next one at the same body
};

}  // namespace

int push_apart(const ConeProblem& problem, std::span<const double> gap, double slop, int threads, std::vector<Displacement>& out) {
  out.assign(problem.velocity.size(), {});
  const std::size_t n = problem.contacts.size();
  const auto deep = [&](std::size_t i) { return gap[i] < -slop * problem.contacts[i].arm; };
  bool any_deep = false;
  for (std::size_t i = 0; i < n && !any_deep; ++i) any_deep = deep(i);
  if (!any_deep) return 0;

  const ContactsByBlock places(problem, threads, ToVisit::per_word);  // blocks are swept side by side and must not share a word
  const PlacesOfBodies places_of(problem, places, threads);
  // Only contacts that are deep, or whose bodies have moved since they were looked at, can change anything.
  ToVisit to_visit(places.size());
  for_each_index_as_it_comes(threads, places.blocks() + 1, [&](std::size_t block) {
    for (std::size_t p = places.start[block]; p < places.start[block + 1]; ++p)
      if (places.contact[p] != ContactsByBlock::none && deep(static_cast<std::size_t>(places.contact[p]))) to_visit.add(p);
  });

  std::vector<double> multiplier(n, 0.0);
  std::vector<double> moved(static_cast<std::size_t>(problem.dynamic_bodies), 0.0);  // since its contacts were told
  bool side_by_side = false;                                                         // blocks are being swept
  const auto move = [&](std::size_t body, const Vec3& shift, const Vec3& turn, const ConeContact& by, const Vec3& arm) {
    if (static_cast<std::int32_t>(body) >= problem.dynamic_bodies || !(problem.inverse_mass[body].mass > 0)) return;
    out[body].shift += shift;
    out[body].turn += turn;
    moved[body] += shift.norm() + turn.norm() * arm.norm();
    if (moved[body] <= unnoticed * slop * by.arm) return;
    moved[body] = 0;
    places_of.each_of(body, [&](std::size_t place) {
      if (side_by_side && place >= places.first_between())
        to_visit.add_together(place);
      else
        to_visit.add(place);
    });
  };
  const auto visit = [&](std::size_t place, double factor) {
    const auto i = static_cast<std::size_t>(places.contact[place]);
    const ConeContact& c = problem.contacts[i];
    const auto a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
    const double target = -0.5 * slop * c.arm;
    const Vec3 turn_a = c.arm_a.cross(c.normal), turn_b = c.arm_b.cross(c.normal);
    const double now =
        gap[i] + c.normal.dot(out[b].shift - out[a].shift) + turn_b.dot(out[b].turn) - turn_a.dot(out[a].turn);
    const Vec3 response_a = multiply(problem.inverse_mass[a].inertia, turn_a);
    const Vec3 response_b = multiply(problem.inverse_mass[b].inertia, turn_b);
    const double w =
        problem.inverse_mass[a].mass + problem.inverse_mass[b].mass + turn_a.dot(response_a) + turn_b.dot(response_b);
    if (!(w > 0)) return;
    // Gaps that stand between target and zero are no reason to push; gaps that were deep go to the target.
    const double goal = std::min(target, deep(i) ? target : gap[i]);
    const double before = multiplier[i];
    multiplier[i] = std::max(0.0, before + factor * (goal - now) / w);
    const double d = multiplier[i] - before;
    if (d == 0) return;
    move(a, -problem.inverse_mass[a].mass * d * c.normal, -d * response_a, c, c.arm_a);
    move(b, problem.inverse_mass[b].mass * d * c.normal, d * response_b, c, c.arm_b);
  };
  int sweep = 0;
  for (; sweep < max_sweeps && to_visit.any(); ++sweep) {
    const double factor = sweep < plain_sweeps || places.blocks() == 0 ? 1.0 : relaxation;
    const auto visit_from = [&](std::size_t first, std::size_t last) {
      to_visit.sweep(first, last, [&](std::size_t place) { visit(place, factor); });
    };
    if (places.blocks() > 0) {
      side_by_side = true;
      for_each_index_as_it_comes(threads, places.blocks(), [&](std::size_t k) { visit_from(places.start[k], places.start[k + 1]); });
      side_by_side = false;
    }
    visit_from(places.first_between(), places.size());
  }
  return sweep;
}

}  // namespace repose::dvi
