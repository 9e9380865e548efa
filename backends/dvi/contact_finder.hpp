#pragma once
/// All contact points of a model in a given state, with names that last from step to step.
#include <cstdint>
#include <vector>

#include "backends/dvi/broad_phase.hpp"
#include "backends/dvi/narrow_phase.hpp"
#include "core/model.hpp"

namespace repose::dvi {

/// What tells one contact from all others, for as long as it lasts.
struct ContactId {
  std::uint64_t bodies = 0;   ///< a << 32 | b, a < b
  std::uint64_t features = 0; ///< part of a << 48 | part of b << 32 | feature
  bool operator==(const ContactId&) const = default;

  std::int32_t a() const { return static_cast<std::int32_t>(bodies >> 32); }
  std::int32_t b() const { return static_cast<std::int32_t>(bodies & 0xffffffffu); }
};

struct FoundContact {
  ContactId id;
  ContactPoint point;   ///< normal from a to b
};

/// A model's bodies in the caller's unit of length: what the finder needs to know of the state.
struct Placement {
  std::vector<Vec3> position;     ///< of every body
  std::vector<Mat3> rotation;
  std::vector<double> speed;      ///< bound on the speed of any point of the body, forces of this step included
  std::vector<char> present;      ///< 0: the body does not exist at this time
};

class ContactFinder {
 public:
  /// `unit`: length of the caller's unit [m]. The model must outlive the finder.
  ContactFinder(const Model& model, double unit);

  /// Every contact with gap <= margin, in spatial order of the first body. The margin of a pair is
  ///   search_margin * (step * fastest speed near either body + a fiftieth of the smaller radius), at least the pair's
  /// cohesion range: within one step no pair beyond it can meet. "Near" is within about two of the largest diameters,
  /// which covers a blow that is handed on. Deterministic at any thread count.
  const std::vector<FoundContact>& find(const Placement& placement, double step, double search_margin, int threads);

  /// Dynamic bodies in spatial order (of the last call).
  const std::vector<std::int32_t>& order() const { return order_; }

 private:
  struct PlacedPart {
    PlacedPrimitive primitive;
    double bound = 0;  ///< radius of its ball, infinite for unbounded parts
    bool is_sphere = false;
    double radius = 0;  ///< if it is a sphere
  };

  void place_parts(const Placement& placement, int threads);
  void local_speeds(const Placement& placement);
  void collide_bodies(std::int32_t a, std::int32_t b, double margin, std::vector<ContactPoint>& scratch,
                      std::vector<FoundContact>& out) const;
  double pair_margin(std::int32_t a, std::int32_t b) const;

  const Model& model_;
  double unit_;
  std::vector<std::int32_t> dynamic_, prescribed_;
  std::vector<std::int32_t> first_part_;   ///< per body, plus the end
  std::vector<PlacedPart> parts_;
  std::vector<double> bound_;              ///< per body: ball about its position
  std::vector<double> fast_;               ///< per body: fastest speed near it, times the step
  std::vector<double> base_margin_;        ///< per body
  std::vector<double> cohesion_range_;     ///< per pair of materials
  double widest_cohesion_ = 0;
  double search_margin_ = 1;
  std::vector<char> present_;
  BroadPhase broad_;
  std::vector<Vec3> centre_;
  std::vector<double> reach_;
  std::vector<std::int32_t> order_;
  std::vector<std::vector<FoundContact>> chunk_;
  std::vector<FoundContact> found_;
};

}  // namespace repose::dvi
