#include "backends/dvi/world_dvi_impulses.hpp"

#include <algorithm>
#include <unordered_map>

namespace repose::dvi {

namespace {

constexpr double longest_ratio = 10;  // of steps

}  // namespace

void LastImpulses::keep(std::span<const FoundContact> found, const ConeProblem& problem, std::span<const Impulse> impulse, double step) {
  step_ = step;
  kept_.resize(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const ConeContact& c = problem.contacts[i];
    const Impulse& g = impulse[i];
    Vec3 t1, t2;
    contact_frame(c, t1, t2);
    kept_[i] = {found[i].id, g[0] * c.normal + g[1] * t1 + g[2] * t2, c.arm * (g[3] * t1 + g[4] * t2 + g[5] * c.normal), found[i].point};
  }
}

void LastImpulses::start(std::span<const FoundContact> found, const ConeProblem& problem, double step, std::vector<Impulse>& impulse) const {
  impulse.assign(found.size(), Impulse{});
  if (kept_.empty() || step > longest_ratio * step_) return;
  std::unordered_map<std::uint64_t, std::size_t> first;
  first.reserve(kept_.size());
  for (std::size_t i = 0; i < kept_.size(); ++i) first.try_emplace(kept_[i].id.bodies, i);
  const double ratio = step / step_;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto at = first.find(found[i].id.bodies);
    if (at == first.end()) continue;
    // The contacts of one pair stand together.
    for (std::size_t k = at->second; k < kept_.size() && kept_[k].id.bodies == found[i].id.bodies; ++k) {
      if (kept_[k].id.features != found[i].id.features) continue;
      const ConeContact& c = problem.contacts[i];
      Vec3 t1, t2;
      contact_frame(c, t1, t2);
      const Vec3 force = ratio * kept_[k].force;
      const Vec3 couple = ratio / c.arm * kept_[k].couple;
      impulse[i] = {std::max(c.normal.dot(force), -c.cohesion), t1.dot(force), t2.dot(force), t1.dot(couple), t2.dot(couple), c.normal.dot(couple)};
      break;
    }
  }
}

void LastImpulses::read(std::vector<Contact>& contacts, const Units& units) const {
  contacts.clear();
  for (const Kept& kept : kept_) {
    Contact contact;
    contact.a = kept.id.a();
    contact.b = kept.id.b();
    contact.point = kept.point.point * units.length;
    contact.normal = kept.point.normal;
    contact.gap = kept.point.gap * units.length;
    contact.force = kept.force * (units.force() / step_);
    contact.torque = kept.couple * (units.force() * units.length / step_);
    contacts.push_back(contact);
  }
}

void LastImpulses::save(Frame& frame, const Units& units) const {
  std::vector<double>& numbers = frame.numbers["contact_impulses"];
  std::vector<std::int64_t>& ids = frame.integers["contact_ids"];
  numbers.clear();
  ids.clear();
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
  return true;
}

}  // namespace repose::dvi
