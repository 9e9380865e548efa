#include "analysis/ledger.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace repose {

MeteredWorld::MeteredWorld(const Model& model, std::unique_ptr<World> inner) : model_(model), inner_(std::move(inner)) { open(); }

void MeteredWorld::restore(const Frame& frame) {
  inner_->restore(frame);
  open();
}

void MeteredWorld::open() {
  inner_->read(after_);
  ledger_ = {};
  sums_ = {};
  tools_ = {0, std::vector<Vec3>(model_.bodies.size(), Vec3::Zero())};
  sums_.start_kinetic = ledger_.kinetic = ledger_.turnover = kinetic_energy(after_);
  for (std::size_t i = 0; i < model_.bodies.size(); ++i)
    if (model_.bodies[i].dynamic) sums_.start_momentum += model_.bodies[i].mass * after_.velocity[i].norm();
}

StepReport MeteredWorld::step(double dt, const BodyLoads& loads) {
  std::swap(before_, after_);
  const StepReport report = inner_->step(dt, loads);
  inner_->read(after_);
  inner_->read(contacts_);
  const double stepped = dt - report.left;
  book_loads(stepped, loads);
  book_contacts(stepped);
  ledger_.kinetic = kinetic_energy(after_);
  ledger_.dissipated = sums_.work - (ledger_.kinetic - sums_.start_kinetic);
  sums_.most_dissipated = std::max(sums_.most_dissipated, ledger_.dissipated);
  sums_.largest_fall = std::max(sums_.largest_fall, sums_.most_dissipated - ledger_.dissipated);
  ledger_.energy_gain = ledger_.turnover > 0 ? sums_.largest_fall / ledger_.turnover : 0;
  sums_.largest_imbalance = std::max(sums_.largest_imbalance, sums_.imbalance.norm());
  const double scale = std::max(sums_.load_impulse, sums_.start_momentum);
  ledger_.momentum_error = scale > 0 ? sums_.largest_imbalance / scale : 0;
  tools_.time += stepped;
  return report;
}

MeteredWorld::ToolImpulses MeteredWorld::take_impulses() {
  ToolImpulses taken{0, std::vector<Vec3>(model_.bodies.size(), Vec3::Zero())};
  std::swap(taken, tools_);
  return taken;
}

double MeteredWorld::kinetic_energy(const Snapshot& state) const {
  double energy = 0;
  for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
    const Body& body = model_.bodies[i];
    if (!body.dynamic) continue;
    const Vec3 spin = state.orientation[i].conjugate() * state.angular_velocity[i];
    energy += 0.5 * body.mass * state.velocity[i].squaredNorm() + 0.5 * spin.dot(body.inertia.cwiseProduct(spin));
  }
  return energy;
}

void MeteredWorld::book_loads(double dt, const BodyLoads& loads) {
  for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
    if (!model_.bodies[i].dynamic) continue;
    // As the step takes them: drag by the velocity at its end.
    const Vec3 force = loads.force[i] - loads.linear_damping[i] * after_.velocity[i];
    const Vec3 torque = loads.torque[i] - loads.angular_damping[i] * after_.angular_velocity[i];
    sums_.imbalance += model_.bodies[i].mass * (after_.velocity[i] - before_.velocity[i]) - dt * force;
    sums_.load_impulse += dt * force.norm();
    const double work = force.dot(after_.position[i] - before_.position[i]) +
                        0.5 * dt * torque.dot(before_.angular_velocity[i] + after_.angular_velocity[i]);
    sums_.work += work;
    ledger_.turnover += std::abs(work);
  }
}

void MeteredWorld::book_contacts(double dt) {
  for (const Contact& c : contacts_) {
    const std::size_t a = static_cast<std::size_t>(c.a), b = static_cast<std::size_t>(c.b);
    if (model_.bodies[a].dynamic == model_.bodies[b].dynamic) continue;
    const bool a_is_tool = model_.bodies[b].dynamic;
    const std::size_t tool = a_is_tool ? a : b;
    const double sign = a_is_tool ? 1 : -1;  // of what acts on the dynamic body
    const Vec3 force = sign * c.force, torque = sign * c.torque;
    sums_.imbalance -= dt * force;
    tools_.impulse[tool] -= dt * force;
    const Vec3 velocity = after_.velocity[tool] + after_.angular_velocity[tool].cross(c.point - after_.position[tool]);
    const double work = dt * (force.dot(velocity) + torque.dot(after_.angular_velocity[tool]));
    sums_.work += work;
    ledger_.turnover += std::abs(work);
  }
}

}  // namespace repose
