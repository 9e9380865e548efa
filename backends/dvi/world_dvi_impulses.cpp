#include "backends/dvi/world_dvi_impulses.hpp"

#include <algorithm>
#include <atomic>

#include "backends/dvi/resize.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

constexpr double longest_ratio = 10;  // of steps

}  // namespace

void LastImpulses::keep(std::span<const FoundContact> found, const ConeProblem& problem, std::span<const Impulse> impulse, double step,
                        int threads) {
  step_ = step;
  resize_sparingly(kept_, found.size());
  for_each_index(threads, found.size(), [&](std::size_t i) {
    const ConeContact& c = problem.contacts[i];
    const Impulse& g = impulse[i];
    Vec3 t1, t2;
    contact_frame(c, t1, t2);
    kept_[i] = {found[i].id, g[0] * c.normal + g[1] * t1 + g[2] * t2, c.arm * (g[3] * t1 + g[4] * t2 + g[5] * c.normal), found[i].point};
  });
  link(threads);
}

std::size_t LastImpulses::bearer(const ContactId& id) const {
  const auto a = static_cast<std::size_t>(id.a()), b = static_cast<std::size_t>(id.b());
  if (!bodies_.dynamic[a] || !bodies_.dynamic[b]) return bodies_.dynamic[b] ? b : a;
  return bodies_.bound[a] < bodies_.bound[b] ? a : b;
}

void LastImpulses::link(int threads) {
  first_.assign(bodies_.count(), -1);
  resize_sparingly(next_, kept_.size());
  // The order within a chain is chance, and nothing comes of it: contacts are looked up by a name that none shares.
  for_each_index(threads, kept_.size(), [&](std::size_t k) {
    next_[k] = std::atomic_ref(first_[bearer(kept_[k].id)]).exchange(static_cast<std::int32_t>(k), std::memory_order_relaxed);
  });
}

void LastImpulses::start(std::span<const FoundContact> found, const ConeProblem& problem, double step, int threads,
                         std::vector<Impulse>& impulse) const {
  resize_sparingly(impulse, found.size());
  const bool tells = !kept_.empty() && step <= longest_ratio * step_;
  const double ratio = tells ? step / step_ : 0;
  for_each_index(threads, found.size(), [&](std::size_t i) {
    impulse[i] = {};
    if (!tells) return;
    for (std::int32_t at = first_[bearer(found[i].id)]; at >= 0; at = next_[static_cast<std::size_t>(at)]) {
      const auto k = static_cast<std::size_t>(at);
      if (!(kept_[k].id == found[i].id)) continue;
      const ConeContact& c = problem.contacts[i];
      Vec3 t1, t2;
      contact_frame(c, t1, t2);
      const Vec3 force = ratio * kept_[k].force;
      const Vec3 couple = ratio / c.arm * kept_[k].couple;
      impulse[i] = {std::max(c.normal.dot(force), -c.cohesion), t1.dot(force), t2.dot(force), t1.dot(couple), t2.dot(couple), c.normal.dot(couple)};
      break;
    }
  });
}

Contact LastImpulses::told(const Kept& kept, const Units& units) const {
  Contact contact;
  contact.a = kept.id.a();
  contact.b = kept.id.b();
  contact.point = kept.point.point * units.length;
  contact.normal = kept.point.normal;
  contact.gap = kept.point.gap * units.length;
  contact.force = kept.force * (units.force() / step_);
  contact.torque = kept.couple * (units.force() * units.length / step_);
  return contact;
}

void LastImpulses::read(std::vector<Contact>& contacts, const Units& units, int threads) const {
  resize_sparingly(contacts, kept_.size());
  for_each_index(threads, kept_.size(), [&](std::size_t i) { contacts[i] = told(kept_[i], units); });
}

void LastImpulses::read_at(std::span<const int> bodies, std::vector<Contact>& contacts, const Units& units, int threads) const {
  const auto listed = [&](std::int32_t body) { return std::binary_search(bodies.begin(), bodies.end(), body); };
  contacts.clear();
  for (const std::vector<Contact>& some : by_blocks(threads, kept_.size(), [&](std::size_t first, std::size_t last) {
         std::vector<Contact> found;
         for (std::size_t k = first; k < last; ++k)
           if (listed(kept_[k].id.a()) || listed(kept_[k].id.b())) found.push_back(told(kept_[k], units));
         return found;
       }))
    contacts.insert(contacts.end(), some.begin(), some.end());
}

void LastImpulses::save(Frame& frame, const Units& units) const {
  std::vector<double>& numbers = frame.numbers["contact_impulses"];
  std::vector<std::int64_t>& ids = frame.integers["contact_ids"];
  numbers.clear();
  ids.clear();
  numbers.reserve(6 * kept_.size());
  ids.reserve(2 * kept_.size());
  for (const Kept& kept : kept_) {
    for (int k = 0; k < 3; ++k) numbers.push_back(kept.force[k] * units.impulse());
    for (int k = 0; k < 3; ++k) numbers.push_back(kept.couple[k] * units.impulse() * units.length);
    ids.push_back(static_cast<std::int64_t>(kept.id.bodies));
    ids.push_back(static_cast<std::int64_t>(kept.id.features));
  }
  frame.numbers["last_step"] = {step_ * units.time};
}

bool LastImpulses::restore(const Frame& frame, const Units& units) {
  const auto numbers = frame.numbers.find("contact_impulses");
  const auto ids = frame.integers.find("contact_ids");
  const auto last = frame.numbers.find("last_step");
  if (numbers == frame.numbers.end() || ids == frame.integers.end() || last == frame.numbers.end() || last->second.size() != 1 ||
      numbers->second.size() != 3 * ids->second.size() || ids->second.size() % 2 != 0)
    return false;
  const auto there = [&](std::int32_t body) { return body >= 0 && static_cast<std::size_t>(body) < bodies_.count(); };
  for (std::size_t i = 0; i < ids->second.size(); i += 2) {
    const ContactId id{static_cast<std::uint64_t>(ids->second[i]), 0};
    if (!there(id.a()) || !there(id.b())) return false;
  }
  kept_.clear();
  for (std::size_t i = 0; i < ids->second.size() / 2; ++i) {
    Kept kept;
    kept.id = {static_cast<std::uint64_t>(ids->second[2 * i]), static_cast<std::uint64_t>(ids->second[2 * i + 1])};
    for (std::size_t k = 0; k < 3; ++k) {
      kept.force[static_cast<Eigen::Index>(k)] = numbers->second[6 * i + k] / units.impulse();
      kept.couple[static_cast<Eigen::Index>(k)] = numbers->second[6 * i + 3 + k] / (units.impulse() * units.length);
    }
    kept_.push_back(kept);
  }
  step_ = last->second[0] / units.time;
  link(1);
  return true;
}

}  // namespace repose::dvi
