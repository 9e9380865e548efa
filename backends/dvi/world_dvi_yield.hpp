#pragma once
/// Prescribed bodies that give way upward (Yield of core/motion.hpp), as part of the contact problem of a step.
///
/// A body that stands on its stops is first taken as prescribed. If the contacts then push it up by no more than its load, that is
/// the solution: the stops carry the rest. If they push harder the step is solved again with the body released: free along z,
/// with its stops as one more contact. So a load that the powder never lifts costs nothing and does not blur the residual.
#include <cstdint>
#include <span>
#include <vector>

#include "backends/dvi/cone_problem.hpp"
#include "backends/dvi/contact_finder.hpp"
#include "backends/dvi/impact.hpp"
#include "backends/dvi/units.hpp"
#include "core/model.hpp"

namespace repose::dvi {

class YieldingBodies {
 public:
  YieldingBodies(const Model& model, const Units& units);

  bool any() const { return !bodies_.empty(); }
  /// Those released in this step, ascending. They need a slot among the dynamic bodies.
  const std::vector<std::int32_t>& released() const { return released_; }
  bool is_released(std::size_t body) const;

  void begin_step() { released_.clear(); }
  /// `height`, `rise`: z and its rate as the last step left them. `position`, `velocity` come in as prescribed and go out as
  /// they are at the start of the step. Releases a body that stands or moves above its stops.
  void place(std::size_t body, double height, double rise, Vec3& position, Vec3& velocity);
  /// How fast a released body can move along z in a step of `h` that no contact disturbs.
  double free_rise(std::size_t body, double h) const;

  /// Completes a problem whose slots are `slot_of` the bodies: free velocities of those released, and their stops, each one
  /// more contact and one more prescribed body. `impulse` gets a zero for each.
  void add_stops(std::span<const std::int32_t> slot_of, double h, ConeProblem& problem, std::vector<ImpactData>& impact,
                 std::vector<Impulse>& impulse) const;

  /// Releases the bodies that the solved contacts push up harder than their load. False if there is none.
  bool release_overloaded(std::span<const FoundContact> found, const ConeProblem& problem, std::span<const Impulse> impulse, double h);

  /// Puts a body that has moved below its stops, which are at `stop` at the end of the step, back onto them.
  void stand_on_stops(std::size_t body, double stop, Vec3& position, Vec3& velocity) const;

 private:
  struct One {
    std::int32_t body = 0;
    double load = 0, mass = 0;
    double gap = 0;         ///< above the stops, at the start of the step
    double rise = 0;        ///< along z, at the start of the step
    Vec3 stop = Vec3::Zero();  ///< velocity of the stops
  };
  std::size_t index_of(std::size_t body) const;

  std::vector<One> bodies_;  ///< ascending
  std::vector<std::int32_t> released_;
};

}  // namespace repose::dvi
