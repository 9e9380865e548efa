#pragma once
/// Books of momentum, energy and loads, kept beside any world from what its interface tells: states, loads and contacts.
#include <memory>
#include <vector>

#include "core/world.hpp"

namespace repose {

/// Sums over all steps so far.
struct Ledger {
  /// |sum m (v+ - v) - impulse of all loads - impulse of all contacts with bodies that are not dynamic|, its largest value over time, over
  /// the impulse of the loads' magnitudes (sum over bodies and steps; at least the momenta at the start): relative [1].
  double momentum_error = 0;
  /// Energy that contacts took out of the dynamic bodies [J]:  D = W_loads + W_tools - (E_kin - E_kin at the start).
  ///   W_loads: force times the way of the centre of mass, torque times the mean turn; drag included.
  ///   W_tools: contact forces of prescribed bodies times the velocity of these at the contact.
  double dissipated = 0;
  /// Largest fall of D over time, as a share of the energy turned over (kinetic at the start + |work of loads| of all bodies +
  /// |work of tools|) [1]: contacts cannot give energy back unless they are elastic. Up to O(h) of the time stepping.
  double energy_gain = 0;
  double kinetic = 0;         ///< now [J]
  double turnover = 0;        ///< [J]
};

/// Hands everything on to `inner` and keeps the books. Costs a reading of state and contacts per step.
class MeteredWorld final : public World {
 public:
  /// `model` must outlive it.
  MeteredWorld(const Model& model, std::unique_ptr<World> inner);

  StepReport step(double dt, const BodyLoads& loads) override;
  void read(Snapshot& state) const override { inner_->read(state); }
  void read(std::vector<Contact>& contacts) const override { inner_->read(contacts); }
  void save(Frame& frame) const override { inner_->save(frame); }
  void restore(const Frame& frame) override;  ///< the books start anew

  const Ledger& ledger() const { return ledger_; }
  const std::vector<Contact>& contacts() const { return contacts_; }  ///< of the last step
  /// Impulse of all contacts on each body that is not dynamic since the last call [N s], and the time since then [s].
  struct ToolImpulses { double time = 0; std::vector<Vec3> impulse; };
  ToolImpulses take_impulses();

 private:
  void open();
  double kinetic_energy(const Snapshot& state) const;
  void book_loads(double dt, const BodyLoads& loads);
  void book_contacts(double dt);

  const Model& model_;
  std::unique_ptr<World> inner_;
  Ledger ledger_;
  Snapshot before_, after_;
  std::vector<Contact> contacts_;
  ToolImpulses tools_;
  struct Sums {
    Vec3 imbalance = Vec3::Zero();
    double load_impulse = 0, start_momentum = 0, start_kinetic = 0, work = 0;
    double most_dissipated = 0, largest_fall = 0, largest_imbalance = 0;
  } sums_;
};

}  // namespace repose
