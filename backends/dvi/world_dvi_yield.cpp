#include "backends/dvi/world_dvi_yield.hpp"

#include <algorithm>

namespace repose::dvi {

namespace {

constexpr double standing = 1e-9;  // units of length above the stops: rounding of the time at which they are looked for

}  // namespace

YieldingBodies::YieldingBodies(const Model& model, const Units& units) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (const auto& yield = model.bodies[i].yield)
      bodies_.push_back({static_cast<std::int32_t>(i), yield->load / units.force(), yield->mass / units.mass});
}

std::size_t YieldingBodies::index_of(std::size_t body) const {
  const auto at = std::lower_bound(bodies_.begin(), bodies_.end(), static_cast<std::int32_t>(body),
                                   [](const One& one, std::int32_t wanted) { return one.body < wanted; });
  return static_cast<std::size_t>(at - bodies_.begin());
}

bool YieldingBodies::is_released(std::size_t body) const {
  return std::binary_search(released_.begin(), released_.end(), static_cast<std::int32_t>(body));
}

void YieldingBodies::place(std::size_t body, double height, double rise, Vec3& position, Vec3& velocity) {
  One& one = bodies_[index_of(body)];
  one.gap = std::max(0.0, height - position.z());
  one.rise = one.gap > standing ? rise : std::max(rise, velocity.z());
  one.stop = velocity;
  if (one.gap <= standing && one.rise <= velocity.z()) return;
  released_.push_back(one.body);
  position.z() += one.gap;
  velocity.z() = one.rise;
}

double YieldingBodies::free_rise(std::size_t body, double h) const {
  const One& one = bodies_[index_of(body)];
  return std::max(one.rise - h * one.load / one.mass, one.stop.z() - one.gap / h);
}

void YieldingBodies::add_stops(std::span<const std::int32_t> slot_of, double h, ConeProblem& problem, std::vector<ImpactData>& impact,
                               std::vector<Impulse>& impulse) const {
  for (const std::int32_t body : released_) {
    const One& one = bodies_[index_of(static_cast<std::size_t>(body))];
    ConeContact stop;
    stop.a = static_cast<std::int32_t>(problem.velocity.size());
    stop.b = slot_of[static_cast<std::size_t>(body)];
    const auto b = static_cast<std::size_t>(stop.b);
    problem.inverse_mass[b].lift = 1 / one.mass;
    problem.velocity[b].z() = one.rise - h * one.load / one.mass;
    problem.inverse_mass.push_back({});
    problem.velocity.push_back(one.stop);
    problem.angular_velocity.push_back(problem.angular_velocity[b]);
    problem.contacts.push_back(stop);
    if (problem.slip_law.slope > 0) problem.slip_law.friction.push_back(0);
    impact.push_back({one.gap, 0, one.rise - one.stop.z()});
    impulse.push_back({});
  }
}

bool YieldingBodies::release_overloaded(std::span<const FoundContact> found, const ConeProblem& problem,
                                        std::span<const Impulse> impulse, double h) {
  std::vector<double> push(bodies_.size(), 0);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const bool is_b = found[i].id.b() == bodies_[k].body;
      if (!is_b && found[i].id.a() != bodies_[k].body) continue;
      Vec3 t1, t2;
      contact_frame(problem.contacts[i], t1, t2);
      const double up = impulse[i][0] * problem.contacts[i].normal.z() + impulse[i][1] * t1.z() + impulse[i][2] * t2.z();
      push[k] += is_b ? up : -up;
    }
  const std::size_t before = released_.size();
  for (std::size_t k = 0; k < bodies_.size(); ++k)
    if (push[k] > h * bodies_[k].load && !is_released(static_cast<std::size_t>(bodies_[k].body))) {
      const auto at = std::lower_bound(released_.begin(), released_.end(), bodies_[k].body);
      released_.insert(at, bodies_[k].body);
    }
  return released_.size() > before;
}

void YieldingBodies::stand_on_stops(std::size_t body, double stop, Vec3& position, Vec3& velocity) const {
  if (position.z() > stop) return;
  position.z() = stop;
  velocity.z() = std::max(velocity.z(), bodies_[index_of(body)].stop.z());
}

}  // namespace repose::dvi
