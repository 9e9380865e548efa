#pragma once
/// All contact points of a model in a given state, with names that last from step to step.
#include <cstdint>
#include <span>
#include <vector>

#include "backends/dvi/broad_phase.hpp"
#include "backends/dvi/narrow_phase.hpp"
#include "core/model.hpp"

namespace repose::dvi {

/// What tells one contact from all others, for as long as it lasts.
struct ContactId {
  std::uint64_t bodies = 0;    ///< a << 32 | b, a < b
  std::uint64_t features = 0;  ///< part of a << 48 | part of b << 32 | feature
  bool operator==(const ContactId&) const = default;

  std::int32_t a() const { return static_cast<std::int32_t>(bodies >> 32); }
  std::int32_t b() const { return static_cast<std::int32_t>(bodies & 0xffffffffu); }
};

struct FoundContact {
  ContactId id;
  ContactPoint point;  ///< normal from a to b; in a periodic cell beside a, with b where image_shift() puts it
};

/// A model's bodies in the caller's unit of length: what the finder needs to know of the state.
struct BodyPlacement {
  std::span<const Vec3> position;  ///< of every body
  std::span<const Mat3> rotation;
  std::span<const Vec3> velocity;  ///< of every body after the forces of the step, without contacts
  std::span<const Vec3> angular_velocity;
  std::span<const double> turning_speed;  ///< bound on the speed of its points about its centre
  std::span<const char> present;          ///< 0: the body does not exist at this time
};

class ContactFinder {
 public:
  /// `unit`: length of the caller's unit [m]. The model must outlive the finder.
  ContactFinder(const Model& model, double unit);

  /// Every contact that can close within the step: those with tools first, then those of free bodies in spatial order.
  /// Kept are contacts within the cohesion range or the rupture gap of liquid bridges, and those with
  ///   gap + step * u_n  <=  search_margin * (step * stir / 4 + a fiftieth of the smaller radius)
  /// where u_n is the normal velocity that the two would have without contacts, and stir the largest difference of two
  /// velocities found near them (within about two of the largest diameters, a touched tool's velocity included): what a
  /// blow that is handed on within the step may add. Grains that fall side by side are no contacts. Deterministic at
  /// any thread count.
  const std::vector<FoundContact>& find(const BodyPlacement& placement, double step, double search_margin, int threads);

  /// Contacts of the pairs that the last `find` looked at, at a new placement of the same bodies (the end of the step):
  /// those that overlap or stand closer than a fiftieth of the smaller radius. Costs no search. `moved`: empty in the first call after a
  /// `find`; later by body, 0 where place, turn and velocities are those of the call before: contacts of two such bodies are kept.
  const std::vector<FoundContact>& find_again(const BodyPlacement& placement, std::span<const char> moved, int threads);

  /// What to add to the position of b, so that the image of it that a meets stands there: a whole number of periods along
  /// each periodic axis, 0 along those where one of the two is endless (core/periodic_body.hpp). `position`: of every body.
  Vec3 image_shift(std::span<const Vec3> position, std::int32_t a, std::int32_t b) const;

  bool periodic() const { return periodic_; }

  /// Dynamic bodies in spatial order (of the last call).
  const std::vector<std::int32_t>& order() const { return order_; }

 private:
  struct PlacedPart {
    PlacedPrimitive primitive;
    double bound = 0;  ///< radius of its ball, infinite for unbounded parts
  };
  /// What the search asks of a body: side by side in memory, and for free bodies in spatial order, since most of the time goes
  /// into fetching it.
  struct Candidate {
    Vec3 position, velocity, angular_velocity;
    double bound = 0;          ///< radius of a ball about its position
    double turning_speed = 0;
    double stir = 0;           ///< largest difference of two velocities near it, times the step
    double resting_margin = 0;
    double sphere = 0;         ///< its radius if it is one sphere about its position, otherwise 0
    std::int32_t body = 0, material = 0;
    bool present = false, gated = false;
  };
  /// What one thread looks at and finds at a time.
  struct Chunk {
    std::vector<std::pair<std::int32_t, std::int32_t>> near;  ///< ranks that any two velocities met nearby could bring together
    std::vector<FoundContact> found;  ///< pair by pair
  };
  /// Work space of one thread.
  struct Scratch {
    std::vector<ContactPoint> points;
    std::vector<FoundContact> before;
  };

  Vec3 shift_between(const Vec3& from, const Vec3& to, std::int32_t a, std::int32_t b) const;
  Candidate candidate(const BodyPlacement& placement, std::int32_t body) const;
  void place_candidates(const BodyPlacement& placement, std::span<const char> moved, int threads);
  void place_parts(const BodyPlacement& placement, std::span<const char> moved, int threads);
  void find_tool_contacts(const BodyPlacement& placement, double step, std::span<const char> moved, int threads);
  void local_speeds(const BodyPlacement& placement, double step, int threads);
  double cohesion_range(const Candidate& a, const Candidate& b) const;
  void collide_bodies(const Candidate& x, const Candidate& y, double step, std::vector<ContactPoint>& scratch,
                      std::vector<FoundContact>& out) const;
  /// Calls keep(point, part of a << 48 | part of b << 32) for the contact points of all parts, b's moved by `shift`.
  template <class Keep>
  void collide_parts(const Candidate& a, const Candidate& b, const Vec3& shift, double margin, std::vector<ContactPoint>& scratch,
                     Keep&& keep) const;
  /// Runs `search(chunk, its number, scratch)` for `count` chunks of `chunks`.
  template <class Search>
  static void each_chunk(std::vector<Chunk>& chunks, std::size_t count, int threads, Search&& search);
  /// `first`, and after it what the chunks have found.
  static void gather(std::span<const FoundContact> first, const std::vector<Chunk>& chunks, int threads, std::vector<FoundContact>& out);

  const Model& model_;
  double unit_;
  PeriodicCell cell_;
  bool periodic_;
  std::vector<std::uint8_t> endless_;  ///< per body, bit k: along axis k; empty if not periodic
  std::vector<std::int32_t> dynamic_, prescribed_;
  std::vector<std::int32_t> first_part_;  ///< per body, plus the end
  std::vector<PlacedPart> parts_;
  std::vector<double> bound_;           ///< per body: ball about its position
  std::vector<double> sphere_;          ///< per body: Candidate::sphere
  std::vector<double> stir_;            ///< per body: Candidate::stir
  std::vector<double> resting_margin_;  ///< per body
  std::vector<std::int32_t> material_;  ///< per body
  std::vector<char> gated_;             ///< per body: exists at some times only
  std::vector<double> cohesion_range_;  ///< per pair of materials
  double widest_cohesion_ = 0;
  double search_margin_ = 1;
  std::vector<char> present_;
  BroadPhase broad_;
  std::vector<Vec3> centre_;
  std::vector<double> reach_;
  std::vector<std::int32_t> order_;
  std::vector<Candidate> candidate_;  ///< of the free bodies, by rank
  std::vector<Chunk> tool_chunk_, chunk_;
  std::vector<FoundContact> tool_contacts_, found_;
};

}  // namespace repose::dvi
