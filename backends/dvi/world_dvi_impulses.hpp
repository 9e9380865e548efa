#pragma once
/// The contacts of the last step with their impulses: what the next step starts from, what World::read tells, what a checkpoint holds.
#include <cstdint>
#include <span>
#include <vector>

#include "backends/dvi/cone_problem.hpp"
#include "backends/dvi/contact_finder.hpp"
#include "backends/dvi/units.hpp"
#include "backends/dvi/world_dvi_bodies.hpp"
#include "core/world.hpp"

namespace repose::dvi {

class LastImpulses {
 public:
  explicit LastImpulses(const WorldBodies& bodies) : bodies_(bodies) {}  ///< which must outlive this

  /// Those of a step of `step` [units.time]: one impulse for each contact found and of the problem.
  void keep(std::span<const FoundContact> found, const ConeProblem& problem, std::span<const Impulse> impulse, double step, int threads);

  /// First impulses of a step of `step`: those of the same contacts one step ago, in proportion to the steps. Zero where the step
  /// before was a tenth or less: a blow tells nothing of what follows.
  void start(std::span<const FoundContact> found, const ConeProblem& problem, double step, int threads,
             std::vector<Impulse>& impulse) const;

  void read(std::vector<Contact>& contacts, const Units& units, int threads) const;
  void read_at(std::span<const int> bodies, std::vector<Contact>& contacts, const Units& units, int threads) const;
  void save(Frame& frame, const Units& units) const;
  /// False, and nothing is changed, if the frame holds no such thing, or contacts of bodies that there are not.
  bool restore(const Frame& frame, const Units& units);

 private:
  /// In world axes, so that a turned frame changes nothing.
  struct Kept {
    ContactId id;
    Vec3 force = Vec3::Zero();   ///< impulse on b
    Vec3 couple = Vec3::Zero();  ///< on b
    ContactPoint point;
  };
  /// The body whose chain a contact is in: a free one, for a tool may touch a whole bed, and the smaller of two.
  std::size_t bearer(const ContactId& id) const;
  Contact told(const Kept& kept, const Units& units) const;
  void link(int threads);

  const WorldBodies& bodies_;
  std::vector<Kept> kept_;
  std::vector<std::int32_t> first_;  ///< by body: contact that its chain begins with, -1: none
  std::vector<std::int32_t> next_;   ///< by contact: the one that follows in its chain, -1: none
  double step_ = 0;
};

}  // namespace repose::dvi
